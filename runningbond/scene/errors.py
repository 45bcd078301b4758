"""How bad input is refused: one line that names the key, its value and what would be right."""

from collections.abc import Iterator
from contextlib import contextmanager

LONGEST = 60
"""Characters of a value that are shown."""


class SceneError(ValueError):
    """Input that describes no wall.

    Parameters
    ----------
    key
        Full name of the offending key, for example ``joint.friction``, or the file's name.
    remedy
        What is wrong and what would be right.
    value
        The value, where there is one.
    """

    def __init__(self, key: str, remedy: str, value: object = None) -> None:
        super().__init__(key, remedy, value)
        self.key, self.remedy, self.value = key, remedy, value

    def __str__(self) -> str:
        value = "" if self.value is None else f" = {_abbreviated(self.value)}"
        return f"{self.key}{value}: {' '.join(self.remedy.split())}"


@contextmanager
def keys_of(table: str, default: str) -> Iterator[None]:
    """Name keys after the table that they were read from, where an object names them after its usual one."""
    try:
        yield
    except SceneError as error:
        if not error.key.startswith(f"{default}."):
            raise
        raise SceneError(table + error.key.removeprefix(default), error.remedy, error.value) from None


def _abbreviated(value: object) -> str:
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # Python refuses to print integers of thousands of digits
        return "(a number too long to print)"
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
