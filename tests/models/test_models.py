"""The registry of models by name."""

from functools import partial
from importlib import import_module

import pytest

from runningbond.models import MODELS


@pytest.mark.parametrize("name", MODELS)
def test_lazily_imported_functions_of_models_exist(name: str) -> None:
    """Modules that are slow to import are named by strings, which a type checker does not check."""
    model = MODELS[name]
    late = [each for each in (model.solve, model.observer, model.progress) if isinstance(each, partial)]
    assert all(callable(getattr(import_module(each.args[0]), each.args[1])) for each in late)
