"""The one way bad input is turned away: a single line naming the key, its value and what is right."""


class SceneError(ValueError):
    """Input that describes no wall.

    Parameters
    ----------
    key
        Full name of the offending key, for example ``joint.friction``, or the file's name.
    remedy
        What is wrong and what would be right.
    value
        The value found, where there is one.
    """

    def __init__(self, key: str, remedy: str, value: object = None) -> None:
        found = "" if value is None else f" = {_abbreviated(value)}"
        super().__init__(f"{key}{found}: {' '.join(remedy.split())}")


def _abbreviated(value: object, limit: int = 60) -> str:
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # Python refuses to print integers of thousands of digits
        return "(a number too long to print)"
    return text if len(text) <= limit else f"{text[: limit - 1]}…"
