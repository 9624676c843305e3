"""What `check` says that a run takes, against what scenes of the gallery took where an iteration took as
long.

The times are kept with `python -m benchmarks check_times`: no test measures any.
"""

from __future__ import annotations

import json
from typing import Any

import pytest

from benchmarks.check_times import KEPT
from dismech_cli.compose.price import Work
from dismech_cli.session.duration import seconds

# Below this nobody waits [s].
_SHORT = 0.05
# A cloth that closes around a stool and a snake in steps of 50 ms take two and five times as many iterations
# a step as others; a path around many turns takes all its steps; a rod that drops touches for a moment only.
_MISSED = {"draped_cloth", "snake_21", "localised_helix_static", "rod_drop_family"}


def measured() -> dict[str, dict[str, Any]]:
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    return {name: one for name, one in kept.items() if one["cpu"] and one["cpu"] > _SHORT}


@pytest.mark.parametrize(("name", "one"), measured().items(), ids=list(measured()))
def test_it_is_right_within_a_factor_of_three(name: str, one: dict[str, Any]) -> None:
    said = seconds(Work(**one["work"]), one["kernels"], one["iteration"], whole=one["whole"])
    close = one["cpu"] / 3.0 <= said <= 3.0 * one["cpu"]
    assert close != (name in _MISSED), f"{said:.3g} s for {one['cpu']:.3g} s"


def test_contact_and_longer_iterations_take_longer() -> None:
    work = Work(steps=100, iterations=2.0, edges=50, triangles=0, touching=False)
    touching = Work(steps=100, iterations=2.0, edges=50, triangles=0, touching=True)
    assert seconds(touching, "numba", 1e-3) > seconds(work, "numba", 1e-3)
    # assembly and factors, and most of that again for all else
    assert seconds(work, "numba", 1.0) == pytest.approx(100 * 2.0 * 1.85, rel=1e-3)
