"""Scenario files written by tests: what they verify is what a user gets, from YAML text to frames."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dismech_cli import load, simulate
from dismech_cli.arrays import FloatArray
from dismech_cli.run.loop import End
from dismech_cli.session.report import Report

Deck = dict[str, Any]

STATIC: Deck = {"integrator": {"type": "static", "load_steps": 5}}
CLAMPED_START: list[Deck] = [{"type": "clamp", "where": "rod.start"}]


def given_section(
    *,
    axial: float = 1e8,
    bending_1: float = 1.0,
    bending_2: float | None = None,
    torsion: float = 1.0,
    mass_per_length: float = 1.0,
    rotary_inertia: float = 1e-4,
) -> Deck:
    """A section by its stiffnesses: unit bending stiffness makes loads dimensionless."""
    return {
        "type": "given",
        "axial_stiffness": axial,
        "bending_stiffness_1": bending_1,
        "bending_stiffness_2": bending_1 if bending_2 is None else bending_2,
        "torsional_stiffness": torsion,
        "mass_per_length": mass_per_length,
        "rotary_inertia_per_length": rotary_inertia,
        "radius": 1e-2,
    }


def line(nodes: int, end: Sequence[float] = (1.0, 0.0, 0.0)) -> Deck:
    """A straight centreline from the origin."""
    return {"shape": "line", "from": [0.0, 0.0, 0.0], "to": [float(x) for x in end], "nodes": nodes}


def rod_deck(centreline: Deck, section: Deck | None = None, **keys: Any) -> Deck:
    """A static planar scene of one clamped rod named ``rod``; ``keys`` replace or add top-level keys.

    ``rod`` among the keys is merged into the body, ``None`` removes a key.
    """
    rod: Deck = {"type": "rod", "name": "rod", "material": "m", "generate": centreline}
    rod["section"] = given_section() if section is None else section
    deck: Deck = {
        "schema_version": 1,
        "name": "verification",
        "dimension": 2,
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000.0}},
        "geometry": [rod | keys.pop("rod", {})],
        "motions": CLAMPED_START,
        "numerics": STATIC,
    }
    deck |= keys
    return {key: value for key, value in deck.items() if value is not None}


def attempt(folder: Path, deck: Deck, *overrides: str) -> Report:
    """Run a deck, however it ends."""
    file = folder / "scene.yaml"
    # JSON is YAML
    file.write_text(json.dumps(deck, default=lambda array: array.tolist()), encoding="utf-8")
    return simulate(load(file, overrides=overrides))


def solve(folder: Path, deck: Deck, *overrides: str) -> Report:
    """Run a deck to its end."""
    result = attempt(folder, deck, *overrides)
    assert result.outcome.end is End.DONE, result.outcome.message
    return result


def tip(result: Report) -> FloatArray:
    """Last node of the last frame [m], shape (3,)."""
    return result.frames[-1].positions[-1]


def scalar(result: Report, name: str) -> FloatArray:
    """A column of the scalar table over the frames."""
    return np.array([frame.scalars[name] for frame in result.frames])


def critical_load(stable: Callable[[float], bool], low: float, high: float, relative: float = 1e-5) -> float:
    """Load between ``low`` (stable) and ``high`` (not) at which stability is lost, by bisection."""
    assert stable(low), f"unstable at {low} already"
    assert not stable(high), f"stable at {high} still"
    while high - low > relative * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return 0.5 * (low + high)


def negative_eigenvalues(folder: Path, deck: Deck, *overrides: str) -> int:
    """Of the stiffness at the end of a static deck."""
    probed = deck | {"output": {"every": 1.0, "probes": {"negative": {"negative_eigenvalues": True}}}}
    return int(scalar(solve(folder, probed, *overrides), "negative")[-1])
