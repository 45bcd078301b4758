"""Where the methods fail: every one driven over its edge on purpose, the edge measured and set beside theory.

Each experiment is a module of its own with a function ``experiment()`` that returns a `Finding`.
"""

from importlib import import_module

from .finding import Edge, Entry, Finding

EXPERIMENTS = (
    "time-step",
    "block-stiffness",
    "joint-stiffness",
    "loading-rate",
    "damping",
    "verdict",
    "stiffness-update",
    "quadrature",
    "displacements",
    "material-edges",
    "linear-program",
    "machine",
)
"""Names of the experiments, in the order in which they are told."""

__all__ = ["EXPERIMENTS", "Edge", "Entry", "Finding", "find_out"]


def find_out(name: str) -> Finding:
    """Do an experiment by its name."""
    module = import_module(f"{__name__}.{name.replace('-', '_')}")
    finding = module.experiment()
    assert isinstance(finding, Finding)
    return finding
