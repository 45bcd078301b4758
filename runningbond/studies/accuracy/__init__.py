"""Accuracy against cost: all models and their parameters on walls with a known answer, timed and plotted."""
