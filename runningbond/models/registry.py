"""The models, one object each, and all of them in `MODELS` by their names on the command line.

A user's own model is another `Model`: add it to `MODELS`, or pass it to `run_model`.
"""

import math
from collections.abc import Mapping
from functools import partial
from importlib import import_module
from numbers import Real
from typing import Any

from runningbond.limit import limit, limit_nonassociated
from runningbond.own_packages import hidden_package, prefer_to_folders
from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError
from runningbond.scene.ranges import suggestion

from .model import Cost, Model
from .second_opinion import REFINEMENT, asks_others, beside_others

DRY = frozenset({"block.density", "block.thickness", "joint.friction"})
STRENGTH = DRY | {"joint.law", "joint.cohesion", "joint.tensile_strength", "joint.inset", "inner_joint"}
CRUSHING = STRENGTH | {"joint.compressive_strength", "joint.cap_shear"}
STIFFNESS = STRENGTH | {"joint.mortar", "joint.normal_stiffness", "joint.shear_stiffness"}
SOFTENING = STIFFNESS | {"joint.fracture_energy_1", "joint.fracture_energy_2", "joint.softening"}
INTERFACE = SOFTENING | CRUSHING | {"joint.compressive_fracture_energy", "joint.peak_closure", "joint.closure"}
MOTION = INTERFACE | {"beam.drive.rate"}
ELASTIC = MOTION | {"block.young", "block.poisson"}

LED = {"beam.condition fixed-height", "beam.drive.displacement", "beam.drive.displacement, cyclic"}
EXTRAS = frozenset({"tie", "beam", "load.live settlement"} | LED)  # features (`Scene.extras`) of static models,
FOLLOWED = EXTRAS | {"load.live settlement, along a path"}  # and of models that follow a load path
KERNELS = 0.3  # seconds to load the compiled kernels of models that follow a load path
TOLERANCE = 0.01  # default relative width of the bracket
IN_STEPS = ("collapse", "first_step", "budget")  # settings of every model with load steps
OF_BLOCKS = ("cells", "modes", "rule", "points", "cracks", "loads", "mass_scaling", "energies")  # for deformable blocks


def _homog(scene: Scene, tolerance: float) -> Outcome:
    outcome: Outcome = _late("homog", "homog", scene)
    return outcome


def _late(module: str, name: str, *arguments: Any, **settings: Any) -> Any:
    """Import a module of a method's package, or one that needs a compiler or VTK, and call its function or class."""
    prefer_to_folders()  # the working directory may have gained folders of these names since the import of the suite
    hidden = hidden_package(module)
    if hidden is not None:
        raise SceneError("import", hidden)
    return getattr(import_module(module), name)(*arguments, **settings)


_DEM_STATIC, _DEM_DYNAMIC = partial(_late, "dem.static", "dem_static"), partial(_late, "dem.dynamic", "dem_dynamic")


def _fem(scene: Scene, tolerance: float, **settings: Any) -> Outcome:
    deformable = partial(_late, "fem_interface.model", "fem", scene, tolerance)
    outcome: Outcome = deformable(**settings)
    if not asks_others(scene, settings):
        return outcome
    chosen = {key: value for key, value in settings.items() if key in (*IN_STEPS, *OF_BLOCKS)}
    steps = {key: value for key, value in chosen.items() if key in IN_STEPS}
    turn_to = getattr(settings.get("observe"), "turn_to", None)

    def observed(other: str) -> dict[str, Any]:
        return {} if turn_to is None else {"observe": turn_to(other)}

    return beside_others(
        outcome,
        lambda: _DEM_DYNAMIC(scene, tolerance, **steps, **observed("with rigid blocks")),
        lambda: deformable(**chosen | {"cells": REFINEMENT}, **observed(f"on a mesh {REFINEMENT} times as fine")),
    )


_RECORDER = partial(_late, "runningbond.pictures.recording")
_PROGRESS = partial(_late, "runningbond.pictures.progress")
_IN_MOTION: dict[str, Any] = {"interruptible": True, "takes": FOLLOWED | {"load.history"}}
_IN_MOTION |= {"observer": partial(_RECORDER, "motion_recorder"), "progress": partial(_PROGRESS, "MotionProgress")}

_EVERY_MODEL = (
    Model(
        *("homog", "homogenised continuum in closed form", _homog, DRY),
        cost=Cost(0.00029, 0.97, 1.69),
        colour="black",
        marker="_",
        line=(0, (6, 4)),
    ),
    Model(
        *("limit", "limit analysis of the blocks", limit, CRUSHING, "bound"),
        interruptible=True,
        takes=EXTRAS,
        cost=Cost(0.035, 1.34, 1.70, weightless=0.69, start=0.012, crushed=37.0),
        colour="#606fc6",
        marker="o",
    ),
    Model(
        *("limit-nonassociated", "limit analysis with friction that does not dilate", limit_nonassociated, STRENGTH),
        kind="certificate",
        takes=EXTRAS,
        parameters=("starts", "workers", "programs"),
        progress=partial(_PROGRESS, "SearchProgress"),
        interruptible=True,
        cost=Cost(5.0, 0.69, 1.82, weightless=1.2),
        colour="#9b471c",
        marker="s",
    ),
    Model(
        *("dem-static", "equilibrium of rigid blocks, load by load", _DEM_STATIC, STIFFNESS, "history"),
        parameters=(*IN_STEPS, "past"),
        observer=partial(_RECORDER, "StaticRecorder"),
        progress=partial(_PROGRESS, "StaticProgress"),
        interruptible=True,
        cost=Cost(0.49, 1.76, 1.48, weightless=0.72, finer=0.24, start=KERNELS),
        takes=FOLLOWED,
        colour="#420697",
        marker="v",
    ),
    Model(
        *("dem-dynamic", "rigid blocks in motion", _DEM_DYNAMIC, MOTION, "history"),
        parameters=(*IN_STEPS, "displacements", "distance"),
        cost=Cost(1.0, 1.19, 1.40, weightless=1.2, finer=0.17, start=KERNELS, softened=4.0, crushed=11.0),
        respond=partial(_late, "dem.dynamic", "dem_response"),
        **_IN_MOTION,
        colour="#349f8a",
        marker="^",
        line=":",
    ),
    Model(
        *("fem", "deformable blocks in motion", _fem, ELASTIC, "history"),
        parameters=(*IN_STEPS, *OF_BLOCKS, "displacements", "distance"),
        cost=Cost(
            *(3.2, 1.08, 1.43),
            weightless=1.4,
            finer=0.16,
            start=KERNELS,
            cracked=15.0,
            softened=2.2,
            crushed=4.3,
            soft=2.1,
        ),
        respond=partial(_late, "fem_interface.model", "fem_response"),
        **_IN_MOTION,
        colour="#7e2a55",
        marker="D",
        line=(0, (3, 1, 1, 1)),
    ),
)

MODELS: dict[str, Model] = {model.name: model for model in _EVERY_MODEL}
"""Every model by its name, the cheapest first."""

MODEL_LOOKS = {model.name: (model.colour, model.marker) for model in _EVERY_MODEL}  # in charts


def find_model(model: str | Model, key: str = "model") -> Model:
    """The model with a name, or a `SceneError` under `key` (a key or option); a `Model` is returned as it is."""
    if isinstance(model, Model):
        return model
    if not isinstance(model, str) or model not in MODELS:
        raise SceneError(key, f"must be one of {', '.join(MODELS)}{suggestion(model, list(MODELS))}", model)
    return MODELS[model]


def check_tolerance(tolerance: float, key: str = "tolerance") -> None:
    """Refuse a tolerance that is no relative width, under its key or option."""
    if not (isinstance(tolerance, Real) and math.isfinite(tolerance) and 0 < tolerance < 1):
        raise SceneError(key, "must be a number above 0 and below 1", tolerance)


def check_parameters(model: Model, parameters: Mapping[str, Any]) -> None:
    """Refuse settings that a model does not have."""
    for name, value in parameters.items():
        if name not in model.parameters:
            own = ", ".join(model.parameters) or "none"
            raise SceneError(f"model {model.name}: {name}", f"is not a parameter of it; it has {own}", value)
