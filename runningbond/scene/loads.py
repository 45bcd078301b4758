"""Loads: a dead load that is always there, and a live load that λ multiplies."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Lateral:
    """Each block pushed by its own weight along a unit direction; λ is the ratio of push to weight."""

    direction: tuple[float, float] = (1.0, 0.0)


@dataclass(frozen=True)
class PointLoad:
    """A force [N] at a point [m], shared equally by the movable blocks that touch it."""

    at: tuple[float, float]
    force: tuple[float, float]


@dataclass(frozen=True)
class Load:
    """Gravity, the acceleration vector [m/s²] of the dead load, and the live load."""

    gravity: tuple[float, float] = (0.0, -9.81)
    live: Lateral | PointLoad = field(default_factory=Lateral)
