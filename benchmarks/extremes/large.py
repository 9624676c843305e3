"""Scenes of 1e5 degrees of freedom, whose answers are formulas."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from dismech_cli import Report

from .cell import Cell, Check, Deck, near

_G: Final = 9.81
_E, _RHO = 1e6, 1000.0
_STEPS, _DT = 3, 1e-2


def large() -> Iterator[Cell]:
    """Rods in the plane and in space, and a sheet: hung up, and let fall."""
    for dimension, nodes in ((2, 50_001), (3, 25_001)):
        hung = _rod(dimension, nodes)
        yield Cell("1e5 DOFs", f"rod of {nodes} nodes hung up, {dimension}D", hung, _stretched(1.0))
        yield Cell("1e5 DOFs", f"rod of {nodes} nodes falling, {dimension}D", _falling(hung), _fell)
        bent = _rod(dimension, nodes, across=True)
        yield Cell("1e5 DOFs", f"cantilever of {nodes} nodes, {dimension}D", bent, _sagged)
    for nodes in (501, 1001, 2001, 3001, 4001, 5001, 10_001):
        yield Cell("fine meshes", f"cantilever of {nodes} nodes", _rod(2, nodes, across=True), _sagged)
    sheet = _sheet(180)
    yield Cell("1e5 DOFs", "sheet of 98283 hung up", sheet, _stretched(1.0))
    yield Cell("1e5 DOFs", "sheet of 98283 falling", _falling(sheet), _fell)


def _scene(body: dict[str, Any], held: str, dimension: int, gravity: float) -> dict[str, Any]:
    return {
        "schema_version": 1,
        "name": "large",
        "dimension": dimension,
        "materials": {"m": {"youngs_modulus": _E, "poisson_ratio": 0.0, "density": _RHO}},
        "geometry": [body],
        "motions": [{"type": "clamp", "where": held}],
        "forces": [{"type": "gravity", "acceleration": [0.0, 0.0, -gravity]}],
        "numerics": {"integrator": {"type": "static", "load_steps": 1}},
    }


def _rod(dimension: int, nodes: int, *, across: bool = False) -> Deck:
    end = [1.0, 0, 0] if across else [0, 0, -1.0]
    body = {"type": "rod", "name": "body", "material": "m", "radius": 0.02}
    body["generate"] = {"shape": "line", "from": [0, 0, 0], "to": end, "nodes": nodes}
    # across: the tip sinks by a thousandth of the length
    return _scene(body, "body.start", dimension, 8e-3 * _E * 1e-4 / _RHO if across else _G)


def _sheet(divisions: int) -> Deck:
    body = {"type": "shell", "name": "body", "material": "m", "thickness": 1e-2}
    body["generate"] = {
        "shape": "sheet",
        "origin": [0, 0, 0],
        "axes": [[0, 0, -1], [0, 1, 0]],
        "length": 1.0,
        "width": 1.0,
        "divisions": divisions,
    }
    return _scene(body, "body.left", 3, _G)


def _falling(deck: Deck) -> Deck:
    numerics = {"integrator": {"type": "implicit_euler"}, "dt": _DT, "t_end": _STEPS * _DT}
    return dict(deck) | {"motions": [], "numerics": numerics, "output": {"every": _STEPS * _DT}}


def _stretched(length: float) -> Check:
    """Under its weight, by rho g L^2 / 2 E."""

    def check(report: Report) -> str:
        longer = -float(report.frames[-1].positions[:, 2].min()) - length
        return near(longer, _RHO * _G * length**2 / (2.0 * _E), 1e-2, "stretch")

    return check


def _fell(report: Report) -> str:
    """In N steps of implicit Euler by N (N + 1)/2 g dt^2."""
    first, last = report.frames[0].positions, report.frames[-1].positions
    expected = -0.5 * _STEPS * (_STEPS + 1) * _G * _DT**2
    off = float(np.abs(last - first - [0.0, 0.0, expected]).max())
    return "" if off <= 1e-6 * abs(expected) else f"off its fall by {off / abs(expected):.2g}"


def _sagged(report: Report) -> str:
    """By rho g A L^4 / 8 EI, EI = E A r^2 / 4."""
    return near(float(report.frames[-1].positions[-1, 2]), -1e-3, 1e-2, "sag")
