"""Where the methods fail: every one driven over its edge on purpose, the edge measured and set beside theory.

Each experiment is a module of its own with a `STUDY`.
"""

from importlib import import_module

from runningbond.studies import Study

EXPERIMENTS = (  # their names, in the order in which they are told
    *("time-step", "block-stiffness", "joint-stiffness", "loading-rate", "damping", "verdict", "stiffness-update"),
    *("quadrature", "displacements", "material-edges", "linear-program"),
)
__all__ = ["EXPERIMENTS", "experiment"]


def experiment(name: str) -> Study:
    """An experiment by its name."""
    study: Study = import_module(f"{__name__}.{name.replace('-', '_')}").STUDY
    return study
