"""The tasks of a campaign, each one model on one scene, and their answers."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import TypeAlias

from runningbond.models import Model, run_model
from runningbond.pictures.moments import with_moments
from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError

from .fingerprint import fingerprint

Cell: TypeAlias = tuple[str, str]  # name of a scene and of a model
INTERRUPTIONS = signal.SIGINT, signal.SIGTERM
"""Signals that interrupt work: Ctrl-C, and a job scheduler's."""
_ONE_AT_A_TIME = threading.Lock()


class ClusterError(Exception):
    """A failure of a cluster; the message gives the reason."""


@dataclass(frozen=True)
class Answer:
    """Result of one model for one scene: an outcome, or the reason why the model does not apply."""

    cell: Cell
    outcome: Outcome | None  # None if the model does not apply
    reason: str = ""  # why the model does not apply
    key: str = ""  # fingerprint of the input and code, taken by the process that computed
    reused: bool = False  # whether the outcome was read from the folder and not computed


@dataclass(frozen=True, eq=False)
class Task:
    """One model to be run on one named scene."""

    name: str
    scene: Scene
    model: Model
    tolerance: float

    @property
    def cell(self) -> Cell:
        """Names of the scene and of the model."""
        return self.name, self.model.name

    def key(self) -> str:
        """Fingerprint under which the outcome is saved, from the sources and libraries of this process."""
        return fingerprint(self.scene, self.model, self.tolerance)

    def run(self) -> Answer:
        """Run the model."""
        key = self.key()
        try:
            with (
                _interruptions_kept(),
                _ONE_AT_A_TIME,
            ):  # a lock for workers with threads, which share one gmsh and one linear algebra library
                return Answer(self.cell, self._outcome(), key=key)
        except SceneError as reason:
            return Answer(self.cell, None, str(reason).removeprefix(f"model {self.model.name}: "), key)

    def _outcome(self) -> Outcome:
        """The outcome, with moments (frames) of the collapse if the model has an observer."""
        if self.model.observer is None:
            return run_model(self.model, self.scene, self.tolerance)
        recorder = self.model.observer(self.scene, None)
        outcome = run_model(self.model, self.scene, self.tolerance, recorder)
        if outcome.status == "failed":
            return outcome
        recorder.finish(outcome)
        return with_moments(self.scene, outcome, recorder.frames)

    def lost(self) -> Answer:
        """The answer for a task whose process was killed."""
        outcome = Outcome(self.scene.title, self.model.name, "failed", message="its process was killed (memory?)")
        return Answer(self.cell, outcome)


@contextmanager
def _interruptions_kept() -> Iterator[None]:
    """Raise KeyboardInterrupt at the end if an interruption only made the model return what it had found so far."""
    before = {number: signal.getsignal(number) for number in INTERRUPTIONS}
    heard, seen = {number: each for number, each in before.items() if callable(each)}, list[int]()
    if not heard or threading.current_thread() is not threading.main_thread():
        yield
        return

    def note(number: int, frame: FrameType | None) -> None:
        seen.append(number)
        heard[signal.Signals(number)](number, frame)

    for number in heard:
        signal.signal(number, note)
    try:
        yield
    finally:
        for number in heard:
            signal.signal(number, before[number])
    if seen:
        raise KeyboardInterrupt
