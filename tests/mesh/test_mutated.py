"""Whatever a mesh file holds, a scene that takes it is composed or refused with a place, soon and small."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from mesh_mutations import FILES, mutated_mesh
from time_limit import within

from dismech_cli.compose import sizes
from dismech_cli.compose.compose import compose
from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load_text
from dismech_cli.session.inspect import estimate

PLACE = re.compile(r":\d+:\d+: ")
LIMIT = 5.0  # [s] of processor time


def _check(seeds: range, folder: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    """Number of meshes that are refused."""
    monkeypatch.setattr(sizes, "machine_memory", lambda: 5e8)
    refused = 0
    for seed in seeds:
        name, data, deck = mutated_mesh(seed)
        (folder / name).write_bytes(data)
        with within(LIMIT), np.errstate(all="ignore"):
            message = _fault(deck, folder)
        assert not message or PLACE.search(message.splitlines()[0]), (seed, message)
        refused += bool(message)
    return refused


def _fault(deck: str, folder: Path) -> str:
    try:
        loaded = load_text(deck, directory=folder)
        estimate(compose(loaded, kernels="numpy"), loaded.scenario.numerics)
    except ScenarioError as error:
        return str(error)
    return ""


def test_the_unharmed_files_are_of_every_format() -> None:
    assert {suffix for suffix, _ in FILES} == {".msh", ".obj", ".txt", ".stl", ".csv"}


def test_mutated_meshes_are_taken_or_refused_with_a_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert 50 < _check(range(150), tmp_path, monkeypatch) < 150


@pytest.mark.slow
def test_many_mutated_meshes_are_taken_or_refused_with_a_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert 3000 < _check(range(5000), tmp_path, monkeypatch) < 5000
