"""The one place where what happened ends the process."""

from __future__ import annotations

import atexit
import os
import sys
import traceback
import warnings
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn, TextIO

import typer

from ..errors import DismechError, OutputError
from ..session.exit_codes import Exit
from ..session.garbage import search_postponed
from .console import ClosedPipeError, Console, emit
from .interruption import Interruption, interruptible

# The base of all usage errors: the module that defines it differs between versions of Typer.
_UsageError: Any = typer.BadParameter.__base__
_PACKAGE = Path(__file__).resolve().parents[1]


def leave(app: typer.Typer, arguments: Sequence[str] | None) -> NoReturn:
    """Run ``app`` and end the process, at once if it is all that the process is for."""
    ended: list[int] = []
    if arguments is None:
        # the first to be registered is the last to be called
        atexit.register(_end, ended)
    _open_closed_streams()
    _show_warnings_plainly()
    code = exit_code(app, arguments)
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except BrokenPipeError:
        code = Exit.CLOSED_PIPE
    except OSError as error:
        if code != Exit.OUTPUT:
            Console().error(f"cannot write to standard output: {error.strerror}")
        code = Exit.OUTPUT
    if code == Exit.CLOSED_PIPE:
        # The interpreter flushes once more at its end and would complain.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    if code == Exit.OUTPUT:
        # HDF5 tries to write again when the interpreter ends, and crashes on a full disk.
        sys.stderr.flush()
        os._exit(code)
    ended.append(code)
    sys.exit(code)


def _end(ended: Sequence[int]) -> None:
    """Leave memory to the system: taking a thousand modules apart takes as long as a hundred steps."""
    if not ended:
        return
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            with suppress(OSError, ValueError):
                stream.flush()
    os._exit(ended[-1])


def _open_closed_streams() -> None:
    """Keep the numbers of closed streams from files opened later, which would be taken for the streams."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)


def _show_warnings_plainly() -> None:
    """Warnings of this program without the line of source that gave them.

    Those of numbers that overflow are left out: what cannot be computed is told where the run ends by it.
    """
    otherwise = warnings.showwarning

    def show(
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        if not Path(filename).is_relative_to(_PACKAGE):
            otherwise(message, category, filename, lineno, file, line)
        elif not issubclass(category, RuntimeWarning):
            Console().warn(str(message))

    warnings.showwarning = show


def exit_code(app: typer.Typer, arguments: Sequence[str] | None) -> int:
    """Run ``app``; tell the user about any failure on stderr and return its code.

    Where the result was to be JSON, a failure is JSON on stdout as well.
    """
    given = sys.argv[1:] if arguments is None else arguments
    try:
        with interruptible(), search_postponed():
            return app(args=arguments, prog_name="dismech", standalone_mode=False) or Exit.DONE
    except (ClosedPipeError, BrokenPipeError):
        return Exit.CLOSED_PIPE
    except Exception as error:
        code = _tell(error)
        return code if "--json" not in given else _as_json(error, code)
    except Interruption as error:
        Console().error(str(error))
        return error.exit_code if "--json" not in given else _as_json(error, error.exit_code)


def _tell(error: Exception) -> int:
    """Say on stderr what went wrong; the code of it."""
    console = Console()
    match error:
        case _UsageError():
            error.show()
            return Exit.INPUT
        case DismechError():
            console.error(str(error))
            return error.exit_code
        case typer.Abort():
            return Exit.INTERRUPTED
        case _:
            traceback.print_exception(error)
            console.error("this is a bug in dismech: please report it with the lines above and the scenario")
            return Exit.BUG


def _as_json(error: BaseException, code: int) -> int:
    """Print a failure for programs; a reader that went away has its own code."""
    from ..output.jsonable import dumps
    from ..session.faults import fault, faults

    match error:
        case _UsageError():
            errors = [fault(error.format_message())]
        case _:
            errors = faults(error)
    status = "interrupted" if isinstance(error, Interruption | typer.Abort) else "failed"
    try:
        emit(dumps({"status": status, "exit_code": int(code), "errors": errors}, indent=2))
    except ClosedPipeError:
        return Exit.CLOSED_PIPE
    except OutputError:
        return code
    return code
