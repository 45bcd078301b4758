"""What a model said."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Answer:
    """What a model said.

    Parameters
    ----------
    status
        That of `runningbond.results.Outcome`; ``not applicable`` where the model has nothing to say.
    value
        The number that was asked for; None without one.
    lower, upper
        Its bracket, where it has one.
    dofs, steps
        Degrees of freedom and steps, where it has any.
    message
        One line for the reader.
    """

    status: str
    value: float | None = None
    lower: float | None = None
    upper: float | None = None
    dofs: int | None = None
    steps: int | None = None
    message: str = ""
