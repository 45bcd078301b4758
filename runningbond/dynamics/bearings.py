"""Joints that bear on a part of their initial length, because blocks or supports have slid off each other."""

import numpy as np

from runningbond.contacts.search import length_left
from runningbond.joints import wall_caps
from runningbond.results.outcome import two_digits
from runningbond.scene import Scene

from .contact_update import contacts_of
from .run import Run
from .state import State

SHORT = 0.8
"""Part of a joint's initial length below which its strength is noticeably smaller than the model's."""


def bearing_note(run: Run, scene: Scene, state: State) -> str:
    """Note on joints that may crush and are pressed on less than `SHORT` of the length that the model gives them."""
    search = run.system.contacts
    strength, _ = wall_caps(scene, np.arange(len(scene.joints)))
    if search is None or np.isinf(strength).all():
        return ""
    contacts = contacts_of(state)
    _, end = search.points(contacts)
    pressed = np.unique(end[(end >= 0) & (run.tractions(state)[2] < 0)])
    crushes = np.append(np.isfinite(strength), False)[contacts.joint[pressed]]
    left = length_left(search.outline, contacts, run.system.motion_of_bodies(state.motion).ravel())[pressed[crushes]]
    if left.min(initial=1.0) >= SHORT:
        return ""
    share = f"{two_digits(100 * max(0.0, float(left.min())))} %"
    return f"a joint bears on {share} of its initial length, and crushes as if on all of it: the wall may bear less"
