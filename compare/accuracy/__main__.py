"""Measure one case in this process and print what came of it: see `measure`."""

import json
import sys
from dataclasses import asdict

from .cases import Case
from .measure import measure

part, wall, model, knob, setting = sys.argv[1:]
print(json.dumps(asdict(measure(Case(part, wall, model, knob, setting)))))  # type: ignore[arg-type]
