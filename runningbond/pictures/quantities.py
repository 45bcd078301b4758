"""Quantities in readable form: 12 kN instead of 12000 N."""

from collections.abc import Sequence

import numpy as np

from runningbond.scene import Array

PREFIXES = {1e9: "G", 1e6: "M", 1e3: "k", 1.0: ""}


def readable(value: float, unit: str) -> str:
    """Format an SI value with the prefix for a number between 1 and 1000; values below 1 keep the plain unit."""
    size = _multiple(value)
    return f"{minus(value / size)} {PREFIXES[size]}{unit}"


def span(values: Sequence[float], unit: str) -> str:
    """Format the smallest and the largest of several SI values, with the prefix that suits the largest magnitude."""
    size = _multiple(max(values, key=abs))
    least, most = (minus(one / size) for one in (min(values), max(values)))
    return f"{least} … {most} {PREFIXES[size]}{unit}" if least != most else f"{most} {PREFIXES[size]}{unit}"


def pair(vector: Array, unit: str) -> str:
    """Format an SI vector ``(2,)`` with the prefix that suits its larger component."""
    size = _multiple(float(np.abs(vector).max()))
    x, y = vector / size
    return f"({minus(x)}, {minus(y)}) {PREFIXES[size]}{unit}"


def _multiple(value: float) -> float:
    return next((size for size in PREFIXES if abs(value) >= size * (1 - 1e-9)), 1.0)


def millimetres(value: float) -> str:
    """Format a length [m] in mm."""
    return f"{minus(1e3 * value)} mm"


def round_length(most: float) -> float:
    """Largest of 1, 2 and 5 times a power of ten that does not exceed a length."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(f"{max(k * power for k in (1, 2, 5) if k * power <= most * (1 + 1e-9)):g}")


def minus(value: float) -> str:
    """Format a number with four significant digits and a true minus sign."""
    return signed(f"{value + 0.0:.4g}")


def signed(text: str) -> str:
    """Replace the hyphens in a text with true minus signs."""
    return text.replace("-", "−")


def times_lambda(text: str, *, live: bool) -> str:
    """Label of a load, multiplied by λ if the load is live."""
    return f"λ · {text}" if live else text


def beginning(words: Sequence[str]) -> str:
    """Join the first eight of several words."""
    return ", ".join(words[:8]) + (", …" if len(words) > 8 else "")


def counted(n: int, what: str) -> str:
    """Format a number with its noun in singular or plural."""
    return f"{n} {what}{'' if n == 1 else 's'}"
