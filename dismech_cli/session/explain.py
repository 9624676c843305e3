"""Every value of a scenario and who set it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..errors import ScenarioError
from ..scenario.load import load
from ..scenario.views.provenance import Provenance
from ..words import hint


def explain(
    path: Path,
    key: str | None,
    *,
    overrides: tuple[str, ...],
    profile: str | None,
    allow_outside: bool,
) -> Mapping[str, Provenance]:
    """The values of a scenario by key path; with a key, those at it and below.

    Raises:
        ScenarioError: The scenario cannot be read, or has no such key.
    """
    provenance = load(path, overrides=overrides, profile=profile, allow_outside=allow_outside).provenance
    return provenance if key is None else _below(provenance, key)


def _below(provenance: Mapping[str, Provenance], key: str) -> dict[str, Provenance]:
    found = {path: value for path, value in provenance.items() if key in _ancestors(path)}
    if not found:
        known = dict.fromkeys(part for path in provenance for part in _ancestors(path))
        raise ScenarioError(f"the scenario has no value {key!r}{hint(key, known)}")
    return found


def _ancestors(path: str) -> list[str]:
    """``a.b[0].c`` as ``a``, ``a.b``, ``a.b[0]``, ``a.b[0].c``."""
    return [path[:i] for i, letter in enumerate(path) if letter in ".["] + [path]
