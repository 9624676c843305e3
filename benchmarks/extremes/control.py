"""Feedback at extreme gains and periods: a loop of one edge, whose samples follow a recursion; and an arm."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import pi
from typing import Any, Final

import numpy as np

from dismech_cli import Report

from .cell import Cell, Check, Deck

_DT, _SAMPLES, _TARGET = 1e-2, 40, 1e-3
_MODULUS, _RADIUS, _LENGTH, _DRAG = 1e5, 5e-3, 0.1, 1e3
# Time constant of an edge that stretches in thick fluid: half of its drag moves with the node.
_DECAY: Final = _MODULUS * pi * _RADIUS**2 / _LENGTH / (_DRAG * 0.5 * _LENGTH)
GAINS: Final = (1e-6, 1e-3, 1.0, 10.0, 1e3, 1e6)


def control() -> Iterator[Cell]:
    """Gains from nothing to far beyond what is stable, periods from a tenth of a step to a hundred."""
    for p, parts in product(GAINS, (0.1, 1, 10, 100)):
        label = f"edge, p = {p:g}, a sample per {parts:g} steps"
        yield Cell("control", label, _edge(p, parts), _follows(p, parts))
    for p, i in product(GAINS, (0.0, 100.0)):
        yield Cell("control", f"arm, ideal, p = {p:g}, i = {i:g}/s", _arm(p, i), _at_rest(p, i))


def _scene(strain: str, nodes: int, held: str, drag: float, controller: dict[str, Any], end: float) -> Deck:
    line = {"shape": "line", "from": [0, 0, 0], "to": [_LENGTH, 0, 0], "nodes": nodes}
    arm = {"type": "rod", "name": "arm", "material": "m", "radius": _RADIUS, "generate": line}
    return {
        "schema_version": 1,
        "name": "fed_back",
        "dimension": 2,
        "materials": {"m": {"youngs_modulus": _MODULUS, "poisson_ratio": 0.5, "density": 1e-3}},
        "geometry": [arm],
        "motions": [{"type": held, "where": "arm.start"}],
        "forces": [{"type": "viscous", "coefficient": drag}],
        "actuation": [{"type": strain, "rod": "arm", "value": {"controlled_by": "loop"}}],
        "controllers": {"loop": {"type": "pi", "target": _TARGET} | controller},
        "numerics": {"integrator": {"type": "implicit_euler"}, "dt": _DT, "t_end": end},
        "output": {"every": _DT, "probes": {"error": {"controller": "loop", "measure": "error"}}},
    }


def _edge(p: float, parts: float) -> Deck:
    controller = {"gains": {"p": p}, "period": parts * _DT, "hold": "step"}
    return _scene("stretch", 2, "pin", _DRAG, controller, _SAMPLES * max(parts, 1.0) * _DT)


def _follows(p: float, parts: float) -> Check:
    """y <- u + (y - u)/(1 + w)^m with u = r + p (r - y), in steps of implicit Euler."""

    def check(report: Report) -> str:
        y, u = 0.0, 0.0
        expected = [abs(_TARGET)]
        steps = round(1.0 / parts) if parts < 1.0 else 1
        for k in range(_SAMPLES * max(round(parts), 1)):
            for _ in range(steps):
                if parts < 1.0 or k % round(parts) == 0:
                    u = _TARGET + p * (_TARGET - y)
                y = u + (y - u) / (1.0 + _DECAY * _DT / steps)
            expected.append(abs(_TARGET - y))
        found, wanted = report.probes["error"], np.array(expected)
        if found.shape != wanted.shape:
            return f"{len(found)} frames for {len(wanted)}"
        # what swings ever wider amplifies rounding, and the curvature of the formula, as well
        off = np.abs(found - wanted) / np.maximum(np.maximum.accumulate(wanted), _TARGET)
        return "" if off.max() <= 1e-3 else f"off the recursion by {off.max():.2g}"

    return check


def _arm(p: float, i: float) -> Deck:
    controller = {"feedback": "ideal", "gains": {"p": p, "i": i}}
    return _scene("curvature_1", 6, "clamp", 1.0, controller, 3.0)


def _at_rest(p: float, i: float) -> Check:
    """Nothing loads the arm: it comes to rest in its target."""
    del p, i

    def check(report: Report) -> str:
        left = float(report.probes["error"][-1]) / _TARGET
        return "" if left <= 1e-3 else f"error of {left:.2g} of the target"

    return check
