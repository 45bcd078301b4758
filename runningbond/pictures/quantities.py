"""Quantities as people read them: 12 kN instead of 12000 N."""

from collections.abc import Sequence

import numpy as np

from runningbond.scene import Array

PREFIXES = {1e9: "G", 1e6: "M", 1e3: "k", 1.0: ""}


def readable(value: float, unit: str) -> str:
    """A value in SI, in the multiple of its unit in which it is between 1 and 1000; below that in the unit itself."""
    size = _multiple(value)
    return f"{minus(value / size)} {PREFIXES[size]}{unit}"


def span(values: Sequence[float], unit: str) -> str:
    """The least and the largest of some values in SI, in the multiple of their unit that suits the largest."""
    size = _multiple(max(values, key=abs))
    least, most = (minus(one / size) for one in (min(values), max(values)))
    return f"{least} … {most} {PREFIXES[size]}{unit}" if least != most else f"{most} {PREFIXES[size]}{unit}"


def pair(vector: Array, unit: str) -> str:
    """A vector ``(2,)`` in SI, in the multiple of its unit that suits the larger component."""
    size = _multiple(float(np.abs(vector).max()))
    x, y = vector / size
    return f"({minus(x)}, {minus(y)}) {PREFIXES[size]}{unit}"


def _multiple(value: float) -> float:
    return next((size for size in PREFIXES if abs(value) >= size * (1 - 1e-9)), 1.0)


def millimetres(value: float) -> str:
    """A length [m] in mm."""
    return f"{minus(1e3 * value)} mm"


def round_length(most: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not more than a length."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(f"{max(k * power for k in (1, 2, 5) if k * power <= most * (1 + 1e-9)):g}")


def minus(value: float) -> str:
    """A number with four digits and a true minus sign."""
    return signed(f"{value + 0.0:.4g}")


def signed(text: str) -> str:
    """Numbers in a text with true minus signs."""
    return text.replace("-", "−")


def times_lambda(text: str, *, live: bool) -> str:
    """What a load's label says: a live one is multiplied."""
    return f"λ · {text}" if live else text


def beginning(words: Sequence[str]) -> str:
    """The first eight of some words."""
    return ", ".join(words[:8]) + (", …" if len(words) > 8 else "")


def counted(n: int, what: str) -> str:
    """So many of something."""
    return f"{n} {what}{'' if n == 1 else 's'}"
