"""What of contact is refused or doubted, with its place and what would be right."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from contact_decks import crossing, on_floor

import dismech_cli
from dismech_cli.compose.compose import compose
from dismech_cli.errors import ScenarioError

Change = Callable[[dict[str, Any]], None]


def set_(path: str, value: Any) -> Change:
    def change(deck: dict[str, Any]) -> None:
        *above, last = [int(part) if part.isdigit() else part for part in path.split(".")]
        for part in above:
            deck = deck[part]
        deck[last] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            set_("contact.pairs.0.between", ["rod", "flor"]),
            "no body and no obstacle is named 'flor'.*'floor'",
        ),
        (set_("contact.pairs.0.between", ["floor", "floor"]), "two obstacles never touch"),
        (set_("contact.pairs", [{"between": ["rod", "rod"]}]), "no pair of `contact.pairs` names it"),
        (set_("contact.pairs", 2 * [{"between": ["rod", "floor"]}]), "given twice"),
        (set_("contact.law", {"stiffness": 1e4, "tolerance": 0.1}), "not both"),
        (set_("contact.friction", None), None),
        (set_("contact", None), "nothing touches them: the scene has no `contact`"),
        (set_("obstacles.0.name", "rod"), "taken by another"),
        (set_("obstacles.0.normal", [0, 1, 0]), "out of plane xz: nothing can touch it"),
        (set_("numerics", {"integrator": {"type": "static"}}), "nothing slips in a static run"),
        (
            set_("output.probes", {"p": {"contact": ["rod", "rod"], "measure": "load"}}),
            "contact has no pair of 'rod' and 'rod'",
        ),
        (
            set_("obstacles.0", {"name": "floor", "type": "box", "center": [0, 0, 0], "size": [1, 1, 0]}),
            "greater than 0",
        ),
    ],
)
def test_refused(change: Change, message: str | None) -> None:
    deck = on_floor()
    change(deck)
    if message is None:
        dismech_cli.load_mapping(deck)
        return
    with pytest.raises(ScenarioError, match=message):
        dismech_cli.simulate(deck, limits=dismech_cli.Limits(until=0.0))


def warnings(deck: dict[str, Any]) -> str:
    deck["numerics"]["t_end"] = deck["numerics"]["dt"]
    deck["output"].pop("every")
    return " ".join(dismech_cli.simulate(deck).warnings)


@pytest.mark.parametrize(
    ("integrator", "message"),
    [
        ({"type": "implicit_midpoint"}, "makes energy in impacts"),
        ({"type": "newmark"}, "makes energy in impacts"),
        ({"type": "generalized_alpha"}, "spectral_radius 0.8 lets frames lie within others"),
        ({"type": "generalized_alpha", "spectral_radius": 0.0}, ""),
        ({"type": "implicit_euler"}, ""),
        ({"type": "tr_bdf2"}, ""),
    ],
)
def test_integrators_that_break_what_contact_promises(integrator: dict[str, Any], message: str) -> None:
    deck = on_floor()
    deck["numerics"]["integrator"] = integrator
    found = warnings(deck)
    assert message in found if message else not found


def test_the_default_integrator() -> None:
    scenario = dismech_cli.load_mapping(on_floor()).scenario
    assert scenario.numerics.integrator.type == "generalized_alpha"
    assert scenario.numerics.integrator.spectral_radius == 0.0


def test_a_start_within_something_is_told_with_the_pair() -> None:
    deck = on_floor()
    for key in ("from", "to"):
        deck["geometry"][0]["generate"][key][2] = 0.005
    assert "'rod' starts 0.02 m within 'floor', 40% of its thickness" in warnings(deck)
    deck = crossing(1e-3, 1.0)
    for key in ("from", "to"):
        deck["geometry"][1]["generate"][key][2] = 0.002
    assert "'low' starts within 'high' by 50% of their thickness" in warnings(deck)


@pytest.mark.parametrize(
    ("change", "told"), [({}, True), ({"coefficient": 0.0}, False), ({"plane": 2}, False)]
)
def test_that_friction_rolls_nothing_is_told(change: dict[str, float], told: bool) -> None:
    deck = on_floor()
    deck["dimension"] = change.get("plane", 3)
    deck["contact"]["friction"] |= {key: value for key, value in change.items() if key != "plane"}
    decisions = compose(dismech_cli.load_mapping(deck)).plan.decisions
    assert any("axes of rods" in decision.what for decision in decisions) == told
