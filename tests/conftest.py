"""What every test finds as the one before found it."""

import signal
from collections.abc import Iterator

import pytest


@pytest.fixture(autouse=True)
def _signals_are_heard_as_before() -> Iterator[None]:
    """Commands that are called in this process listen for Ctrl-C and SIGTERM, and end with it."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)
