#!/usr/bin/env python3
"""Check results of ``runningbond run --model limit`` or ``limit-nonassociated --out DIR`` with nothing but numpy.

    python tools/check_limit.py DIR [DIR …]

From the scene and the arrays in each folder, and without any code of the suite, the script checks equilibrium of
weights, loads, joint forces, ties and reactions for each block; the Mohr-Coulomb criterion at every joint point, or for
joints that crush, the domain of the resultants of all admissible tractions; and the kinematics of the mechanism. It
computes the multiplier again, from the mechanism and for settlements from the support's work. For an interval of
certified loads it does all this at both ends. It prints each relative error, and exits with 1 if one is above 1e-6.
"""

import io
import json
import math
import sys
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

LARGEST_ERROR = 1e-6
"""Largest admissible error, relative to the largest force, motion or multiplier."""

BRACKET_WIDTHS = [(1500, 1e-6), (25_000, 1e-4), (math.inf, 1e-2)]
"""Largest relative width of a bracket of the associated bounds, for walls with fewer blocks than the first number of
each pair; each end is checked separately."""

LARGE_CRUSHING = 200
"""Number of blocks from which a wall whose joints crush may have the bracket width of `BRACKET_WIDTHS[1]`."""

GAUSS = [(part + shift) / 2 for part, shift in zip(np.polynomial.legendre.leggauss(6), (1, 0), strict=True)]
"""Nodes and weights of 6-point Gauss quadrature on [0, 1]."""

CONTACT = 1e-4
"""Largest gap that counts as contact, relative to the square root of the smallest block's area."""


def read(folder: Path) -> tuple[Any, dict[str, Any], dict[str, np.ndarray]]:
    """Read scene, record and arrays of a result folder; parts of the scene have their fields as attributes."""
    if not (folder / "outcome.json").is_file():
        raise SystemExit(f"{folder}: holds no outcome.json of a limit analysis")
    record = json.loads((folder / "outcome.json").read_text(encoding="utf-8"))
    if record["model"] not in ("limit", "limit-nonassociated"):
        raise SystemExit(f"{folder}: holds an outcome of {record['model']}, and none of a limit analysis")
    with np.load(io.BytesIO((folder / record["arrays"]).read_bytes())) as stored:
        arrays = dict(stored)

    def decoded(value: Any) -> Any:
        if isinstance(value, dict):
            return (
                arrays[value["array"]]
                if "array" in value
                else SimpleNamespace(**dict(zip(value, map(decoded, value.values()), strict=True)))
            )
        return [decoded(one) for one in value] if isinstance(value, list) else value

    return decoded(json.loads(arrays["scene"].tobytes())), record, arrays


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Cross product of plane vectors ``(…, 2)``."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


class Wall:
    """Blocks, joint points and held motions, computed from the scene in the file."""

    def __init__(self, scene: Any) -> None:
        self.scene, first = scene, scene.blocks.first
        self.outlines = [scene.blocks.vertices[i:j] for i, j in pairwise(first)]
        self.n, self.fixed = len(self.outlines), scene.fixed
        self.area, self.centre = (np.array(part) for part in zip(*map(area_and_centre, self.outlines), strict=True))
        self.gap = CONTACT * math.sqrt(self.area.min())
        density = np.array([scene.block_materials[k].density for k in scene.material_of_block])
        self.thickness = thicknesses(scene)
        self.mass = density * self.area * self.thickness
        if scene.beam is not None:
            self.mass[scene.beam.block] = scene.beam.mass
        self.base = min(
            float(outline[:, 1].min()) for outline, inside in zip(self.outlines, scene.wall, strict=True) if inside
        )
        self._points()
        pins, late = scene.pins, scene.beam is not None and scene.beam.condition == "fixed-height"
        self.held = list(zip(pins.block, pins.point, pins.direction, pins.turn, strict=True))
        self.held += [(scene.beam.block, self.centre[scene.beam.block], np.array([0.0, 1.0]), 0.0)] if late else []

    def _points(self) -> None:
        """Two points per joint, at its ends or inset from them, each with the strength of half the joint.

        Both points of the contact of a single corner, which has no strength, are at the corner.
        """
        joints, materials = self.scene.joints, [self.scene.joint_materials[k] for k in self.scene.material_of_joint]
        if any(material.law is not None for material in materials):
            sys.exit("a joint has a law of its own: not checked")
        run = joints.ends[:, 1] - joints.ends[:, 0]
        length = np.hypot(*run.T)
        tangent = run / length[:, None]
        inset = np.where(joints.corner_length > 0, length / 2, [material.inset for material in materials])
        inset = inset[:, None] * tangent
        self.at = np.stack([joints.ends[:, 0] + inset, joints.ends[:, 1] - inset], axis=1).reshape(-1, 2)
        self.tangent = np.repeat(tangent, 2, axis=0)
        self.normal = np.column_stack([self.tangent[:, 1], -self.tangent[:, 0]])
        self.pair = np.repeat(joints.block, 2, axis=0)
        area = np.repeat(length * self.thickness[joints.block].min(axis=1) / 2, 2)
        crushing = [joint for joint, material in enumerate(materials) if material.compressive_strength is not None]
        self.crushing = {j: Traction(materials[j], 2 * area[2 * j]) for j in crushing}
        self.friction = np.repeat([material.friction for material in materials], 2)
        self.cohesion = np.repeat([material.cohesion for material in materials], 2) * area
        self.tension = np.repeat([tensile_strength(material) for material in materials], 2) * area

    def on_blocks(self, block: Any, at: Any, force: Any) -> np.ndarray:
        """Convert forces at points to forces and moments on all blocks about their centroids, ``(nb, 3)``."""
        block, at, force = np.atleast_1d(block), np.reshape(at, (-1, 2)), np.reshape(force, (-1, 2))
        total = np.zeros((self.n, 3))
        np.add.at(total, block, np.column_stack([force, cross(at - self.centre[block], force)]))
        return total

    def moved(self, motion: np.ndarray, block: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Displacements of points on blocks under a motion, ``(n, 2)``."""
        arm, turn = at - self.centre[block], motion[block, 2]
        return np.asarray(motion[block, :2] + np.column_stack([-turn * arm[:, 1], turn * arm[:, 0]]))

    def holding(self, point: np.ndarray) -> list[int]:
        """Movable blocks that contain or touch a point."""
        return [k for k in range(self.n) if not self.fixed[k] and holds(self.outlines[k], point, self.gap)]

    def load(self, action: Any) -> np.ndarray:
        """Forces and moments on the blocks by a load of the file, ``(nb, 3)``."""
        kind, gravity = action.part, float(np.hypot(*self.scene.load.gravity))
        if kind in ("Lateral", "Tilt", "Body"):
            pull = np.array(action.acceleration) if kind == "Body" else gravity * np.array(action.direction)
            return self.on_blocks(np.arange(self.n), self.centre, self.mass[:, None] * pull)
        if kind == "PointLoad":
            blocks = self.holding(np.array(action.at))
            return self.on_blocks(
                blocks, [action.at] * len(blocks), [np.array(action.force) / len(blocks)] * len(blocks)
            )
        if kind == "Moment":
            total = np.zeros((self.n, 3))
            total[self.holding(np.array(action.at)), 2] = action.moment
            return total
        if kind == "BeamLoad":
            x, y = self.centre[self.scene.beam.block]
            return self.on_blocks(
                self.scene.beam.block, (x, y if action.height is None else self.base + action.height), action.force
            )
        if kind == "LineLoad":
            return self.line(np.array(action.start), np.array(action.end), np.array(action.force))
        return np.zeros((self.n, 3))  # for a settlement

    def line(self, start: np.ndarray, end: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Load per length: each part of the line, between corners or edges, loads the block that it presses on."""
        run, total = end - start, np.zeros((self.n, 3))
        length = float(np.hypot(*run))
        across = np.array([-run[1], run[0]]) / length
        inwards = math.copysign(1.0, across @ force) * across
        cuts = [0.0, 1.0]
        for outline in self.outlines:
            for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
                if abs(cross(a - start, run)) <= 3 * self.gap * length:
                    cuts.append(float((a - start) @ run) / length**2)
                elif abs(slope := float(cross(b - a, run))) > 1e-9 * length**2:
                    share = float(cross(start - a, run)) / slope
                    cuts += [float((a + share * (b - a) - start) @ run) / length**2] if 0 <= share <= 1 else []
        ordered = sorted(min(max(cut, 0.0), 1.0) for cut in cuts)
        for low, high in pairwise(ordered):
            middle = start + (low + high) / 2 * run
            here = self.holding(middle) if high - low > 1e-12 else []
            ahead = middle + 3 * self.gap * inwards
            for block in here if len(here) == 1 else [k for k in here if holds(self.outlines[k], ahead, self.gap)]:
                total += self.on_blocks(block, middle, (high - low) * length * force)
        return total

    def in_box(self, box: Any) -> np.ndarray:
        """Whether supports move with a settlement's box, ``(nb,)``; halves of a block that may crack move together.

        Supports with their middle on a side of the box, or that only touch it, do not move, nor does ground above it.
        """
        (x0, y0), (x1, y1) = np.array(box) + [[self.gap], [-self.gap]]
        bottom, top = (np.array([pick(outline[:, 1]) for outline in self.outlines]) for pick in (np.min, np.max))
        inside = np.zeros(self.n, dtype=bool)
        for k, part in enumerate(self.scene.part_of):
            body = self.scene.part_of == part if part >= 0 else np.arange(self.n) == k
            middle = self.area[body] @ self.centre[body, 0] / self.area[body].sum()
            level = ((bottom < y1) & (top > y0))[body].any()
            inside[k] = x0 < middle < x1 and level and (self.scene.wall[k] or top[k] < box[1][1] + 2 * self.gap)
        return inside

    def support_motion(self) -> np.ndarray:
        """Motion of the supports at λ = 1, ``(nb, 3)``; zero for all other blocks."""
        motion = np.zeros((self.n, 3))
        for load in self.scene.load.live:
            if load.part == "Settlement":
                about = np.mean(load.box, axis=0) if load.about is None else np.array(load.about)
                turn = math.radians(load.rotation_angle)
                for k in np.flatnonzero(self.fixed & self.in_box(load.box)):
                    arm = self.centre[k] - about
                    motion[k] = load.by[0] - turn * arm[1], load.by[1] + turn * arm[0], turn
        return motion


def thicknesses(scene: Any) -> np.ndarray:
    """Thickness of each block; a beam and the ground are as thick as the thickest of the others."""
    own = [getattr(each, "thickness", None) for each in scene.block_materials]  # absent in older files
    thickness = np.array([each or scene.thickness for each in own])[scene.material_of_block]
    others = ~scene.wall
    if scene.beam is not None:
        others[scene.beam.block] = True
    thickness[others] = thickness[~others].max()
    return thickness


def area_and_centre(outline: np.ndarray) -> tuple[float, np.ndarray]:
    """Area and centroid of a polygon."""
    here = outline - outline[0]
    there = np.roll(here, -1, axis=0)
    twice = cross(here, there)
    return float(twice.sum() / 2), outline[0] + ((here + there) * twice[:, None]).sum(axis=0) / (3 * twice.sum())


def holds(outline: np.ndarray, point: np.ndarray, gap: float) -> bool:
    """Whether a polygon contains a point, or its outline is within a gap of the point."""
    return distance(outline, point) <= gap or crossings(outline, point) % 2 == 1


def distance(outline: np.ndarray, point: np.ndarray) -> float:
    """Distance of a point from an outline."""
    edge = np.roll(outline, -1, axis=0) - outline
    share = (((point - outline) * edge).sum(axis=1) / (edge**2).sum(axis=1)).clip(0.0, 1.0)
    return float(np.hypot(*(outline + share[:, None] * edge - point).T).min())


def crossings(outline: np.ndarray, point: np.ndarray) -> int:
    """Number of edges that a ray from a point to the right crosses."""
    a, b = outline, np.roll(outline, -1, axis=0)
    spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    a, b = a[spans], b[spans]
    return int((a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]) > point[0]).sum())


def tensile_strength(material: Any) -> float:
    """Tensile strength [Pa]: the given one, but at most the apex c / tan φ, which is also the default."""
    apex = float(material.cohesion / material.friction) if material.friction else math.inf
    if material.tensile_strength is None:
        return apex if material.friction else 0.0
    return float(min(material.tensile_strength, apex))


class Traction:
    """Admissible tractions σ and τ at a point of a joint that crushes, times its area: cone, cut-off and cap.

    The cap is an ellipse under compression, and continues in tension with constant shear strength.

    The joint carries the resultants of all admissible traction fields: the normal force at each end, and the shear
    force.
    """

    def __init__(self, material: Any, area: float) -> None:
        self.slope, self.cohesion = material.friction, material.cohesion * area
        self.cap, self.shear = material.compressive_strength * area, material.cap_shear
        self.tension = tensile_strength(material) * area
        reach, cross_ = 1 + self.shear * self.slope**2, self.shear * self.slope * self.cohesion
        root = math.sqrt(max(0.0, self.cap**2 * reach - self.shear * self.cohesion**2))
        corners = [(sigma, self.cohesion - self.slope * sigma) for sigma in (self.tension, (cross_ - root) / reach)]
        if self.shear:
            most = self.cap / math.sqrt(self.shear)
            meeting = (self.cohesion - most) / self.slope if self.slope else 0.0
            corners += [(sigma, most) for sigma in (self.tension, meeting, 0.0)]
        self.corners = np.array([corner for corner in corners if self.holds(*np.array(corner)[:, None])[0]])
        graded = np.outer([-1, 1], np.outer(10.0 ** np.arange(-4, 8), [1, 2, 5])).ravel()
        on_arc = self.corners[(self.corners[:, 1] * self.shear > 0) & (self.corners[:, 0] <= 0)]
        self.ratios = np.concatenate([[0.0, self.slope], graded, on_arc[:, 0] / (on_arc[:, 1] * (self.shear or 1.0))])

    def holds(self, sigma: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """Whether tractions with τ ≥ 0 are admissible."""
        near = 1e-9 * self.cap
        inside = (sigma <= self.tension + near) & (tau >= -near) & (tau <= self.cohesion - self.slope * sigma + near)
        return np.asarray(inside & (np.hypot(np.minimum(sigma, 0.0), math.sqrt(self.shear) * tau) <= self.cap + near))

    def best(self, opening: np.ndarray, slip: float) -> tuple[np.ndarray, np.ndarray]:
        """Tractions with the largest dissipation for given openings and a slip ≥ 0."""
        radius = np.hypot(opening, slip / math.sqrt(self.shear)) if self.shear else np.abs(opening)
        radius = np.where(radius > 0, radius, 1.0)
        arc = self.cap * opening / radius, self.cap * slip / (self.shear * radius) if self.shear else 0 * opening
        sigma, tau = (
            np.vstack([np.tile(corner[:, None], len(opening)), one])
            for corner, one in zip(self.corners.T, arc, strict=True)
        )
        spent = np.where(self.holds(sigma, tau), opening * sigma + slip * tau, -np.inf)
        which = spent.argmax(axis=0), np.arange(len(opening))
        return sigma[which], tau[which]

    def resultant(self, jumps: np.ndarray) -> np.ndarray:
        """Forces at both ends and shear force with the largest dissipation for two openings and a slip ``(3,)``."""
        first, span, slip = jumps[0], jumps[1] - jumps[0], jumps[2]
        cuts = (self.ratios * abs(slip) - first) / span if abs(span) > 1e-12 * abs(jumps).max() else np.zeros(0)
        cuts = np.unique(np.concatenate([[0.0, 1.0], np.linspace(0, 1, 9), cuts[(cuts > 0) & (cuts < 1)]]))
        width = np.diff(cuts)
        at, weight = (cuts[:-1, None] + width[:, None] * GAUSS[0]).ravel(), (width[:, None] * GAUSS[1]).ravel()
        sigma, tau = self.best(first + span * at, abs(slip))
        return np.array([weight @ (sigma * (1 - at)), weight @ (sigma * at), math.copysign(1.0, slip) * (weight @ tau)])

    def beyond(self, forces: np.ndarray, near: float) -> float:
        """Distance of forces ``(3,)`` from the nearest admissible resultant (Wolfe 1976), with tolerance `near`."""
        points = [self.resultant(-forces) - forces]
        share, here = np.ones(1), points[0]
        for _ in range(200):
            size, found = math.sqrt(here @ here), self.resultant(-here) - forces
            if size <= near or here @ found >= size * (size - near):
                break
            points, share = [*points, found], np.append(share, 0.0)
            while len(points) > 1:
                goal = nearest(np.array(points))
                falls = goal <= 1e-14
                if not falls.any():
                    break
                step = (share / np.maximum(share - goal, 1e-300))[falls]
                share = share + min(1.0, float(step.min())) * (goal - share)
                keep = share > 1e-14
                keep[np.flatnonzero(falls)[step.argmin()]] = False
                points, share = [point for point, stays in zip(points, keep, strict=True) if stays], share[keep]
            share = nearest(np.array(points))
            here = share @ np.array(points)
        return math.sqrt(here @ here)


def nearest(points: np.ndarray) -> np.ndarray:
    """Coefficients, with sum 1, of the affine combination of points ``(k, 3)`` nearest to zero; may be negative."""
    scaled, one = points / (np.abs(points).max() or 1.0), np.ones((len(points), 1))
    system = np.block([[scaled @ scaled.T, one], [one.T, np.zeros((1, 1))]])
    return np.asarray(np.linalg.lstsq(system, np.append(0 * one[:, 0], 1.0), rcond=1e-15)[0][:-1])


class Result:
    """A collapse of a scene, with its forces and motion; `far` takes those of the other end of its interval.

    For an interrupted analysis the forces are those of the lower bound.
    """

    def __init__(self, scene: Any, record: dict[str, Any], arrays: dict[str, np.ndarray], far: bool = False) -> None:
        self.scene, self.record, self.wall = scene, record, Wall(scene)
        wall, loads = self.wall, scene.load
        self.dilatant = record["model"] == "limit"
        self.settles = any(load.part == "Settlement" for load in loads.live)
        self.decided = record["status"] == "collapse"
        near = "multiplier" if self.decided else "lower"
        self.multiplier = record[("lower" if self.settles else "upper") if far else near]
        force, pull, held, self.motion = (
            arrays[f"{'far_' if far else ''}{n}"] for n in ("force", "pull", "held", "motion")
        )
        (self.normal, self.tangential), self.pull, self.held = force.T, pull.ravel(), held.ravel()
        self.pressure = wall.tension - self.normal
        self.shear = wall.cohesion - wall.friction * wall.tension
        along = scene.ties.ends[:, 1] - scene.ties.ends[:, 0]
        self.along = along / np.hypot(*along.T)[:, None]
        weight = wall.on_blocks(np.arange(wall.n), wall.centre, wall.mass[:, None] * np.array(loads.gravity))
        self.dead = sum((wall.load(load) for load in loads.dead), weight)
        self.live = sum((wall.load(load) for load in loads.live), np.zeros((wall.n, 3)))
        self.support = wall.support_motion()
        ends = np.repeat(scene.joints.block, 2, axis=0), scene.joints.ends.reshape(-1, 2)
        self.settlement = max(np.hypot(*wall.moved(self.support, side, ends[1]).T).max() for side in ends[0].T)
        self.weight = float(np.hypot(*self.dead[~wall.fixed, :2].sum(axis=0)))
        self.crushing = wall.crushing if self.dilatant else {}
        self.nothing = 0.0 if self.dead[~wall.fixed].any() else self._nothing()
        self.uncrushed = ~np.isin(np.arange(len(wall.at)) // 2, list(self.crushing))
        self.inner = self._inner()
        self._follow()

    def _nothing(self) -> float:
        """Force that counts as zero in a wall without weight, which may carry no load at all, only rounding errors."""
        caps = [traction.cap for traction in self.crushing.values()]
        strengths = [*self.wall.tension, *self.wall.cohesion, *caps, *self.scene.ties.yield_force]
        return LARGEST_ERROR * max(np.abs(self.live).max(), *strengths)

    def _inner(self) -> np.ndarray:
        """Forces of joints, ties and pins on each block ``(nb, 3)``; positive joint forces pull the blocks together."""
        wall, ties = self.wall, self.scene.ties
        joint = self.normal[:, None] * wall.normal + self.tangential[:, None] * wall.tangent
        inner = wall.on_blocks(wall.pair[:, 0], wall.at, joint) - wall.on_blocks(wall.pair[:, 1], wall.at, joint)
        for end, sense in ((0, 1.0), (1, -1.0)):
            on = ties.block[:, end] >= 0
            force = sense * self.pull[:, None] * self.along
            inner += wall.on_blocks(ties.block[on, end], ties.ends[on, end], force[on])
        for (block, at, direction, turn), size in zip(wall.held, self.held, strict=True):
            inner += wall.on_blocks(block, at, size * direction)
            inner[block, 2] += size * turn
        return inner

    def _follow(self) -> None:
        """Compute jumps of the joint points and elongations of the ties in the mechanism."""
        wall, ties, motion = self.wall, self.scene.ties, self.motion
        first, second = (wall.moved(motion, side, wall.at) for side in wall.pair.T)
        self.opening = ((second - first) * wall.normal).sum(axis=1)
        self.slip = ((second - first) * wall.tangent).sum(axis=1)
        first, second = (
            np.where(ties.block[:, [end]] >= 0, wall.moved(motion, ties.block[:, end], ties.ends[:, end]), 0.0)
            for end in (0, 1)
        )
        self.longer = ((second - first) * self.along).sum(axis=1)
        owner = np.repeat(np.arange(wall.n), np.diff(self.scene.blocks.first))
        self.fastest = float(np.abs(wall.moved(motion, owner, self.scene.blocks.vertices)).max())
        self.driven = float((motion * self.support).sum() / (self.support**2).sum()) if self.settles else 0.0

    def forces(self) -> dict[str, float]:
        """Errors in equilibrium and strength, relative to the largest force."""
        wall, free = self.wall, ~self.wall.fixed
        given = self.dead if self.settles else self.dead + self.multiplier * self.live
        unbalanced = np.abs((self.inner + given)[free])
        parts = (self.normal, self.tangential, self.pull, given[free, :2])
        self.largest = max(self.nothing, *(float(np.abs(part).max(initial=0.0)) for part in parts))
        beyond = np.abs(self.tangential) - self.shear - wall.friction * self.pressure
        found = {
            "unbalanced force": unbalanced[:, :2].max(),
            "unbalanced moment": (unbalanced[:, 2] / np.sqrt(wall.area[free])).max(),
            "tension beyond the strength": -self.pressure.min(initial=0.0),
            "shear beyond Coulomb": beyond.max(initial=0.0),
            "ties that push": -self.pull.min(initial=0.0),
            "ties beyond their yield": (self.pull - self.scene.ties.yield_force).max(initial=0.0),
        }
        for j, traction in self.crushing.items():
            of_joint = np.array([*self.normal[2 * j : 2 * j + 2], self.tangential[2 * j : 2 * j + 2].sum()])
            found["forces beyond crushing"] = max(
                found.get("forces beyond crushing", 0.0), traction.beyond(of_joint, LARGEST_ERROR / 10 * self.largest)
            )
        return {name: value / self.largest for name, value in found.items()}

    def mechanism(self) -> dict[str, float]:
        """Errors in supports, held motions and the flow rule of the mechanism, relative to its fastest corner."""
        wall, motion = self.wall, self.motion
        held = [
            wall.moved(motion, np.array([block]), at[None])[0] @ direction + turn * motion[block, 2]
            for block, at, direction, turn in wall.held
        ]
        least = wall.friction * np.abs(self.slip) if self.dilatant else 0.0
        found = {
            "supports that do not move as they should": np.abs(motion - self.driven * self.support)[wall.fixed].max(
                initial=0.0
            ),
            "held motions that move": np.abs(held).max(initial=0.0),
            "opening less than the flow rule's": (least - self.opening)[self.uncrushed].max(initial=0.0),
        }
        return {name: value / self.fastest for name, value in found.items()}

    def power(self) -> dict[str, float]:
        """Errors in the multiplier from the mechanism's power: of dissipation for `limit`, otherwise of the forces."""
        free, ties = ~self.wall.fixed, self.scene.ties
        by_dead, by_live = (float((load * self.motion)[free].sum()) for load in (self.dead, self.live))
        if self.settles:
            by_live = -self.driven * self.settlement * self.weight
        if self.dilatant:
            spent = float((self.wall.tension * self.opening + self.shear * np.abs(self.slip))[self.uncrushed].sum())
            for j, traction in self.crushing.items():
                jumps = np.array([*self.opening[2 * j : 2 * j + 2], self.slip[2 * j]])
                spent += float(traction.resultant(jumps) @ jumps)
            spent += ties.yield_force @ self.longer.clip(min=0.0)
        else:
            spent = self.normal @ self.opening + self.tangential @ self.slip + self.pull @ self.longer
        large = BRACKET_WIDTHS[0][0] * (bool(self.crushing) and free.sum() >= LARGE_CRUSHING)
        widest = next(width for blocks, width in BRACKET_WIDTHS if max(free.sum(), large) < blocks)
        lower, upper, here = self.record["lower"], self.record["upper"], self.multiplier
        proved = here if not self.dilatant else lower if self.settles else upper
        found = {
            "multiplier of the mechanism": abs((spent - by_dead) / by_live - proved),
            "multiplier outside its bracket": max(lower - here, here - upper, 0.0),
            "width of the bracket": (upper - lower) * LARGEST_ERROR / widest if self.decided and self.dilatant else 0.0,
        }
        if not self.dilatant:  # the multiplier is the certified load, an end of the interval
            found["nearer end of the interval"] = abs((upper if self.settles else lower) - self.record["multiplier"])
        if self.settles:
            moving = np.abs(self.support).max(axis=1) > 0
            work = float((self.inner * self.support)[moving].sum())
            found["share of the support"] = abs(work / (self.settlement * self.weight) - here)
        # A load or a share of the support that is zero is a rounding error, with no size of its own.
        largest = max(self.nothing, LARGEST_ERROR * float(np.abs(self.dead[free]).max(initial=0.0)))
        least = LARGEST_ERROR if self.settles else largest / float(np.abs(self.live).max(initial=0.0) or 1.0)
        unit = max(abs(by_dead / by_live) + abs(spent / by_live) + abs(here), least) or 1.0
        backwards = by_live >= 0 if self.settles else by_live <= 0
        return {name: value / unit for name, value in found.items()} | {"a load against the motion": float(backwards)}

    def friction(self) -> dict[str, float]:
        """Errors in complementarity of forces and mechanism, without dilatancy."""
        opens, slides = self.opening > LARGEST_ERROR * self.fastest, np.abs(self.slip) > LARGEST_ERROR * self.fastest
        most = np.sign(self.slip) * (self.shear + self.wall.friction * self.pressure)
        short = self.scene.ties.yield_force - self.pull
        found = {
            "pressure where it opens": np.abs(self.pressure[opens]),
            "friction that does not oppose slip at its limit": np.abs(self.tangential - most)[slides],
            "ties that lengthen below their yield": short[self.longer > LARGEST_ERROR * self.fastest],
            "ties that pull while they shorten": self.pull[self.longer < -LARGEST_ERROR * self.fastest],
        }
        return {name: value.max(initial=0.0) / self.largest for name, value in found.items()}

    def measures(self) -> dict[str, float]:
        """All errors; zero for an exact answer."""
        found = {"joints off the outlines of their blocks": off_outlines(self.wall) * LARGEST_ERROR}
        found |= self.forces() | self.mechanism() | self.power()
        return found if self.dilatant else found | self.friction()


def off_outlines(wall: Wall) -> float:
    """Largest distance of a joint's end from the outlines of its blocks, relative to twice the contact gap."""
    joints = wall.scene.joints
    pairs = zip(np.repeat(joints.block, 2, axis=0), joints.ends.reshape(-1, 2), strict=True)
    return max((distance(wall.outlines[k], at) for pair, at in pairs for k in pair), default=0.0) / (2 * wall.gap)


def check(folder: Path) -> bool:
    """Check a folder and print the errors; returns whether all are small."""
    scene, record, arrays = read(folder)
    print(f"{folder}: {record['model']}, {record['status']}, λ = {record['multiplier']}")
    interrupted = record["model"] == "limit" and record["lower"] is not None and len(arrays["force"]) > 0
    if record["status"] != "collapse" and not interrupted:
        print("  no collapse: nothing to check")
        return True
    right = True
    for far in (False, True)[: 2 if record["model"] == "limit-nonassociated" else 1]:
        result = Result(scene, record, arrays, far)
        print(f"  at {result.multiplier}")
        for name, value in result.measures().items():
            right &= bool(value <= LARGEST_ERROR)
            print(f"  {value:9.2e}  {'' if value <= LARGEST_ERROR else 'WRONG: '}{name}")
    return right


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    wrong = [name for name in sys.argv[1:] if not check(Path(name))]
    sys.exit(1 if wrong else 0)
