"""The memory that ``check`` announces is what a run takes, within a factor of 1.5."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from benchmarks.memory import BAR, compared, shipped

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the peak of a process is read from /proc")
QUICK = ("cantilever_small", "curling_strip", "jellyfish")  # banded, PARDISO, Numba


def _check(scene: Path) -> None:
    parts, estimate, peak = compared(scene)
    assert peak / BAR < estimate < BAR * peak, (parts, estimate, peak)


@pytest.mark.parametrize("name", QUICK)
def test_memory_of_a_scene_of_each_kind(name: str) -> None:
    _check(next(scene for scene in shipped() if scene.stem == name))


@pytest.mark.slow
@pytest.mark.parametrize("scene", shipped(), ids=lambda scene: scene.stem)
def test_memory_of_every_shipped_scene(scene: Path) -> None:
    _check(scene)
