"""What a scenario cannot mean by controllers and sensors: one message with its place."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from control_decks import arm, composed

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load_mapping
from dismech_cli.scenario.views.walk import leaves

PLANAR = {"strain": "curvature_1", "rod": "arm"}


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ({"bend": {"target": "5 deg"}}, "controllers.bend.target: expected a curvature such as '1 1/m'"),
        (
            {"bend": {"limits": {"rate": "3 1/s"}}},
            "controllers.bend.limits.rate: expected a rate of curvature such as '1 1/m/s'",
        ),
        (
            {"bend": {"target": {"ramp": {"from": 0, "to": "3 mm", "end": 1}}}},
            "controllers.bend.target.ramp.to: expected a curvature",
        ),
        ({"bend": {"gains": {}}}, "gains without p and i close no loop"),
        ({"bend": {"gains": {"p": -1}}}, "controllers.bend.gains.p: must be at least 0"),
        ({"bend": {"sensor": "nose"}}, "controllers.bend.sensor: no sensor is named 'nose'"),
        ({"bend": {"feedback": "perfect"}}, "expected 'sampled', 'ideal', got 'perfect'"),
        ({"bend": {"type": "pid"}}, "expected 'pi', 'incremental', 'plugin', got 'pid'"),
        (
            {"actuation": [{"type": "curvature_1", "rod": "arm", "value": {"controlled_by": "bent"}}]},
            "actuation\\[0\\].value.controlled_by: no controller is named 'bent'; did you mean 'bend'",
        ),
        (
            {"actuation": [{"type": "curvature_1", "rod": "arm", "value": 1}]},
            "controllers.bend: drives nothing",
        ),
        (
            {
                "actuation": [
                    {
                        "type": "curvature_1",
                        "rod": "arm",
                        "joints": [k, k],
                        "value": {"controlled_by": "bend"},
                    }
                    for k in (0, 1)
                ]
            },
            "'bend' drives actuation\\[0\\] already",
        ),
        ({"sensors": {"s": {"strain": "curvature_1", "rod": "leg"}}}, "sensors.s.rod: no rod is named 'leg'"),
        ({"sensors": {"s": {**PLANAR, "noise": "1 deg"}}}, "sensors.s.noise: expected a curvature"),
        (
            {"sensors": {"s": {"strain": "twist", "rod": "arm"}}},
            "sensors.s.strain: a planar scene has no twist",
        ),
        (
            {"sensors": {"s": {"probe": {"energy": "total"}}}},
            "sensors.s.probe: a sensor reads where things are",
        ),
        ({"sensors": {"s": {"rod": "arm"}}}, "sensors.s: expected one of strain, probe"),
        (
            {"sensors": {"s": {**PLANAR, "joints": [1, 2]}}, "bend": {"sensor": "s"}},
            "controllers.bend.sensor: 's' reads other places or another strain",
        ),
        (
            {"sensors": {"s": {"strain": "stretch", "rod": "arm"}}, "bend": {"sensor": "s"}},
            "controllers.bend.sensor: 's' reads other places or another strain",
        ),
        (
            {"sensors": {"s": {"probe": {"twist": "arm.end"}}}, "bend": {"sensor": "s"}},
            "'s' reads a probe, not the strain",
        ),
        (
            {"sensors": {"s": {**PLANAR, "delay": 0.03}}, "bend": {"sensor": "s"}},
            "sensors.s.delay: 0.03 s is no multiple of the period of 0.02 s of 'bend'",
        ),
        (
            {"sensors": {"s": {**PLANAR, "joints": [0, 9]}}},
            "sensors.s.joints: rod 'arm' has 4, counted from 0",
        ),
        (
            {"sensors": {"s": {"strain": "curvature_2", "rod": "arm"}}},
            "sensors.s: curvature_2 lies out of the plane of the scene",
        ),
        (
            {"output": {"probes": {"x": {"controller": "bent", "measure": "error"}}}},
            "output.probes.x.controller: no controller is named 'bent'",
        ),
        (
            {"bend": {"period": 1e-9}, "numerics": {"t_end": 2.0, "dt": 0.02}},
            "controllers.bend.period: 2e\\+09 samples to the end of the run at 2 s; at most 1e\\+06",
        ),
        ({"output": {"probes": {"x": {"sensor": "s"}}}}, "output.probes.x.sensor: no sensor is named 's'"),
        (
            {"output": {"probes": {"x": {"shape": "leg", "target": {"file": "a.csv"}}}}},
            "output.probes.x.shape: no body is named 'leg'",
        ),
        (
            {"numerics": {"integrator": {"type": "static"}, "dt": None, "t_end": None}},
            "controllers.bend: a static run has no time to control in",
        ),
    ],
)
def test_a_message_says_where_and_what(keys: dict[str, Any], told: str) -> None:
    with pytest.raises(ScenarioError, match=told):
        composed(arm(**keys))


@pytest.mark.parametrize(
    ("text", "target", "told"),
    [
        ("x,y,z\n0,0,0\n1,0,0\n", {"shape": {"file": "f.csv"}}, "has 2 rows for the 6 nodes of 'arm'"),
        (
            "x,y,z\n" + "0,0,0\n" * 6,
            {"shape": {"file": "f.csv"}},
            "controllers.bend.target.shape: has no finite strain",
        ),
        (
            "x,y,z\n" + "".join(f"{k},{k % 2},0\n" for k in range(6)),
            {"shape": {"file": "f.csv"}},
            "leaves the plane xz",
        ),
        ("t,a,b\n0,1,2\n", {"each": {"file": "f.csv"}}, "has no column 3: there are 3"),
        ("t,a,b,c,d\n0,1,2,3,4\n0,1,2,3,4\n", {"each": {"file": "f.csv"}}, "its times must increase"),
        ("", {"run": "."}, "controllers.bend.target.run: "),
    ],
)
def test_a_target_that_does_not_fit(tmp_path: Path, text: str, target: dict[str, Any], told: str) -> None:
    (tmp_path / "f.csv").write_text(text or "x\n")
    with pytest.raises(ScenarioError, match=told):
        composed(arm(bend={"target": target}), tmp_path)


def test_another_controller_names_its_own_unit() -> None:
    """The quantity of a target is that of what the controller drives."""
    deck = arm()
    deck["actuation"] = [{"type": "stretch", "rod": "arm", "value": {"controlled_by": "bend"}}]
    deck["controllers"]["bend"]["target"] = "3 %"
    (loop,) = composed(deck).simulation.controls.loops
    assert loop.target(0.0)[0] == 0.03  # type: ignore[attr-defined]
    deck["controllers"]["bend"]["target"] = "3 1/m"
    with pytest.raises(ScenarioError, match="expected a plain number"):
        composed(deck)


def test_a_period_shorter_than_dt_is_told() -> None:
    loaded = load_mapping(arm(bend={"period": 0.001}))
    (told,) = [warning for warning in loaded.warnings if "period" in warning]
    assert (
        "controllers.bend.period: shorter than dt: steps end at samples, every 0.001 s and not 0.01 s" in told
    )


def test_units_are_those_of_what_is_driven() -> None:
    """In the table of all values: a rate of curvature, and the curvature that a law gives."""
    keys = {"target": {"ramp": {"from": 0, "to": 5, "end": 1}}, "limits": {"rate": 3, "magnitude": 4}}
    units = {leaf.path: leaf.unit for leaf in leaves(load_mapping(arm(bend=keys)).scenario)}
    own = ("controllers", "bend")
    assert units[(*own, "limits", "rate")] == "1/m/s"
    assert units[(*own, "limits", "magnitude")] == "1/m"
    assert units[(*own, "target", "ramp", "to")] == "1/m"
    assert units[(*own, "target", "ramp", "end")] == "s"


def test_two_controllers_of_one_place_are_refused() -> None:
    deck = arm()
    deck["actuation"] = [
        {"type": "curvature_1", "rod": "arm", "joints": joints, "value": {"controlled_by": name}}
        for name, joints in (("bend", [0, 2]), ("too", [2, 3]))
    ]
    deck["controllers"]["too"] = deck["controllers"]["bend"]
    with pytest.raises(ScenarioError, match="'too' and 'bend' command the same strain at the same places"):
        composed(deck)
    deck["actuation"][1]["joints"] = [3, 3]
    composed(deck)
