"""``runningbond schema``."""

import json

from runningbond.scene.schema import scene_schema

from .terminal import DONE


def schema() -> int:
    """Print the JSON schema of scene files, which editors use to complete and check them."""
    print(json.dumps(scene_schema(), indent=2, allow_nan=False))
    return DONE
