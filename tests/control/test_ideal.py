"""Ideal feedback: a stiffer spring at another place, with its share in the account."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from control_decks import arm, composed, finished, ideal, positions
from numpy.testing import assert_allclose, assert_array_equal

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load_mapping


def without_control(value: Any, **keys: Any) -> dict[str, Any]:
    """The arm with a law in place of its controller."""
    deck = arm(**keys)
    deck["controllers"] = {}
    deck["output"] = {"every": 0.02, "probes": {"balance": {"energy": "error"}}}
    deck["actuation"][0]["value"] = value
    return deck


def test_no_gain_is_an_open_loop_bit_by_bit() -> None:
    """u = r with p = 0: the drive follows the target as it would a law."""
    law = {"sine": {"amplitude": 5.0, "frequency": 2.0}}
    loop = finished(load_mapping(ideal({"p": 0.0}, law)))
    open_loop = finished(load_mapping(without_control(law)))
    assert_array_equal(positions(loop), positions(open_loop))


def test_p_is_stiffness() -> None:
    """The step with feedback is that of a rod 1 + p times as stiff in bending, driven to r' = r."""
    p = 3.0
    section = {
        "type": "given",
        "axial_stiffness": 10.0,
        "bending_stiffness_1": 1e-4,
        "bending_stiffness_2": 1e-4,
        "torsional_stiffness": 1e-4,
        "mass_per_length": 0.1,
        "rotary_inertia_per_length": 1e-6,
        "radius": 5e-3,
    }

    def with_section(deck: dict[str, Any], factor: float) -> dict[str, Any]:
        del deck["geometry"][0]["radius"]
        stiff = {f"bending_stiffness_{k}": factor * 1e-4 for k in (1, 2)}
        deck["geometry"][0]["section"] = section | stiff
        deck["numerics"]["newton"] = {"tolerance": 1e-12}
        return deck

    loop = finished(load_mapping(with_section(ideal({"p": p}), 1.0)))
    stiff = finished(load_mapping(with_section(without_control(5.0), 1.0 + p)))
    assert_allclose(positions(loop), positions(stiff), atol=1e-12 * 0.1)


@pytest.mark.parametrize("gains", [{"p": 20.0}, {"p": 20.0, "i": 50.0}])
@pytest.mark.parametrize("integrator", ["implicit_midpoint", "tr_bdf2"])
def test_the_account_of_what_feedback_does(gains: dict[str, float], integrator: str) -> None:
    """Its error falls with the square of the time step; what passive springs store is what they store."""
    law = {"expression": "5*smoothstep(t/0.3)"}

    def worst(dt: float) -> float:
        deck = ideal(gains, law, numerics={"dt": dt, "integrator": {"type": integrator}})
        report = finished(load_mapping(deck))
        held = report.scalars["elastic"].max() + report.scalars["kinetic"].max()
        return float(np.abs(report.probes["balance"]).max() / held)

    coarse, fine = worst(0.01), worst(0.005)
    assert coarse < 0.02
    # second order: a quarter, and less than a third where higher orders still count
    assert fine < coarse / 3.0 or fine < 1e-6


WEIGHT = [
    {"type": "viscous", "coefficient": 10},
    {"type": "gravity", "acceleration": [0, 0, -9.81]},
]


def test_elastic_energy_is_that_of_the_passive_rod() -> None:
    """Bent by a moment M it stores M^2 / 2K, where a rod 1 + p times as stiff stores M^2 / 2K(1 + p)."""
    keys = {"numerics": {"t_end": 2.0, "dt": 0.02}, "forces": WEIGHT}
    soft, plain = ideal({"p": 4.0}, 0.0, **keys), without_control(0.0, **keys)
    soft["materials"]["m"]["youngs_modulus"] = 1e7
    plain["materials"]["m"]["youngs_modulus"] = 5e7
    hung = finished(load_mapping(soft))
    stiff = finished(load_mapping(plain))
    ratio = hung.scalars["elastic_bending"][-1] / stiff.scalars["elastic_bending"][-1]
    # but for the stretching, which is stiffer here and there is none to speak of
    assert ratio == pytest.approx(5.0, rel=2e-3)


def test_a_moment_is_what_the_joint_bears() -> None:
    """The field of moments knows that feedback makes joints stiffer: at the clamp it is the weight's."""
    deck = ideal({"p": 4.0}, 0.0, numerics={"t_end": 3.0, "dt": 0.02}, forces=WEIGHT)
    deck["materials"]["m"]["youngs_modulus"] = 1e7  # so stiff that the arm of the weight stays what it is
    deck["output"] = {"every": 3.0, "fields": ["bending_moment"]}
    report = finished(load_mapping(deck))
    weight = 1000 * np.pi * 5e-3**2 * 0.1 * 9.81
    assert report.frames[-1].fields["bending_moment"][0] == pytest.approx(weight * 0.05, rel=1e-3)


def test_an_ideal_loop_without_integral_remembers_nothing() -> None:
    simulation = composed(ideal({"p": 4.0})).simulation
    assert not simulation.start.inputs.size
    assert not simulation.start.memory


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"gains": {"p": 1.0, "d": 1.0}}, "unknown key"),
        ({"period": 0.01}, "unknown key"),
        ({"limits": {"rate": 1.0}}, "unknown key"),
        ({"gains": {"p": 1.0, "i": 1000.0}}, "cannot be stable at this dt"),
    ],
)
def test_what_ideal_feedback_cannot_have(change: dict[str, Any], told: str) -> None:
    deck = ideal({"p": 1.0})
    deck["controllers"]["bend"].update(change)
    with pytest.raises(ScenarioError, match=told):
        load_mapping(deck)


def test_another_drive_of_the_same_joints_is_refused() -> None:
    deck = ideal({"p": 1.0})
    deck["actuation"].append({"type": "curvature_1", "rod": "arm", "joints": [1, 1], "value": 1.0})
    with pytest.raises(
        ScenarioError, match=r"actuation\[0\].value: another actuation drives the same places"
    ):
        composed(deck)


def test_rubber_is_refused() -> None:
    deck = ideal({"p": 1.0})
    deck["materials"]["m"]["model"] = "neo_hookean"
    deck["actuation"][0]["type"] = "stretch"
    with pytest.raises(
        ScenarioError, match="no constant stiffness; ideal feedback stiffens springs one by one"
    ):
        composed(deck)
