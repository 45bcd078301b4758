"""Measure one case in this process and print what came of it: see `measure`."""

import json
import signal
import sys
from dataclasses import asdict

from .cases import Case
from .measure import measure

# The study ends this process; a model that is interrupted would end with what it has, as if that were its answer.
signal.signal(signal.SIGINT, signal.SIG_IGN)
part, wall, model, knob, setting = sys.argv[1:]
print(json.dumps(asdict(measure(Case(part, wall, model, knob, setting)))))  # type: ignore[arg-type]
