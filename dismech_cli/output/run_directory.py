"""Where the files of a run lie: made exclusively, locked while in use, never overwritten."""

from __future__ import annotations

import re
import shutil
import sys
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import IO, Self

from ..errors import OutputError
from .durable import output_errors
from .manifest import FILE_NAME as MANIFEST
from .manifest import load_manifest

RUN_FILE = "run.vtkhdf"
SCALARS_FILE = "scalars.csv"
EVENTS_FILE = "events.jsonl"
SCENARIO_FILE = "scenario.resolved.yaml"
LOG_FILE = "log.txt"
CHECKPOINT_FOLDER = "checkpoints"
INPUT_FOLDER = "inputs"
RENDER_FOLDER = "render"

_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}")
_LOCK_FILE = ".lock"
_LEFT_OVER = re.compile(r"\.lock|\.manifest\.\d+\.json")


def create(results: Path, name: str, digest: str) -> Path:
    """Make ``results/<name>/<run-id>`` under an id that nobody else has.

    The id sorts by time: UTC to the second, then six letters of the hash; two runs of one scenario in
    one second get a number behind it.

    Args:
        results: The results folder; made when missing.
        name: Name of the scenario; letters, digits, ``_``, ``-`` and ``.``.
        digest: Hexadecimal hash of the scenario.

    Raises:
        OutputError: If the name could leave the folder or the folder cannot be made.
    """
    if not _NAME.fullmatch(name):
        raise OutputError(
            f"cannot use {name!r} as a folder name: use up to 100 letters, digits, '_', '-' or '.', "
            "not starting with '.' or '-'"
        )
    parent = results / name
    stem = f"{datetime.now(UTC):%Y%m%dT%H%M%SZ}-{digest[:6]}"
    with output_errors(parent, "create"):
        parent.mkdir(parents=True, exist_ok=True)
        for attempt in range(1, 10_000):
            run_dir = parent / (stem if attempt == 1 else f"{stem}-{attempt:04d}")
            try:
                run_dir.mkdir()
            except FileExistsError:
                continue
            return run_dir
    raise OutputError(f"cannot create a run in {parent}: every id that starts with {stem} is taken")


def create_at(run_dir: Path) -> Path:
    """Make the folder that the user named, or take it if it is empty.

    Raises:
        OutputError: If it holds anything, or cannot be made.
    """
    with output_errors(run_dir, "create"):
        run_dir.mkdir(parents=True, exist_ok=True)
        if not _is_unused(run_dir):
            raise OutputError(f"cannot write into {run_dir}: it is not empty; choose another or --overwrite")
    return run_dir


def replace_at(run_dir: Path) -> Path:
    """Make the folder that the user named anew, removing the run that is in it.

    Raises:
        OutputError: If it holds something that is not a run, is in use, or cannot be replaced.
    """
    with output_errors(run_dir, "overwrite"):
        if run_dir.is_dir() and not _is_unused(run_dir):
            _refuse_other(run_dir)
            with RunLock(run_dir):
                for entry in run_dir.iterdir():
                    if entry.is_dir() and not entry.is_symlink():
                        shutil.rmtree(entry)
                    else:
                        entry.unlink()
        run_dir.mkdir(parents=True, exist_ok=True)
    return run_dir


def _is_unused(run_dir: Path) -> bool:
    """Whether nothing is in a folder but what a run leaves that is killed before it has a manifest."""
    return all(_LEFT_OVER.fullmatch(entry.name) and entry.is_file() for entry in run_dir.iterdir())


def _refuse_other(run_dir: Path) -> None:
    """Refuse a folder that is no run of this program: other programs have a manifest of that name too.

    Raises:
        OutputError: Always for such a folder.
    """
    if not (run_dir / MANIFEST).is_file():
        raise OutputError(f"cannot overwrite {run_dir}: it has no {MANIFEST}, so it is not a run")
    if not (run_dir / SCENARIO_FILE).is_file():
        try:
            load_manifest(run_dir)
        except OutputError as error:
            raise OutputError(f"cannot overwrite {run_dir}: its {MANIFEST} is not that of a run") from error


class RunLock:
    """Keeps a second process from writing into a run directory; held as a context manager.

    The system frees the lock when the process ends, however it ends.

    Raises:
        OutputError: On entry, if another process holds it.
    """

    def __init__(self, run_dir: Path) -> None:
        self._run_dir = run_dir
        self._file: IO[bytes] | None = None

    def __enter__(self) -> Self:
        with output_errors(self._run_dir, "lock"):
            file = (self._run_dir / _LOCK_FILE).open("ab")
        try:
            _lock(file)
        except OSError as error:
            file.close()
            raise OutputError(f"another process is writing into {self._run_dir}") from error
        self._file = file
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None


if sys.platform == "win32":

    def _lock(file: IO[bytes]) -> None:
        import msvcrt

        file.seek(0)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)

else:

    def _lock(file: IO[bytes]) -> None:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
