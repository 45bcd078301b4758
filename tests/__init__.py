"""Tests, laid out as the house is."""

from hypothesis import settings

# How long an example takes is the machine's affair: the first one may compile a kernel.
settings.register_profile("no deadline", deadline=None)
settings.load_profile("no deadline")
