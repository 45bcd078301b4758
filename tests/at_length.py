"""Cases of parametrised tests that only `make test-long` runs, not `make test`."""

from typing import Any

import pytest


def at_length(*cases: Any) -> list[Any]:
    """Cases, each a value or a tuple of values, marked as long because they take minutes."""
    return [pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.long) for case in cases]
