"""What the pages of the reference name is there: a page of the documentation takes minutes to build, and no test does."""

import re
from pathlib import Path
from pydoc import locate

import pytest

PAGES = sorted((Path(__file__).parents[2] / "docs").rglob("*.rst"))
NAMED = [
    name for page in PAGES for name in re.findall(r"^\.\. auto\w+:: ([\w.]+)", page.read_text(encoding="utf-8"), re.M)
]


def test_pages_name_something() -> None:
    assert len(NAMED) > 50


@pytest.mark.parametrize("name", sorted(set(NAMED)))
def test_what_a_page_documents_is_there(name: str) -> None:
    assert locate(name) is not None
