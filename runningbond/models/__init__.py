"""The models, which compute an outcome from a scene: one object each, and all of them by name."""

from .model import Cost, Kind, Model, Progress, Recorder
from .registry import (
    MODEL_LOOKS,
    MODELS,
    TOLERANCE,
    check_parameters,
    check_tolerance,
    find_model,
)
from .run import check_response, respond, run_model

__all__ = [
    "MODELS",
    "MODEL_LOOKS",
    "TOLERANCE",
    "Cost",
    "Kind",
    "Model",
    "Progress",
    "Recorder",
    "check_parameters",
    "check_response",
    "check_tolerance",
    "find_model",
    "respond",
    "run_model",
]
