"""What limit analysis makes of a scene's ties and beam, for the reader of an outcome."""

from runningbond.scene import Scene


def remarks(scene: Scene, message: str) -> str:
    """A message, and what it is to add of how ties and the beam were taken."""
    notes = {
        "ties count by their yield force alone": len(scene.ties) > 0,
        "of tie.preload, whose friction may hold the wall at these loads, nothing is known": scene.ties.preload.any(),
        "the beam is held at its height by whatever vertical force that takes": len(scene.late_pins) > 0,
        "λ is the force on the beam [N]": len(scene.drive_path) > 0,
        "of the beam's path the first direction counts": len(scene.drive_path) > 1,
    }
    return "; ".join([message, *(note for note, applies in notes.items() if applies)])
