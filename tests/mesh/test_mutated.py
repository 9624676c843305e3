"""Whatever a mesh file holds, a scene that takes it is composed or refused with a place, soon and small."""

from __future__ import annotations

from pathlib import Path

import pytest
from mesh_mutations import FILES
from mutation_run import take_mesh, taken


def _check(seeds: range, folder: Path) -> int:
    """Number of meshes that are refused."""
    found = [taken(take_mesh, seed, folder) for seed in seeds]
    assert [one.fault for one in found if one.fault] == []
    return sum(bool(one.refused) for one in found)


def test_the_unharmed_files_are_of_every_format() -> None:
    assert {suffix for suffix, _ in FILES} == {".msh", ".obj", ".txt", ".stl", ".csv"}


def test_mutated_meshes_are_taken_or_refused_with_a_place(tmp_path: Path) -> None:
    assert 50 < _check(range(150), tmp_path) < 150


@pytest.mark.slow
def test_many_mutated_meshes_are_taken_or_refused_with_a_place(tmp_path: Path) -> None:
    assert 3000 < _check(range(5000), tmp_path) < 5000
