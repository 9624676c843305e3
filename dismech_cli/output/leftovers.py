"""Files that a killed process left half written in a run directory."""

from __future__ import annotations

import re
import time
from contextlib import suppress
from pathlib import Path

from .checkpoint import NAME as CHECKPOINT
from .manifest import FILE_NAME as MANIFEST
from .run_directory import CHECKPOINT_FOLDER, INPUT_FOLDER, RENDER_FOLDER, SCENARIO_FILE
from .vtu import FRAMES_FOLDER, SERIES_FILE

# As `staged` names them: hidden, with the number of the process before the suffix.
_STAGED = re.compile(r"\.(?P<stem>.+)\.\d+(?P<suffix>\.[A-Za-z0-9]+)")
_OURS = {
    ".": re.compile("|".join(re.escape(name) for name in (MANIFEST, SCENARIO_FILE, SERIES_FILE))),
    CHECKPOINT_FOLDER: CHECKPOINT,
    FRAMES_FOLDER: re.compile(r".+\.vtu"),
    INPUT_FOLDER: re.compile(r".+"),
    RENDER_FOLDER: re.compile(r".+\.(mp4|gif|png|pdf|svg)"),
}
# Pictures are drawn without the lock: what is younger may be of a process that lives [s].
_AGE = 3600.0


def remove_leftovers(run_dir: Path) -> list[Path]:
    """Remove what is half written; the caller holds the lock of the directory.

    Returns:
        The files removed; others, hidden or not, are left alone.
    """
    removed = []
    for folder, ours in _OURS.items():
        for file in sorted((run_dir / folder).glob(".*")):
            name = _STAGED.fullmatch(file.name)
            if name is None or not ours.fullmatch(name["stem"] + name["suffix"]):
                continue
            with suppress(OSError):
                if folder == RENDER_FOLDER and time.time() - file.stat().st_mtime < _AGE:
                    continue
                file.unlink()
                removed.append(file)
    return removed
