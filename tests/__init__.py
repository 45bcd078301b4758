"""Tests, in folders that follow those of the package."""

from hypothesis import settings

# No deadline: run times depend on the machine, and the first example may compile a kernel.
settings.register_profile("no deadline", deadline=None)
settings.load_profile("no deadline")
