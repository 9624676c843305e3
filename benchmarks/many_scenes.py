"""Scenarios of many rods."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def clamped_rods(count: int) -> dict[str, Any]:
    """Rods beside each other, each clamped at an end, without numerics."""
    ends = {f"r{k}": ([0.0, 0.05 * k, 0.0], [0.5, 0.05 * k, 0.0]) for k in range(count)}
    return _falling(ends, 21, [f"{name}.start" for name in ends])


def net(count: int) -> dict[str, Any]:
    """As many rods along as across, joined wherever they cross, held by one of them, without numerics."""
    mesh = 0.02
    far = mesh * (count - 1)
    along = {f"a{k}": ([0.0, mesh * k, 0.0], [far, mesh * k, 0.0]) for k in range(count)}
    across = {f"b{k}": ([mesh * k, 0.0, 0.0], [mesh * k, far, 0.0]) for k in range(count)}
    return _falling(along | across, count, ["a0"]) | {"joints": "auto"}


def _falling(
    ends: dict[str, tuple[list[float], list[float]]], nodes: int, held: Iterable[str]
) -> dict[str, Any]:
    def rod(name: str, start: list[float], end: list[float]) -> dict[str, Any]:
        line = {"shape": "line", "from": start, "to": end, "nodes": nodes}
        return {"type": "rod", "name": name, "material": "rubber", "radius": 1e-3, "generate": line}

    return {
        "schema_version": 1,
        "name": "benchmark",
        "materials": {"rubber": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1e3}},
        "geometry": [rod(name, *places) for name, places in ends.items()],
        "motions": [{"type": "clamp", "where": where} for where in held],
        "forces": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "output": {"fields": []},
    }
