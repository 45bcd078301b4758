"""Random scenes with many keys of a scene file, reproducible from a seed; most of the walls stand."""

import random
from itertools import accumulate
from typing import Any

from runningbond.scene import SceneError, scene_from_dict

STIFFNESS = {"normal_stiffness": 1e9, "shear_stiffness": 4e8}
LIVE_KINDS = ("lateral", "lateral", "tilt", "body", "point", "line", "moment")
SUPPORTS = ("base", "base", "base", "fixed-first-course", "corners", "pinned-corners")


class Draw:
    """A wall in running bond, a few courses high, with the random choices of one seed."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.width, self.height = self.random.choice([(0.24, 0.06), (0.24, 0.12), (0.4, 0.175), (0.2, 0.2)])
        self.bricks, self.density = self.random.randint(2, 4), self.random.choice([1800.0, 2400.0])
        first = self.random.randint(0, 1)
        self.courses = [self._course(row + first) for row in range(self.random.randint(2, 5))]
        uneven, count = self.random.random() < 0.3, len(self.courses)
        heights = [self.height * (self.random.choice([0.75, 1.0, 1.5]) if uneven else 1.0) for _ in range(count)]
        self.levels = [0.0, *accumulate(heights)]
        self.wall: dict[str, Any] = {"block_width": self.width, "thickness": 0.1, "courses": self.courses}
        self.wall |= {"course_heights": heights} if uneven else {"block_height": self.height}
        self.length, self.top = self.bricks * self.width, self.levels[-1]
        if self.bricks > 2 and count > 3:
            change = self.random.choice([self._leave_out, self._open, None])
            if change:
                change()
        self.brick = self.width * self.height * 0.1 * self.density * 9.81  # weight [N]

    def _course(self, row: int) -> list[float]:
        return [0.5, *[1.0] * (self.bricks - 1), 0.5] if row % 2 else [1.0] * self.bricks

    def _open(self) -> None:
        """Cut a door or a window into the wall, under a lintel or a brick."""
        left, low = self.width * self.random.choice([0.8, 1.0, 1.25]), self.random.choice([0, 1])
        right, high = left + self.width * self.random.choice([0.5, 0.7, 1.0]), self.levels[low + 1]
        opening: dict[str, Any] = {"from": [left, self.levels[low]], "to": [right, high]}
        if self.random.random() < 0.7:
            height = self.levels[low + 2] - high
            opening["lintel"] = {"height": height, "bearing": 0.3 * self.width, "material": "light"}
        self.wall["opening"] = [opening]

    def _leave_out(self) -> None:
        """Take a brick out of the second course."""
        course = self.courses[1]
        inside = range(1, len(course) - 1)
        course[self.random.choice(inside)] *= -1

    def near(self, size: float, spread: float = 2.0) -> float:
        """Random number within a factor `spread` of `size`, to four digits."""
        return float(f"{size * spread ** self.random.uniform(-1, 1):.4g}")

    def maybe(self, share: float) -> bool:
        """Return True with probability `share`."""
        return self.random.random() < share

    def centre(self) -> list[float]:
        """Middle of a random brick."""
        row = self.random.randrange(len(self.courses))
        standing = [k for k, share in enumerate(self.courses[row]) if share > 0]
        k = self.random.choice(standing)
        x = sum(map(abs, self.courses[row][:k])) + self.courses[row][k] / 2
        return [x * self.width, (self.levels[row] + self.levels[row + 1]) / 2]

    def along_top(self) -> float:
        """Position x on the top, away from joints."""
        return self.length * self.random.choice([0.0, 0.11, 0.37, 0.59, 0.93, 1.0])

    def direction(self) -> Any:
        """Right, left, or slightly inclined."""
        return self.random.choice(["right", "left", [1.0, 0.1], [-1.0, -0.2]])

    def load(self, kind: str, size: float) -> dict[str, Any]:
        """A load of a kind; `size` in weights of a brick, and forces have only a small horizontal part."""
        sideways = self.random.choice([0.0, 0.2, -0.2]) * self.near(size)
        down = -self.near(size)
        force = [round(self.brick * sideways, 6), round(self.brick * down, 6)]
        if kind in ("lateral", "tilt"):
            return {"kind": kind, "direction": self.direction()}
        if kind == "body":
            return {"kind": kind, "acceleration": [self.random.choice([-1.0, 1.0]) * self.near(2.0), -self.near(0.5)]}
        if kind == "point":
            return {"kind": kind, "at": [self.along_top(), self.top], "force": force}
        if kind == "line":
            ends = sorted(self.random.sample([0.0, 0.21, 0.5, 0.77, 1.0], 2))
            line = [[share * self.length, self.top] for share in ends]
            return {"kind": kind, "from": line[0], "to": line[1], "force": [f / self.length for f in force]}
        moment = self.random.choice([-0.1, 0.1]) * self.near(self.brick * self.width * size)
        return {"kind": kind, "at": self.centre(), "moment": moment}

    def settlement(self) -> dict[str, Any]:
        """Ground that moves under the left or right part of the wall."""
        cut = self.length * self.random.choice([0.3, 0.45, 0.7])
        box = [[cut, -9.0], [9.0, 0.01]] if self.maybe(0.5) else [[-9.0, -9.0], [cut, 0.01]]
        load: dict[str, Any] = {"kind": "settlement", "box": box}
        choice = self.random.randrange(4)
        if choice < 3:
            load["by"] = ([0.0, -0.01], [0.004, -0.01], [-0.002, -0.005])[choice]
        else:
            load |= {"rotation_angle": self.random.choice([-0.5, 0.5]), "about": [cut, 0.0]}
        return load

    def joint(self) -> dict[str, Any]:
        """A joint material, dry or weak."""
        joint: dict[str, Any] = {"friction": round(self.random.uniform(0.3, 1.0), 3)} | STIFFNESS
        if self.maybe(0.3):
            joint["cohesion"] = self.near(20 * self.brick)
            if self.maybe(0.5):
                joint["tensile_strength"] = 0.5 * joint["cohesion"]
        if self.maybe(0.2):
            joint["inset"] = round(0.04 * min(self.width, self.height), 6)
        return joint

    def assignments(self) -> list[dict[str, Any]]:
        """Entries that assign other materials to some blocks and joints."""
        x, y = self.length * self.random.choice([0.4, 0.6]), self.height * self.random.choice([1.0, 2.0])
        entries: list[dict[str, Any]] = [
            {"block": "heavy", "box": [[-1.0, -1.0], [x, y]]},
            {"block": "light", "blocks": [0, 2]},
            {"joint": "mortar", "orientation": self.random.choice(["bed", "head"])},
            {"joint": "mortar", "box": [[-1.0, y - 0.01], [9.0, 9.0]], "orientation": "bed"},
            {"joint": "rough", "between": ["heavy", "*"]},
            {"joint": "rough", "between": ["ground", "*"]},
        ]
        heavy = entries[:1] if self.maybe(0.5) else []
        others = self.random.sample(entries[1:4] + (entries[4:5] if heavy else []), self.random.randint(0, 2))
        return heavy + others

    def beam(self) -> dict[str, Any]:
        """A beam on top, driven or not."""
        beam: dict[str, Any] = {
            "height": 0.2,
            "condition": self.random.choice(["free", "level", "level", "fixed-height"]),
            "mass": self.random.choice([0.0, 20.0]),
            "force": [0.0, -self.near(4 * self.brick)],
        }
        if self.maybe(0.5):
            beam["joint"] = "rough"
        if self.maybe(0.8):
            beam["drive"] = self.random.choice(
                [
                    {"force": [self.random.choice([-1.0, 1.0]), 0.0]},
                    {"force": [1.0, 0.0], "at": self.top},
                    {"displacement": [0.005, 0.0]},
                    {"displacement": [[0.0, -0.001, 0.002]], "rate": 1e-3},
                ]
            )
        return beam

    def ties(self) -> list[dict[str, Any]]:
        """One or two bars, between bricks or to an anchor beside the wall."""
        ties = []
        for _ in range(self.random.randint(1, 2)):
            start = self.centre()
            beside = [self.random.choice([-1.0, self.length + 1.0]), start[1]]
            end = beside if self.maybe(0.5) else self.centre()
            if end != start:
                pull = self.near(2 * self.brick)
                ties.append({"from": start, "to": end, "area": 1e-4, "young": 2e11, "yield": pull, "preload": pull / 4})
        return ties


def random_scene(seed: int) -> dict[str, Any]:
    """Tables of a scene file; drawn again if refused, such as a moment applied on a joint or an empty box."""
    for again in range(100):
        scene = _drawn(seed + 1000 * again)
        try:
            scene_from_dict(scene)
        except SceneError:
            continue
        return scene
    raise AssertionError(f"a hundred scenes like that of seed {seed} were refused")


def _drawn(seed: int) -> dict[str, Any]:
    draw = Draw(seed)
    scene: dict[str, Any] = {
        "title": f"random {seed}",
        "wall": draw.wall,
        "block": {"density": draw.density, "young": 1e10},
        "joint": draw.joint(),
        "materials": {"heavy": {"density": 3000.0, "young": 1e10}, "light": {"density": 800.0, "young": 1e10}},
        "joints": {"mortar": draw.joint(), "rough": {"friction": 0.9} | STIFFNESS},
        "support": {"kind": draw.random.choice(SUPPORTS)},
    }
    if draw.maybe(0.6):
        scene["assign"] = draw.assignments()
    settles, driven = draw.maybe(0.2), False
    if draw.maybe(0.3) and not settles:
        scene["beam"] = draw.beam()
        driven = "displacement" in scene["beam"].get("drive", {})
    if draw.maybe(0.35):
        scene["tie"] = draw.ties()
    scene["load"] = {"gravity": 9.81 if draw.maybe(0.8) else [0.3, -9.81]}
    if draw.maybe(0.5):
        kinds = draw.random.sample(["point", "line", "moment"], draw.random.randint(1, 2))
        scene["load"]["dead"] = [draw.load(kind, 0.5) for kind in kinds]
    if settles:
        scene["support"] = {"kind": draw.random.choice(["base", "base", "fixed-first-course"])}
        scene["load"]["live"] = draw.settlement()
    elif not driven:
        kinds = draw.random.choices(LIVE_KINDS, k=draw.random.choice([1, 1, 2, 3]))
        live = [draw.load(kind, 1.0) for kind in kinds]
        scene["load"]["live"] = live if len(live) > 1 or draw.maybe(0.5) else live[0]
    return scene


def mirrored(scene: Any, span: float | None = None, key: str = "") -> Any:
    """A scene of `random_scene` with left and right exchanged."""
    if span is None:
        span = scene["wall"]["block_width"] * sum(map(abs, scene["wall"]["courses"][0]))
    if isinstance(scene, dict) and key == "opening":
        (x0, y0), (x1, y1) = scene["from"], scene["to"]
        return scene | {"from": [span - x1, y0], "to": [span - x0, y1]}
    if isinstance(scene, dict):
        whole = {name: mirrored(value, span, name) for name, value in scene.items()}
        if "blocks" in whole:
            raise ValueError("blocks by number: their order is not mirrored")
        return whole
    if key == "courses":
        return [course[::-1] for course in scene]
    if key == "box":
        (x0, y0), (x1, y1) = scene
        return [[span - x1, y0], [span - x0, y1]]
    if key in ("at", "from", "to", "about") and isinstance(scene, list):
        return [span - scene[0], scene[1]]
    if key in ("force", "acceleration", "direction", "by", "gravity") and isinstance(scene, list):
        return [-scene[0], scene[1]]
    if key == "displacement":
        return [[-x for x in scene[0]]] if isinstance(scene[0], list) else [-scene[0], 0.0]
    if key in ("moment", "rotation_angle"):
        return -scene
    if key == "direction":
        return {"left": "right", "right": "left"}[scene]
    if isinstance(scene, list):
        return [mirrored(value, span, key) if isinstance(value, dict) else value for value in scene]
    return scene
