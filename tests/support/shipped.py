"""What the rooms of physics ship."""

from __future__ import annotations

import importlib
import pkgutil

from dismech_cli import energies, forces


def shipped(kind: type) -> dict[str, object]:
    """Every kernel of some kind in the rooms of physics, by the name of its constant."""
    found = {}
    for room in (energies, forces):
        for file in pkgutil.iter_modules(room.__path__):
            module = importlib.import_module(f"{room.__name__}.{file.name}")
            found |= {name: value for name, value in vars(module).items() if isinstance(value, kind)}
    return found
