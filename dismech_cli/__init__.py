"""Batch simulator of slender soft robots by discrete differential geometry.

The three doors for Python users are :func:`load`, :func:`simulate` and :func:`read`; everything
behind them is imported on first use, so that ``dismech --help`` stays instant.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"
__all__ = ["__version__", "load", "read", "simulate"]

if TYPE_CHECKING:
    from .output.read import read
    from .scenario.load import load
    from .session.simulate import simulate

_DOORS = {
    "load": ("dismech_cli.scenario.load", "load"),
    "simulate": ("dismech_cli.session.simulate", "simulate"),
    "read": ("dismech_cli.output.read", "read"),
}


def __getattr__(name: str) -> Any:
    if name not in _DOORS:
        raise AttributeError(f"module 'dismech_cli' has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _DOORS[name]
    return getattr(import_module(module), attribute)
