"""A run that makes energy out of nothing ends as a failure, not as a result."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

import dismech_cli
from dismech_cli.compose.compose import compose
from dismech_cli.model.state import State
from dismech_cli.run.loop import End, Limits, run
from dismech_cli.session.sinks import Memory
from dismech_cli.solve.integrators import ImplicitEuler
from dismech_cli.solve.stage import Stage

DECK = """
schema_version: 1
name: swing
dimension: 2
materials: {m: {youngs_modulus: 1 MPa, poisson_ratio: 0.5, density: 1000}}
geometry:
  - {type: rod, name: beam, material: m, radius: 2 mm,
     generate: {shape: line, from: [0, 0, 0], to: [0.1, 0, 0], nodes: 6}}
motions: [{type: clamp, where: beam.start}]
forces: [{type: gravity, acceleration: [0, 0, -9.81]}]
numerics: {integrator: {type: implicit_euler}, dt: 2 ms, t_end: 0.4 s}
output: {every: 2 ms}
"""


@dataclass(frozen=True, slots=True)
class Amplifying:
    """An unstable integrator: implicit Euler that ends every step too fast."""

    gain: float
    name: ClassVar[str] = "amplifying"
    order: ClassVar[int] = 1
    stages: ClassVar[int] = 1
    needs_acceleration: ClassVar[bool] = False
    damping: ClassVar[int] = 0

    def stage(self, index: int, start: State, latest: State, dt: float) -> Stage:
        stage = ImplicitEuler().stage(index, start, latest, dt)
        slope, constant = stage.v_end
        return replace(stage, v_end=(self.gain * slope, self.gain * constant))


ROD_AT_REST = Path(__file__).parents[1] / "data" / "rod_at_rest.yaml"
# Muscles pull against a drag that takes sixty times what they ever store.
MUSCLE = Path(__file__).parents[2] / "scenarios" / "stretching_muscle.yaml"


def outcome(folder: Path, gain: float) -> tuple[End, str]:
    deck = folder / "swing.yaml"
    deck.write_text(DECK)
    simulation = compose(dismech_cli.load(deck)).simulation
    result = run(replace(simulation, integrator=Amplifying(gain)), Memory())
    return result.end, result.message


def test_energy_from_nowhere_is_a_failure_that_says_so(tmp_path: Path) -> None:
    end, message = outcome(tmp_path, 1.6)
    assert end is End.FAILED
    assert "that nothing gave it" in message
    assert "generalized_alpha" in message


def test_a_sound_run_is_left_alone(tmp_path: Path) -> None:
    assert outcome(tmp_path, 1.0) == (End.DONE, "")


@pytest.mark.parametrize("integrator", ["generalized_alpha", "tr_bdf2", "newmark", "implicit_midpoint"])
def test_round_off_at_rest_is_no_energy(integrator: str) -> None:
    named = [f"numerics.integrator={{type: {integrator}}}"]
    result = run(compose(dismech_cli.load(ROD_AT_REST, overrides=named)).simulation, Memory())
    assert (result.end, result.doubts) == (End.DONE, ())


def test_what_drag_takes_is_known_to_a_share_of_it() -> None:
    coarse = ["numerics.integrator={type: implicit_euler}", "numerics.dt=160 ms", "numerics.t_end=1.6 s"]
    loaded = dismech_cli.load(MUSCLE, overrides=[*coarse, "expect={}"])
    result = run(compose(loaded).simulation, Memory())
    assert (result.end, result.doubts) == (End.DONE, ())


def test_growth_short_of_a_blow_up_is_a_doubt(tmp_path: Path) -> None:
    deck = tmp_path / "swing.yaml"
    drag = ", {type: viscous, coefficient: 0.02}"
    deck.write_text(DECK.replace("-9.81]}]", f"-9.81]}}{drag}]"))
    simulation = compose(dismech_cli.load(deck)).simulation
    result = run(replace(simulation, integrator=Amplifying(1.15)), Memory())
    assert result.end is End.DONE
    assert sum("came from nowhere" in doubt for doubt in result.doubts) == 1


@pytest.mark.parametrize("gain", [1e200, 1e300])
def test_a_frame_without_finite_energies_is_never_written(tmp_path: Path, gain: float) -> None:
    deck = tmp_path / "swing.yaml"
    deck.write_text(DECK)
    memory = Memory()
    simulation = compose(dismech_cli.load(deck)).simulation
    with np.errstate(all="ignore"):
        result = run(replace(simulation, integrator=Amplifying(gain)), memory)
    assert result.end is End.FAILED
    assert all(np.isfinite(list(frame.scalars.values())).all() for frame in memory.frames)
    assert "the kinetic energy is infinite or not a number at t = 0.002 s" in result.message
    assert "(rod 'beam', node " in result.message
    assert "fast" not in result.message
    assert memory.numbers == {}


def test_a_blow_up_leaves_no_checkpoint_to_go_on_from(tmp_path: Path) -> None:
    deck = tmp_path / "swing.yaml"
    deck.write_text(DECK)
    memory = Memory()
    simulation = compose(dismech_cli.load(deck)).simulation
    limits = Limits(checkpoint_every=0.0)
    result = run(replace(simulation, integrator=Amplifying(1.6)), memory, limits=limits)
    assert result.end is End.FAILED
    assert memory.numbers["state.t"] < result.state.t
    assert result.remedy == "numerics.integrator={type: tr_bdf2}"


def test_a_law_that_ends_in_the_middle_fails_the_run_and_keeps_its_frames(tmp_path: Path) -> None:
    deck = tmp_path / "swing.yaml"
    law = '{type: curvature_1, rod: beam, value: {expression: "sqrt(0.25 - t*s)"}}'
    deck.write_text(f"{DECK}actuation: [{law}]\n")
    memory = Memory()
    result = run(compose(dismech_cli.load(deck)).simulation, memory)
    assert result.end is End.FAILED
    assert "'sqrt(0.25 - t*s)' has no finite value at t = 0." in result.message
    assert memory.events[-1][0] == "failed"
    assert memory.frames[-1].t == memory.numbers["state.t"] == result.state.t
    assert 0.2 < result.state.t < 0.4
