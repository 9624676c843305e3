"""Shipped scenes with the steps of whoever names none: they finish, and miss what only one step keeps."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.defaults import scenes
from dismech_cli import load, simulate
from dismech_cli.run.loop import End
from dismech_cli.scenario.language.numerics import Static

# What a scene promises of its own step, by expectation: other steps, fixed ones too, miss it.
OWN_STEP = {
    # compared with other codes at their steps
    "snake_21": {"head"},
    "hemisphere_hang": {"rim_radius", "rim_height"},
    "rod_drop_family": {"free", "deepest", "slid", "back"},
    # implicit Euler has to damp all but the first mode
    "boundary_motion": {"period"},
    # a loop that is tuned for it
    "s_shape_ideal": {"shape", "soon"},
    # the midpoint rule keeps energy, with steps that are equal
    "thrown_sheet": {"kept"},
    # implicit Euler at 2 ms takes a bounce out of an impact that shorter steps see go on
    "rod_on_sheet": {"carried", "pressed", "at_rest"},
    # what is not symmetric grows in every beat
    "jellyfish_tentacles": {"drift_x_2", "drift_y_2"},
}
# CPU time of more than 10 s.
DEAR = {
    "cantilever_dynamic_1e5",
    "draped_cloth",
    "folded_cloth",
    "dlo_manipulation",
    "manta_ray",
    "pushed_bowl",
}


def _moving() -> list[Path]:
    return [
        path
        for path in scenes()
        if path.stem not in DEAR and not isinstance(load(path).scenario.numerics.integrator, Static)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("path", _moving(), ids=lambda path: path.stem)
def test_a_scene_without_dt_keeps_its_promises(path: Path) -> None:
    loaded = load(path, overrides=["numerics.dt=null", "numerics.step={adaptive: true}"])
    report = simulate(loaded)
    assert report.outcome.end is End.DONE, report.outcome.message
    missed = {one.name for one in report.verdicts if not one.passed}
    assert missed <= OWN_STEP.get(path.stem, set())
