"""The one place where what happened ends the process."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Sequence
from typing import Any, NoReturn

import typer

from ..errors import DismechError
from ..session.exit_codes import Exit
from .console import ClosedPipeError, Console

# The base of all usage errors: the module that defines it differs between versions of Typer.
_UsageError: Any = typer.BadParameter.__base__


def leave(app: typer.Typer, arguments: Sequence[str] | None) -> NoReturn:
    """Run ``app`` and end the process."""
    code = exit_code(app, arguments)
    try:
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
    sys.exit(code)


def exit_code(app: typer.Typer, arguments: Sequence[str] | None) -> int:
    """Run ``app``; tell the user about any failure on stderr and return its code."""
    console = Console()
    try:
        return app(args=arguments, prog_name="dismech", standalone_mode=False) or Exit.DONE
    except _UsageError as error:
        error.show()
        return Exit.INPUT
    except DismechError as error:
        console.error(str(error))
        return error.exit_code
    except (ClosedPipeError, BrokenPipeError):
        return Exit.CLOSED_PIPE
    except (KeyboardInterrupt, typer.Abort):
        return Exit.INTERRUPTED
    except Exception:
        traceback.print_exc()
        console.error("this is a bug in dismech: please report it with the lines above and the scenario")
        return Exit.BUG
