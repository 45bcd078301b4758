"""Collapse multiplier of a dry running-bond panel pushed sideways by its own weight, as a continuum.

One crack rises from the lower corner on the far side of the push and the wedge above it turns about that
corner. Blocks hold together up to a crack slope tan ψ = s, ψ from the horizontal, with

    s = (m / tan φ)^{1/2},    m = 2 a / b,    r = H / L

(Baraldi, Reccia & Cecchi, Eq. 6, with the exponent corrected: the printed −1/2 in the second branch makes the
multiplier jump at r = s; see docs/errata.md).
"""

import math


def crack_slope(block_width: float, block_height: float, friction: float) -> float:
    """Steepest crack slope s = (m / tan φ)^{1/2}; inf without friction.

    Parameters
    ----------
    block_width, block_height
        b and a [m].
    friction
        tan φ.
    """
    return math.sqrt(2 * block_height / block_width / friction) if friction > 0 else math.inf


def lateral_multiplier(slenderness: float, slope: float, friction: float) -> float:
    """Collapse multiplier λ of a panel.

    Parameters
    ----------
    slenderness
        r = H / L.
    slope
        s, from `crack_slope`.
    friction
        tan φ, at which the whole panel slides.

    Returns
    -------
    float
        1 / (2 s) where r ≤ s, (3 r − 2 s) / (3 r² − s²) beyond, and never more than tan φ.
    """
    r, s = slenderness, slope
    turning = 1 / (2 * s) if r <= s else (3 * r - 2 * s) / (3 * r**2 - s**2)
    return min(turning, friction)
