"""Scenes with materials of rubber: what they become, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from shell_decks import SHEET, STATIC, Deck, made, ran, refused, rod, shell_deck, write

__all__ = ["made", "ran", "refused", "write"]

RUBBER: Deck = {"model": "neo_hookean", "youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000.0}
STEEL: Deck = {"youngs_modulus": 2e8, "poisson_ratio": 0.3, "density": 8000.0}
LENGTH, AREA = 0.2, np.pi * 2e-3**2


def band(stretched: float, natural: float = 0.0, **keys: Any) -> Deck:
    """A rod of rubber pulled to ``stretched`` times its length, beside one of steel pulled by 1 %."""
    soft = rod([0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0], "soft") | {"natural": {"stretch": natural}}
    hard = rod([0.0, 0.1, 0.0], [LENGTH, 0.1, 0.0], "hard") | {"material": "steel"}
    pull = {"soft": (stretched - 1.0) * LENGTH, "hard": 0.01 * LENGTH}
    ramps = {name: {"ramp": {"from": 0.0, "to": by, "end": 1.0}} for name, by in pull.items()}
    return {
        "schema_version": 1,
        "name": "band",
        "materials": {"rubber": RUBBER, "steel": STEEL},
        "geometry": [soft, hard],
        "motions": [{"type": "clamp", "where": f"{name}.start"} for name in pull]
        + [{"type": "pin", "where": f"{n}.end", "displacement": [ramps[n], 0.0, 0.0]} for n in pull],
        "numerics": {"integrator": {"type": "static", "load_steps": 5}},
        "output": {
            "fields": ["axial_force"],
            "probes": {name: {"reaction": f"{name}.end", "component": "x"} for name in pull},
        },
    } | keys


def tension(stretch: float) -> float:
    return float(RUBBER["youngs_modulus"] / 3.0 * AREA * (stretch - stretch**-2))


@pytest.mark.parametrize(
    ("stretched", "natural", "driven"),
    [(2.0, 0.0, 0.0), (3.0, 0.0, 0.0), (0.8, 0.0, 0.0), (2.0, 0.5, 0.0), (2.0, 0.0, 0.5), (1.2, 0.0, 0.2)],
)
@pytest.mark.parametrize("dimension", [2, 3])
def test_rods_of_rubber_beside_rods_of_steel(
    ran: Any, stretched: float, natural: float, driven: float, dimension: int
) -> None:
    """A natural stretch, given or driven, makes the rod longer: stretches count from there."""
    law = {"ramp": {"from": 0.0, "to": driven, "end": 1.0}}
    actuation = [{"type": "stretch", "rod": "soft", "value": law}] if driven else []
    plane = {"dimension": 2, "plane": "xy"} if dimension == 2 else {}
    report = ran(band(stretched, natural, actuation=actuation, **plane))
    exact = {"soft": tension(stretched / (1.0 + natural + driven)), "hard": 0.01 * 2e8 * AREA}
    force = report.frames[-1].fields["axial_force"]
    for name, edges in (("soft", slice(4)), ("hard", slice(4, 8))):
        assert_allclose(report.probes[name][-1], exact[name], rtol=1e-6, atol=1e-6)
        assert_allclose(force[edges], exact[name], rtol=1e-6, atol=1e-6)


def test_rubber_is_incompressible(refused: Any) -> None:
    text = refused(shell_deck(SHEET, materials={"rubber": RUBBER | {"poisson_ratio": 0.49}}))
    assert "neo_hookean is incompressible: 'poisson_ratio' must be 0.5, got 0.49" in text


@pytest.mark.parametrize("membrane", ["springs", "family"])
def test_springs_are_no_rubber(refused: Any, membrane: str) -> None:
    deck = shell_deck(SHEET, body={"membrane": membrane}, materials={"rubber": RUBBER}, numerics=STATIC)
    assert "springs know no neo_hookean material, but 'rubber' is one; take 'cst'" in refused(deck)


def test_the_membrane_of_rubber_is_its_own(made: Any) -> None:
    for material, kernel in ((RUBBER, ("muV",)), (RUBBER | {"model": "st_venant_kirchhoff"}, ("C11",))):
        terms = made(shell_deck(SHEET, materials={"rubber": material})).simulation.model.terms
        (membrane,) = (term for term in terms if term.name == "sheet.membrane")
        assert set(kernel) <= set(membrane.kernel.constants)
