"""Masonry walls from their description to their collapse: ``import runningbond as rb``.

Everything here is imported when it is first used, so that the import itself costs nothing.
"""

from typing import TYPE_CHECKING

from .own_packages import prefer_to_folders

if TYPE_CHECKING:
    __version__: str
    from .draws import Draws
    from .fragilities import Fragility, fragility
    from .path_states import PathState
    from .response import Response
    from .run_result import Result
    from .scene import SceneError
    from .sweeps import sweep
    from .wall import Wall, read
else:
    _MODULES = {
        "Draws": "draws",
        "Fragility": "fragilities",
        "PathState": "path_states",
        "Response": "response",
        "Result": "run_result",
        "SceneError": "scene",
        "fragility": "fragilities",
        "Wall": "wall",
        "read": "wall",
        "sweep": "sweeps",
    }

    def __getattr__(name):
        """Import what is asked for (PEP 562)."""
        if name == "__version__":
            from importlib.metadata import version

            return version(__name__)
        if name not in _MODULES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from importlib import import_module

        globals()[name] = getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
        return globals()[name]

    def __dir__():
        return sorted({*globals(), *_MODULES})


prefer_to_folders()

__all__ = [
    "Draws",
    "Fragility",
    "PathState",
    "Response",
    "Result",
    "SceneError",
    "Wall",
    "fragility",
    "read",
    "sweep",
]
