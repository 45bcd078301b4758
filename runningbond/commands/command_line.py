"""The command line of ``runningbond``: all commands, and the handling of their errors."""

import io
import os
import signal
import sys
from collections.abc import Sequence
from importlib.metadata import version

from cyclopts import App, CycloptsError, UnusedCliTokensError

from runningbond.pictures.vtk_safety import VtkError
from runningbond.results import StoreError
from runningbond.scene import SceneError

from .advise import advise
from .compare import compare
from .mesh import mesh
from .new import new
from .render import render
from .respond import respond
from .run import run
from .schema import schema
from .show import show
from .studies import stability, study
from .terminal import BAD_INPUT, DONE, NO_ANSWER, STOPPED, interruptions, listen, say
from .validate import validate

app = App(
    name="runningbond",
    help="From the description of a masonry wall to its collapse.",
    version=lambda: version("runningbond"),
    result_action="return_value",
    suppress_keyboard_interrupt=False,
)
for each in (new, run, respond, show, advise, compare, stability, study, validate, mesh, render, schema):
    app.command(each)
app.register_install_completion_command()


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with its exit code."""
    signals = interruptions()
    try:
        code = command(arguments)
    except Exception:
        if not signals:
            raise
        code = _stopped()  # within an import or a callback, libraries turn the KeyboardInterrupt into another error
    listen(signal.SIG_DFL)  # nothing is left but to end idle workers: an exception raised meanwhile would be lost
    sys.exit(code)


def command(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; bad input yields one line on standard error and exit code 2."""
    tokens = list(sys.argv[1:] if arguments is None else arguments)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")
    try:
        if tokens and not tokens[0].startswith("-"):
            _check_backend()
        result = app(tokens, exit_on_error=False, print_error=False)
        sys.stdout.flush()
    except UnusedCliTokensError as error:
        return _left_with(f"{' '.join(error.unused_tokens or ())}: is not an argument of this command", BAD_INPUT)
    except (SceneError, StoreError, CycloptsError) as error:
        return _left_with(str(error), BAD_INPUT)
    except VtkError as error:
        return _left_with(str(error), NO_ANSWER)
    except BrokenPipeError:  # the reader has closed the pipe
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return DONE
    except OSError as error:
        return _left_with(f"{error.filename or 'output'}: {error.strerror or error}", BAD_INPUT)
    except KeyboardInterrupt:
        return _stopped()
    return result if isinstance(result, int) else DONE


def _check_backend() -> None:
    """Refuse a backend that matplotlib does not have, before results are computed that could not be drawn."""
    backend = os.environ.get("MPLBACKEND")
    if backend:
        try:
            import matplotlib  # noqa: F401
        except ValueError as error:
            what = "is not a backend of matplotlib; leave it unset, or take agg"
            raise SceneError("MPLBACKEND", what, backend) from error


def _stopped() -> int:
    return _left_with("interrupted; every file is whole, or as it was before", STOPPED)


def _left_with(message: str, code: int) -> int:
    """Print a line on standard error, and return the exit code."""
    say(message)
    return code
