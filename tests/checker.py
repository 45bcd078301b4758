"""`tools/check_limit.py`, the script that shares no code with the suite, as a function."""

from pathlib import Path
from runpy import run_path

SCRIPT = Path(__file__).parents[1] / "tools" / "check_limit.py"
check = run_path(str(SCRIPT))["check"]
"""``check(folder)``: whether the limit analysis stored in a folder passes this script's independent checks."""
