"""Cases that `make test-long` tries beside those of `make test`."""

from typing import Any

import pytest


def at_length(*cases: Any) -> list[Any]:
    """Values of a parameter, or tuples of several parameters' values, that are tried where there are minutes."""
    return [pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.long) for case in cases]
