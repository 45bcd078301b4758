"""Every experiment: its measured edges agree with theory, and its chart is drawn."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from runningbond.studies.page import draw_charts
from runningbond.studies.stability import EXPERIMENTS, experiment
from runningbond.studies.store import failures, run_study


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_every_case_is_measured_once(name: str) -> None:
    study = experiment(name)
    assert study.name == name
    assert len(set(study.cases)) == len(study.cases)
    for part in study.parts.values():
        assert {len(case) for case in part.cases} == {len(part.columns)}


@pytest.mark.long
@pytest.mark.parametrize("name", EXPERIMENTS)
def test_every_edge_agrees_with_theory(name: str, tmp_path: Path) -> None:
    study = experiment(name)
    rows = run_study(study, tmp_path)
    assert not failures(rows)
    assert not [edge for edge in study.edges(rows) if edge.agrees is False]
    for picture in draw_charts(study, rows, tmp_path):
        image = imread(picture.path)[:, :, :3]
        assert 0.01 < (image.min(axis=2) < 0.95).mean() < 0.9
        assert len(np.unique(image @ [1, 256, 65536])) > 100
