"""The machine fails: every command is broken off, killed, given a disk that takes no more, doubled and damaged.

Whatever happens, finished work is there whole, unfinished work is done again by the same command, and a command that
can say something says it in one line. Commands that write are tried; this one cannot be tried from within itself.
"""

from .campaign import experiment

__all__ = ["experiment"]
