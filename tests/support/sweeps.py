"""Sweeps of the small swinging rod, and points that misbehave."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import h5py
import pytest
from cli_process import EXPECT, SWING

PARAMETERS = """\
parameters:
  E: {default: 2 MPa, min: 1 kPa}
  load: {default: 9.81, kind: acceleration}
"""
SCENE = (SWING + EXPECT).replace("youngs_modulus: 2 MPa", "youngs_modulus: $E").replace("-9.81", "'-$load'")

# What a child does instead of the points whose modulus it is told by: in a process of its own only.
TROUBLE = """\
import os, signal, sys, time
if sys.orig_argv[2:4] == ["-m", "dismech_cli.studies.sweep.child"] and "TROUBLE" in os.environ:
    import dismech_cli.session.start as door
    well = door.start
    def start(request, narrator):
        for what in os.environ["TROUBLE"].split(";"):
            text, _, kind = what.partition("=>")
            if text in request.overrides:
                if kind == "segfault":
                    import ctypes
                    print("about to read address 0", file=sys.stderr, flush=True)
                    ctypes.string_at(0)
                if kind == "killed":
                    os.kill(os.getpid(), signal.SIGKILL)
                if kind == "hang":
                    time.sleep(1e6)
                if kind == "noise":
                    os.write(1, b"a library that prints\\n")
                if kind == "bug":
                    raise KeyError("lost")
        time.sleep(float(os.environ.get("SLOWLY", "0")))
        return well(request, narrator)
    door.start = start
"""


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """A folder with ``arm.yaml``, whose modulus and load are parameters."""
    (tmp_path / "arm.yaml").write_text(PARAMETERS + SCENE)
    (tmp_path / "trouble").mkdir()
    (tmp_path / "trouble" / "sitecustomize.py").write_text(TROUBLE)
    return tmp_path


def rows_of(folder: Path) -> list[dict[str, str]]:
    """The table of a sweep, each row by the names of columns."""
    return list(csv.DictReader(io.StringIO((folder / "table.csv").read_text())))


def timeless(folder: Path) -> tuple[list[dict[str, str]], dict[str, Any]]:
    """Both tables without the columns of times."""
    rows = [{k: v for k, v in row.items() if k not in ("cpu [s]", "wall [s]")} for row in rows_of(folder)]
    with h5py.File(folder / "table.h5") as file:
        found = {
            name: (data[()].tobytes() if data.dtype.kind == "f" else list(data.asstr()), dict(data.attrs))
            for name, data in file.items()
            if name not in ("cpu", "wall")
        }
    return rows, found


def published(folder: Path) -> set[str]:
    """Names of the points that are there."""
    return {entry.name for entry in (folder / "points").glob("[0-9a-f]*")}


def left_over(folder: Path) -> set[str]:
    """What is hidden among them."""
    return {entry.name for entry in (folder / "points").glob(".*")}


def results_of(folder: Path) -> dict[str, dict[str, Any]]:
    """The result of each point by what it sets."""
    found = {}
    for name in published(folder):
        result = json.loads((folder / "points" / name / "result.json").read_text())
        found[", ".join(f"{one['key']}={one['text']}" for one in result["settings"])] = result
    return found
