"""Kept code is read without what only compiling needs, which follows where something is to compile."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

pytest.importorskip("numba")

# Calls some loops of a kernel and says which part of Numba that cost.
PROGRAM = """
import sys
import numpy as np
from dismech_cli.energies.stretch import STRETCH
from dismech_cli.kernels.loop_module import LoopModule
from dismech_cli.kernels.loop_text import stencil_text

made = LoopModule(stencil_text(STRETCH))
q, p = np.array([0.0, 0.0, 0.0, 1.1, 0.0, 0.0]), np.array([[1.0], [2.0], [0.0]])
dofs, places = np.arange(6)[None], np.zeros((1, 1), dtype=np.int64)
out, r = np.zeros((1, 1)), np.zeros(6)
for loop, into in (("energies", out), ("residual", r)):
    if loop in sys.argv[1:]:
        made.run(loop, q, np.empty((0, 1)), p, dofs, places, into)
print(*out.ravel(), *r, "numba.np.polynomial.polynomial_core" in sys.modules)
"""


def called(tmp_path, *loops: str) -> list[str]:
    environment = {**os.environ, "DISMECH_CACHE": str(tmp_path)}
    command = [sys.executable, "-c", PROGRAM, *loops]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_only_what_compiles_makes_ready_to_compile(tmp_path):
    *cold, ready = called(tmp_path, "energies")
    assert ready == "True"
    *warm, ready = called(tmp_path, "energies")
    assert ready == "False"
    assert warm == cold
    # the same process reads one and compiles the other
    energy, *forces, ready = called(tmp_path, "energies", "residual")
    assert ready == "True"
    assert energy == cold[0]
    *_, ready = called(tmp_path, "energies", "residual")
    assert ready == "False"
    assert called(tmp_path, "energies", "residual")[:-1] == [energy, *forces]
    assert any(float(force) for force in forces)
