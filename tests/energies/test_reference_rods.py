"""Forces, tangents, frames and equilibria against numbers that MAT-DiSMech computed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from cases import (
    NUMPY,
    clamped,
    configuration,
    energy_of,
    framed_rod,
    massless,
    only_bending,
    planar_rod,
    straight,
    weighted,
)
from derivatives import Probe
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray
from dismech_cli.energies.stretch import STRETCH
from dismech_cli.kinematics.dofs import DofMap
from dismech_cli.kinematics.rod_frames import FrameState, NoFrames, TrialFrames
from dismech_cli.laws.laws import Ramp
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy
from dismech_cli.sections.rods import rectangular_section, rod_properties
from dismech_cli.solve.integrators import Static
from dismech_cli.solve.problem import NewtonSettings
from dismech_cli.solve.status import Status
from dismech_cli.solve.step import Stepper

DATA = Path(__file__).parents[1] / "data"
STRIP = rod_properties(
    rectangular_section(width=0.02, thickness=0.001, torsion=0.02 * 1e-9 / 6.0),
    youngs_modulus=2e6,
    poisson_ratio=0.5,
    density=1200.0,
)


def reference(name: str) -> dict[str, FloatArray]:
    with np.load(DATA / f"reference_{name}.npz") as data:
        return dict(data)


def cantilever() -> Model:
    return framed_rod(*straight(51), STRIP)


def assert_same(term: StencilEnergy, model: Model, c: Configuration, data: dict[str, FloatArray]) -> None:
    """Force and tangent to 1e-8 of the largest entry, and no entry where the reference has none."""
    probe = Probe.of(term, model, NUMPY)
    n = len(data["q"])
    tangent = np.zeros((n, n))
    tangent[data["row"], data["column"]] = data["entry"]
    size = np.abs(tangent).max()
    assert_allclose(probe.tangents(c)[0], -tangent, rtol=0, atol=1e-8 * size)
    # Where strains are 1e-10, a force holds only the digits that positions leave: |K| |x| eps.
    round_off = 4.0 * np.finfo(float).eps * size * np.abs(data["q"]).max()
    atol = max(1e-8 * np.abs(data["force"]).max(), round_off)
    assert_allclose(probe.residual(c), -data["force"], rtol=0, atol=atol)


def test_stretch_of_the_cantilever() -> None:
    data, model = reference("rod_stretch"), cantilever()
    c = configuration(model, data["q"], np.zeros_like(data["q"]), model.frames.rest(model.rest))
    assert_same(energy_of(model, "stretch"), model, c, data)


@pytest.mark.parametrize("state", ["q", "q0"])
def test_bending_of_the_cantilever(state: str) -> None:
    """The reference's own directors, bent state."""
    data, model = reference(f"rod_bend_{state}"), cantilever()
    auxiliary = np.zeros(model.frames.size)
    auxiliary[model.frames.director_places(np.arange(50))] = np.hstack((data["m1"], data["m2"]))
    nothing = FrameState(np.empty((3, 0)), np.empty((3, 0)), np.empty(0))
    c = Configuration(0.0, data["q"], np.zeros_like(data["q"]), TrialFrames(nothing, auxiliary))
    assert np.abs(data["force"]).max() > 0.01
    assert_same(only_bending(energy_of(model, "bend_twist")), model, c, data)


def test_stretch_of_the_parachute() -> None:
    """408 springs of rods and shell in one network."""
    data = reference("parachute_stretch")
    springs = data["springs"].astype(np.int64)
    nodes = data["nodes"]
    count, rods = len(springs), int(data["rods"])
    dofs = DofMap(len(nodes), len(data["q"]) - 3 * len(nodes), (0, 1, 2), len(nodes))
    lengths = np.linalg.norm(nodes[springs[:, 1]] - nodes[springs[:, 0]], axis=1)
    stiffness = 0.5 * np.sqrt(3.0) * 1e9 * 1e-3 * lengths
    stiffness[:rods] = np.pi * 1e-6 * 1e7
    term = StencilEnergy.of(
        "stretch",
        STRETCH,
        dofs.of_nodes(springs).reshape(count, 6),
        {"eps": 0.0, "EA": stiffness, "length": lengths},
    )
    model = Model(dofs, data["q"], np.zeros(dofs.n), (term,), (), NoFrames(), NUMPY, 1.0)
    c = configuration(model, data["q"], np.zeros(dofs.n), model.frames.rest(data["q"]))
    assert_same(term, model, c, data)


def test_properties_of_the_cantilever() -> None:
    data, model = reference("rod_frames"), cantilever()
    ours = [STRIP.axial, STRIP.bending_1, STRIP.bending_2, STRIP.torsional]
    assert_allclose(ours, [data[key] for key in ("EA", "EI1", "EI2", "GJ")], rtol=1e-14)
    assert_allclose(model.rest[:153], data["nodes"].reshape(-1), atol=1e-17)
    # The reference's angle inertia is an older formula; positions agree.
    assert_allclose(model.mass[:153], data["mass"][:153], rtol=1e-12)


def test_rest_frames_of_the_cantilever() -> None:
    data, model = reference("rod_frames"), cantilever()
    stored = model.frames.rest(model.rest)
    assert_allclose(stored.director.T, data["a1"], atol=1e-15)
    assert_allclose(np.cross(stored.tangent.T, stored.director.T), data["a2"], atol=1e-15)


def test_transport_in_time() -> None:
    """From the stored state to one 18 mm away: a1 and a2 to round-off."""
    data, model = reference("rod_frames"), cantilever()
    e = np.diff(data["q0"][:153].reshape(51, 3), axis=0)
    tangent = (e / np.linalg.norm(e, axis=1)[:, None]).T
    stored = FrameState(tangent, data["time_a1"].T, np.zeros(49))
    trial = model.frames.transport(stored, data["q"]).state
    assert np.abs(data["q"] - data["q0"]).max() > 0.01
    assert_allclose(trial.director.T, data["time_a1_new"], atol=1e-14)
    a2 = np.cross(trial.tangent.T, trial.director.T)
    assert_allclose(a2, data["time_a2_new"], atol=1e-14)


# Tips (x, z) at loads 1, 5 and 10 of 10, converged to round-off by an independent implementation.
GOLDEN = {0: (0.08478431, -0.04692273), 4: (0.04281951, -0.07839833), 9: (0.03051760, -0.08285162)}


@pytest.mark.parametrize("build", [planar_rod, framed_rod])
def test_static_cantilever_under_gravity(build: object) -> None:
    model = build(*straight(51), STRIP)
    model = weighted(model, (0.0, 0.0, -9.81), Ramp(before=0.0, after=1.0, start=0.0, end=1.0))
    model = massless(clamped(model, tuple(range(6)), tuple(range(5))))
    stepper = Stepper(model, Static(), NewtonSettings(tolerance=1e-11), "auto")
    state = stepper.prepare(stepper.rest_state())
    theirs = reference("rod_static")["qs"][:, :153].reshape(10, 51, 3)[:, :, [0, 2]]
    for load in range(10):
        result = stepper.step(state, 0.1)
        assert result.status is Status.CONVERGED
        state = result.state
        x = model.dofs.embed(model.dofs.positions(state.q))[:, [0, 2]]
        if load in GOLDEN:
            # half a unit of the last digit given
            assert_allclose(x[-1], GOLDEN[load], rtol=0, atol=5.1e-9)
        displacement = np.abs(x - model.dofs.embed(model.dofs.positions(model.rest))[:, [0, 2]]).max()
        assert_allclose(x, theirs[load], rtol=0, atol=4.3e-3 * displacement)
