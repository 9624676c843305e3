"""Runs that leave what their models mean say so, once, with place and time; others do not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from decks import given_section, line, rod_deck
from numpy.testing import assert_allclose
from shell_decks import Deck, made, ran, shell_deck, write

from dismech_cli.model.saved import restore_all, save_all
from dismech_cli.run.observables.limits import Fold, LostArea, MembraneStrain, turns
from dismech_cli.run.validity import Check, Validity

__all__ = ["made", "ran", "write"]

FLAT: Deck = {
    "shape": "sheet", "origin": [0.0, 0.0, 0.0], "length": 0.1, "width": 0.05, "divisions": 4,
    "pattern": "right",
}  # fmt: skip
LINEAR: Deck = {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000.0}
RUBBER = LINEAR | {"model": "neo_hookean"}


def ramp(to: float) -> Deck:
    return {"ramp": {"from": 0.0, "to": to, "end": 1.0}}


def pulled_sheet(material: Deck, by: float) -> Deck:
    """A sheet pulled along x in its plane, free to narrow."""
    pin: Deck = {"type": "pin", "where": "sheet.right", "components": ["x"]}
    return shell_deck(
        FLAT,
        materials={"rubber": material},
        motions=[
            {"type": "pin", "where": "sheet", "components": ["z"]},
            {"type": "pin", "where": "sheet.left", "components": ["x"]},
            {"type": "pin", "where": "sheet.bottom", "components": ["y"]},
            pin | {"displacement": [ramp(by * 0.1), 0.0, 0.0]},
        ],
        numerics={"integrator": {"type": "static", "load_steps": 5}},
        output={"every": 0.2},
    )


def pulled_rod(by: float, **keys: Any) -> Deck:
    motions: list[Deck] = [
        {"type": "pin", "where": "rod.start"},
        {"type": "pin", "where": "rod.end", "displacement": [ramp(by), 0.0, 0.0]},
    ]
    return rod_deck(line(5), given_section(axial=1.0), motions=motions, **keys)


def test_a_membrane_out_of_its_strains(ran: Any) -> None:
    (told,) = ran(pulled_sheet(LINEAR, 0.45)).outcome.doubts
    assert told.startswith("a membrane is strained by 45% at t = 1 near shell 'sheet', node ")
    assert "too far since t = 0.6:" in told
    assert "neo_hookean" in told


@pytest.mark.parametrize(("material", "by"), [(LINEAR, 0.19), (RUBBER, 1.5)])
def test_a_membrane_within_its_strains(ran: Any, material: Deck, by: float) -> None:
    assert ran(pulled_sheet(material, by)).outcome.doubts == ()


def test_a_rod_out_of_its_strains(ran: Any) -> None:
    (told,) = ran(pulled_rod(0.4)).outcome.doubts
    assert told.startswith("a rod is strained by 40% at t = 1 near rod 'rod', node ")
    assert ran(pulled_rod(0.15)).outcome.doubts == ()


def test_strain_counts_from_the_natural_length(ran: Any) -> None:
    driven = [{"type": "stretch", "rod": "rod", "value": ramp(0.4)}]
    assert ran(pulled_rod(0.4, actuation=driven)).outcome.doubts == ()
    (told,) = ran(pulled_rod(0.0, actuation=driven)).outcome.doubts
    assert "strained by 29%" in told


@pytest.mark.parametrize("natural", [-0.5, -0.99, -1.2])
def test_strain_of_a_rod_that_is_told_to_be_nothing(ran: Any, natural: float) -> None:
    """Held at its length: of the natural length it would be strained by 100 % to infinity, and back."""
    driven = [{"type": "stretch", "rod": "rod", "value": ramp(natural)}]
    (told,) = ran(pulled_rod(0.0, actuation=driven)).outcome.doubts
    assert f"strained by {-natural:.0%}" in told


@pytest.mark.parametrize(("turn", "count"), [(2.0, 2), (1.0, 0)])
def test_a_joint_that_turns_too_far(ran: Any, turn: float, count: int) -> None:
    """Curvature is driven: 2 tan(turn / 2) over half the length. The stout rod bends tighter than itself."""
    section = given_section() | {"radius": 0.2 if count else 0.01}
    value = ramp(2.0 * np.tan(0.5 * turn) / 0.5)
    driven = [{"type": "curvature_1", "rod": "rod", "value": value}]
    held = [{"type": "clamp", "where": "rod.start", "at": "edge"}]
    doubts = ran(rod_deck(line(3), section, actuation=driven, motions=held)).outcome.doubts
    assert len(doubts) == count
    if count:
        assert "a rod turns by 115 deg at one node at t = 1" in doubts[0]
        assert "of its own radius" in doubts[1]


def test_corners_at_rest_are_no_turns(ran: Any) -> None:
    """A rod with a corner of 135 degrees, pulled a little."""
    corner = {"shape": "polyline", "points": [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 0.0, 0.7]]}
    deck = rod_deck(corner, forces=[{"type": "point", "where": "rod.end", "force": [0.01, 0.0, 0.0]}])
    assert ran(deck).outcome.doubts == ()


class Shown:
    """What the measures look at."""

    def __init__(self, positions: Any) -> None:
        self.positions = np.asarray(positions, dtype=np.float64)


def test_measures() -> None:
    x = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    metric = np.array([[1.0], [1.0], [0.0]])
    strain = MembraneStrain(np.array([[0, 1, 2]]), metric)
    for plane, expected in (
        (np.diag([1.5, 0.9, 1.0]), 0.5),
        (np.diag([1.1, 0.4, 1.0]), 0.6),
        (np.diag([1.0, 0.0, 1.0]), 1.0),
    ):
        assert_allclose(strain(Shown(x @ plane)), expected, rtol=1e-12)  # type: ignore[arg-type]
    bent = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 0], [1, 1, 0]])
    triples = np.array([[0, 1, 2], [2, 3, 4]])
    assert_allclose(turns(bent, triples), [np.pi / 2, np.pi], rtol=1e-15)


@pytest.mark.parametrize("share", [-1e-6, 0.0, 1e-12, 1e-6])
@pytest.mark.parametrize("limit", ["turn", "bend", "strain"])
def test_bounds_are_sure_of_what_is_within_and_of_nothing_else(made: Any, limit: str, share: float) -> None:
    """A rod is bent at one node, or pulled, to within a share of its limit, or beyond."""
    section = given_section() | {"radius": 0.01 if limit == "turn" else 0.2}
    pinned = [{"type": "pin", "where": "rod.start"}, {"type": "pin", "where": "rod.end"}]
    strain, turned, bent = made(rod_deck(line(5), section, motions=pinned)).simulation.checks
    x = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 5)
    if limit == "strain":
        x[3:] += [0.2 * 0.25 * (1.0 + share), 0.0, 0.0]
        check = strain
    else:
        check = turned if limit == "turn" else bent
        sharpest = 0.5 * np.pi if limit == "turn" else 2.0 * np.arctan(0.5 / bent.measure.slenderness[1])
        angle = sharpest * (1.0 + share)
        x[3:] = x[2] + np.outer([0.25, 0.5], [np.cos(angle), np.sin(angle), 0.0])
    shown: Any = Shown(x)
    shown.natural = lambda name: np.zeros((1, 4))
    over = check.measure(shown).max() > check.limit
    assert check.bound(shown) == (share < 0.0)
    assert over == (share > 1e-9) or abs(share) < 1e-9
    assert turned.bound is bent.bound


def test_a_bound_is_asked_once_for_checks_in_a_row() -> None:
    asked = []

    def bound(s: Any) -> bool:
        asked.append(s)
        return s.positions[1, 0] < 2.0

    checks = [
        Check(lambda s: s.positions[:, 0], limit, np.arange(2), "{:.1f}".format, "far", bound)
        for limit in (2.0, 4.0)
    ]
    validity = Validity(checks)
    for x in (1.0, 3.0):
        shown: Any = Shown([[0.0, 0, 0], [x, 0, 0]])
        shown.state = type("Time", (), {"t": x})
        validity.look(shown)
    assert len(asked) == 2
    assert validity.doubts(("a", "b"), " s") == ("3.0 at t = 3 s near b: far",)


def test_triangles_that_turn_over(made: Any) -> None:
    made_of = made(shell_deck(FLAT))
    nodes, groups = made_of.geometry.nodes, made_of.geometry.node_groups
    (fold,) = (check.measure for check in made_of.simulation.checks if isinstance(check.measure, Fold))
    assert np.abs(fold(Shown(nodes))).max() < 1e-7  # type: ignore[arg-type]
    # a node pulled across the far side of its triangles: those at it lie face down
    inner = np.setdiff1d(np.arange(len(nodes)), groups["sheet.boundary"])[0]
    moved = nodes.copy()
    moved[inner] += [0.06, 0.04, 0.0]
    assert_allclose(fold(Shown(moved)).max(), np.pi, rtol=1e-7)  # type: ignore[arg-type]


@pytest.mark.parametrize("left", [0.02, 0.005])
def test_a_triangle_that_loses_its_area(made: Any, left: float) -> None:
    made_of = made(shell_deck(FLAT))
    (lost,) = (one for one in made_of.simulation.checks if isinstance(one.measure, LostArea))
    values = lost.measure(Shown(made_of.geometry.nodes * [1.0, left, 1.0]))  # type: ignore[arg-type]
    assert_allclose(values, 1.0 - left, rtol=1e-12)
    assert (values.max() > lost.limit) == (left < 0.01)


def test_a_resumed_run_remembers_what_was_passed() -> None:
    check = Check(lambda s: s.positions[:, 0], 1.0, np.arange(2), "{:.1f} reached".format, "too far")
    seen = []
    for resumed in (False, True):
        validity = Validity((check,))
        for t, x in ((0.0, 0.5), (1.0, 2.0), (2.0, 5.0), (3.0, 3.0)):
            if resumed and t == 2.0:
                parts = save_all({"validity": validity})
                validity = restore_all({"validity": Validity((check,))}, *parts)["validity"]  # type: ignore[assignment]
            shown = Shown([[0.0, 0, 0], [x, 0, 0]])
            shown.state = type("Time", (), {"t": t})  # type: ignore[attr-defined]
            validity.look(shown)  # type: ignore[arg-type]
        seen.append(validity.doubts(("a", "b"), " s"))
    assert seen[0] == seen[1] == ("5.0 reached at t = 2 s near b, too far since t = 1 s: too far",)


def driven_star(arms: list[list[float]], turn: float, radius: float, dimension: int) -> Deck:
    """Rods of one edge each, joined at the origin; the last bends itself, the others are held."""
    section = given_section() | {"radius": radius}
    bodies = [
        {
            "type": "rod",
            "name": f"arm{k}",
            "material": "m",
            "section": section,
            "generate": {"shape": "line", "from": [0.0, 0.0, 0.0], "to": arm, "nodes": 2},
        }
        for k, arm in enumerate(arms)
    ]
    last = f"arm{len(arms) - 1}"
    value = ramp(2.0 * np.tan(0.5 * turn) / 0.5)
    return rod_deck(
        {},
        geometry=bodies,
        dimension=dimension,
        joints=[{"type": "rigid", "nodes": ["arm0.start", f"arm{k}.start"]} for k in range(1, len(arms))],
        motions=[{"type": "clamp", "where": f"arm{k}", "at": "edge"} for k in range(len(arms) - 1)],
        actuation=[{"type": "curvature_1", "rod": last, "value": value}],
    )


ELBOW = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
TEE = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]


@pytest.mark.parametrize(("arms", "dimension"), [(ELBOW, 2), (ELBOW, 3), (TEE, 2), (TEE, 3)])
@pytest.mark.parametrize("turn", [2.0, 1.0])
def test_corners_and_hubs_that_turn_too_far(ran: Any, arms: Any, dimension: int, turn: float) -> None:
    doubts = ran(driven_star(arms, turn, 0.5 if turn > 1.5 else 0.01, dimension)).outcome.doubts
    assert len(doubts) == (2 if turn > 1.5 else 0)
    if doubts:
        assert doubts[0].startswith("rods turn by 115 deg against each other at a joint or corner at t = 1")
        assert "of its own radius at a joint or corner" in doubts[1]
