"""Joint points: quadrature on the joints, and the local frame in which jumps and tractions are measured.

A joint separates block a from block b. Its normal n points from a to b, its tangent is t = (−n_y, n_x).
The jump is u_b − u_a: opening is a positive normal jump, tension a positive normal traction.
"""

from dataclasses import dataclass, fields

import numpy as np

from runningbond.scene import Array, Indices, Joints, SceneError, frozen


@dataclass(frozen=True, eq=False)
class Rule:
    """Quadrature rule on [−1, 1]: nodes and weights, both ``(n,)``, the weights adding up to 2."""

    nodes: Array
    weights: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", frozen(self.nodes))
        object.__setattr__(self, "weights", frozen(self.weights))


def lobatto(points: int = 2) -> Rule:
    """Gauss–Lobatto rule, whose end points are the joint's ends.

    A rigid block rocks exactly about its edge only if a point lies there: two-point Gauss topples a single block 42 %
    too early. Three points are Simpson's rule.
    """
    if points < 2:
        raise ValueError(f"points = {points}: a Lobatto rule has at least its two ends")
    legendre = np.polynomial.Legendre.basis(points - 1)
    nodes = np.concatenate([[-1.0], np.sort(legendre.deriv().roots().real), [1.0]])
    return Rule(nodes, 2 / (points * (points - 1) * legendre(nodes) ** 2))


def gauss(points: int) -> Rule:
    """Gauss–Legendre rule; exact for smooth tractions, unsafe for rocking joints."""
    if points < 1:
        raise ValueError(f"points = {points}: a Gauss rule has at least one point")
    nodes, weights = np.polynomial.legendre.leggauss(points)
    return Rule(nodes, weights)


@dataclass(frozen=True, eq=False)
class JointPoints:
    """Points at which joints transmit tractions.

    Parameters
    ----------
    joint : (np,) int
        Joint of each point.
    block : (np, 2) int
        Blocks a and b on either side.
    position : (np, 2) float
        Coordinates [m].
    normal, tangent : (np, 2) float
        Unit vectors; n points from a to b, t = (−n_y, n_x).
    area : (np,) float
        Area of each point [m²]; over a joint they add up to length × thickness, over the contact of a corner to
        `Joints.corner_length` × thickness.
    """

    joint: Indices
    block: Indices
    position: Array
    normal: Array
    tangent: Array
    area: Array

    def __post_init__(self) -> None:
        for name in ("joint", "block"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.int64))
        for name in ("position", "normal", "tangent", "area"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    def __len__(self) -> int:
        return len(self.joint)

    def part(self, chosen: Indices) -> "JointPoints":
        """Subset of the points, or all in another order."""
        return JointPoints(**{column.name: getattr(self, column.name)[chosen] for column in fields(self)})


def joint_points(
    joints: Joints, thickness: float | Array, rule: Rule | None = None, inset: float | Array = 0.0
) -> JointPoints:
    """Place the points of a quadrature rule on every joint.

    Parameters
    ----------
    thickness : float or (nj,) float
        Out-of-plane thickness [m].
    rule
        Quadrature rule; two Lobatto points by default.
    inset : float or (nj,) float
        Distance [m] of the rule's ends from the joint's ends, which represents rounded corners. The areas still add up
        to the whole joint.

    Returns
    -------
    JointPoints
        Points of joint 0 first, each joint's points in the direction of its tangent.
    """
    rule = rule or lobatto()
    too_far = joints.too_short_for(inset)
    if too_far.any():
        raise SceneError(
            "joint.inset",
            f"must be less than half the shortest joint, {joints.length[too_far].min():.4g} m long",
            float(np.max(inset)),
        )
    start, stop = joints.ends[:, 0], joints.ends[:, 1]
    length = joints.length[:, None]
    tangent = (stop - start) / length
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    n = len(rule.nodes)
    reach = length / 2 - np.broadcast_to(inset, len(joints))[:, None]
    position = (start + stop)[:, None] / 2 + (reach * rule.nodes)[:, :, None] * tangent[:, None]
    bearing = np.where(joints.at_corner, joints.corner_length, joints.length)
    area = (np.broadcast_to(thickness, len(joints)) * bearing)[:, None] * rule.weights / 2
    return JointPoints(
        np.repeat(np.arange(len(joints)), n),
        np.repeat(joints.block, n, axis=0),
        position.reshape(-1, 2),
        np.repeat(normal, n, axis=0),
        np.repeat(tangent, n, axis=0),
        area.ravel(),
    )
