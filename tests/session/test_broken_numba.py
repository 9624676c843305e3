"""A Numba that is there and broken, and caches without a place: runs take NumPy, or keep nothing."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from cli_process import environment, swing

__all__ = ["swing"]

LONG = ("--set", "numerics.kernels=auto", "--set", "numerics.t_end=1e4 s", "--until", "0.01 s", "--no-render")
FAULTS = {
    "another NumPy": "raise ImportError('Numba needs NumPy 1.26 or less. Got NumPy 2.4.')",
    "no LLVM": "raise OSError('Could not find/load shared object file')",
    "half an update": "from . import _nothing_there",
    "a wrong build": "raise SystemError('initialization of _internal failed')",
}


def _broken(folder: Path, text: str) -> str:
    """A folder to put before all others, whose Numba does not work."""
    package = folder / "site" / "numba"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text(text)
    return str(package.parent)


def _called(folder: Path, *arguments: str, **more: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "dismech_cli", *arguments]
    env = environment() | more
    return subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, timeout=100)


@pytest.mark.parametrize("fault", FAULTS)
def test_a_broken_numba_falls_back_to_numpy_with_a_warning(swing: Path, fault: str) -> None:
    first = os.pathsep.join((_broken(swing, FAULTS[fault]), environment()["PYTHONPATH"]))
    done = _called(swing, "run", "swing.yaml", *LONG, "-o", "out", PYTHONPATH=first)
    assert done.returncode == 0, done.stderr
    assert "warning: the run is slower without compiled kernels: numba is broken (" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_broken_numba_that_is_asked_for_is_refused(swing: Path) -> None:
    pytest.importorskip("numba")
    assert _called(swing, "run", "swing.yaml", *LONG, "-o", "out").returncode == 0
    first = os.pathsep.join((_broken(swing, FAULTS["no LLVM"]), environment()["PYTHONPATH"]))
    asked = _called(swing, "run", "swing.yaml", "--set", "numerics.kernels=numba", PYTHONPATH=first)
    assert asked.returncode == 2
    assert "numerics.kernels: numba is broken (OSError: Could not find" in asked.stderr
    resumed = _called(swing, "resume", "out", "--until", "0.02 s", PYTHONPATH=first)
    assert resumed.returncode == 2
    assert "out was run with numba, which is broken" in resumed.stderr
    assert "numba is broken" in _called(swing, "doctor", PYTHONPATH=first).stdout


def test_no_place_for_compiled_kernels_is_a_warning(swing: Path) -> None:
    pytest.importorskip("numba")
    (swing / "file").write_text("")
    nowhere = dict.fromkeys(("DISMECH_CACHE", "TMPDIR"), str(swing / "file"))
    done = _called(swing, "run", "swing.yaml", *LONG, "-o", "out", PYTHONWARNINGS="default", **nowhere)
    assert done.returncode == 0, done.stderr
    lines = done.stderr.splitlines()
    assert any(line.startswith("warning: compiled kernels are not kept") for line in lines), done.stderr
    assert "UserWarning" not in done.stderr
    assert "Traceback" not in done.stderr
