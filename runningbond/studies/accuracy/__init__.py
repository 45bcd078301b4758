"""Accuracy against cost: every model and its parameters on walls whose answer is known, timed and drawn."""
