"""The picture of a wall of the laboratory."""

import io
from pathlib import Path

import pytest
from matplotlib.text import Annotation

from runningbond.laboratory.cards import card
from runningbond.laboratory.folder import SHIPPED, read_folder
from runningbond.laboratory.ladder import LADDER
from runningbond.laboratory.predictions import predict, scenes_of

PIXEL = 1.0


@pytest.mark.long
def test_card_draws_the_motion_of_the_model_nearest_to_the_test_and_cuts_no_words(tmp_path: Path) -> None:
    """Not that of the dearest, nor of one that knows no way; J4D is tall, and its title was cut."""
    walls = [wall for wall in read_folder(SHIPPED[1]) if wall.name == "J4D"]
    rungs = [LADDER[name] for name in ("rocking", "sliding", "limit-crushing", "rigid-finite", "rigid")]
    predictions, _ = predict(walls, rungs, scenes_of(walls, rungs), tmp_path, jobs=1)
    figure = card(predictions)
    figure.savefig(io.BytesIO(), dpi=150)
    words = [each for each in figure.findobj(Annotation) if each.get_text()]
    assert any(each.get_text().startswith("rigid-finite: P = ") for each in words)
    for each in words:
        box = each.get_window_extent()
        assert figure.bbox.y0 <= box.y0
        assert box.y1 <= figure.bbox.y1 + PIXEL
