"""Batch simulator of slender soft robots by discrete differential geometry.

The doors for Python users: :func:`load`, :func:`load_text` and :func:`load_mapping` read a scenario,
:func:`simulate` runs it, :func:`read` opens a run directory. Everything behind them is imported on first
use, so that ``dismech --help`` stays instant.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"
__all__ = ["Limits", "Report", "__version__", "load", "load_mapping", "load_text", "read", "simulate"]

if TYPE_CHECKING:
    from .output.read import read
    from .run.loop import Limits
    from .scenario.load import load, load_mapping, load_text
    from .session.report import Report
    from .session.simulate import simulate

_DOORS = {
    "Limits": "run.loop",
    "Report": "session.report",
    "load": "scenario.load",
    "load_mapping": "scenario.load",
    "load_text": "scenario.load",
    "read": "output.read",
    "simulate": "session.simulate",
}


def __getattr__(name: str) -> Any:
    if name not in _DOORS:
        raise AttributeError(f"module 'dismech_cli' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"{__name__}.{_DOORS[name]}"), name)
