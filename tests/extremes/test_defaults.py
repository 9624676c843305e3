"""Ordinary scenes that name no integrator finish, at their step and at coarser ones."""

from __future__ import annotations

from pathlib import Path

import pytest

from dismech_cli import simulate

CASES = Path(__file__).parents[1] / "data" / "cases"


@pytest.mark.parametrize(
    ("scene", "overrides", "profile"),
    [
        ("readme_arm", (), None),
        ("readme_arm", (), "draft"),
        ("soft_cantilever", (), None),
        ("soft_cantilever", ("numerics.dt=20 ms",), None),
        ("soft_cantilever", ("numerics.dt=40 ms",), None),
    ],
)
def test_it_finishes_without_energy_from_nowhere(
    scene: str, overrides: tuple[str, ...], profile: str | None
) -> None:
    report = simulate(CASES / f"{scene}.yaml", overrides=overrides, profile=profile).raise_for_status()
    assert report.outcome.doubts == ()
