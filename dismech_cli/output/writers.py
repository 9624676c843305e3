"""The writers by the name that a scenario calls them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from ..errors import ScenarioError
from ..frozen import frozen
from .frame import Writer
from .hdf5.writer import Hdf5Writer
from .run_directory import RUN_FILE, SCALARS_FILE
from .table import CsvWriter
from .vtu import FRAMES_FOLDER, SERIES_FILE, VtuWriter


@frozen
class WriterKind:
    """A file format.

    Attributes:
        products: Names of the files and folders that it makes in the run directory.
        make: Makes a writer from the run directory and the time of resumption [s] (None: a new run).
    """

    products: tuple[str, ...]
    make: Callable[[Path, float | None], Writer]


WRITERS: Mapping[str, WriterKind] = {
    "hdf5": WriterKind((RUN_FILE,), lambda run_dir, resume_at: Hdf5Writer(run_dir / RUN_FILE, resume_at)),
    "vtu": WriterKind((SERIES_FILE, FRAMES_FOLDER), VtuWriter),
    "csv": WriterKind(
        (SCALARS_FILE,), lambda run_dir, resume_at: CsvWriter(run_dir / SCALARS_FILE, resume_at)
    ),
}


def make_writer(name: str, run_dir: Path, resume_at: float | None = None) -> Writer:
    """Make the writer called ``name``; it is not open yet.

    Raises:
        ScenarioError: If there is no such writer.
    """
    if name not in WRITERS:
        raise ScenarioError(f"no writer is called {name!r}; choose from {', '.join(sorted(WRITERS))}")
    return WRITERS[name].make(run_dir, resume_at)
