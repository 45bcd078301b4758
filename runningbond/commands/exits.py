"""Exit codes of every command."""

DONE, BAD_INPUT, NO_ANSWER, STOPPED = 0, 2, 3, 130

UNDECIDED = ("undecided", "failed")
"""Statuses of outcomes that are no answer."""
