"""Where the methods fail: each is deliberately driven beyond its limit, and the limit is compared with theory.

Each experiment is a module of its own with a `STUDY`.
"""

from importlib import import_module

from runningbond.studies import Study

EXPERIMENTS = (  # names, in the order of the page
    *("time-step", "block-stiffness", "joint-stiffness", "loading-rate", "damping", "verdict", "stiffness-update"),
    *("quadrature", "displacements", "material-edges", "linear-program"),
)
__all__ = ["EXPERIMENTS", "experiment"]


def experiment(name: str) -> Study:
    """An experiment by its name."""
    study: Study = import_module(f"{__name__}.{name.replace('-', '_')}").STUDY
    return study
