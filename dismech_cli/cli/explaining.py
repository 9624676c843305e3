"""Part of a scenario by key path."""

from __future__ import annotations

from collections.abc import Mapping

from ..errors import ScenarioError
from ..scenario.views.provenance import Provenance
from ..words import hint


def below(provenance: Mapping[str, Provenance], path: str) -> dict[str, Provenance]:
    """The values at ``path`` and below it.

    Raises:
        ScenarioError: There are none.
    """
    found = {key: value for key, value in provenance.items() if path in _ancestors(key)}
    if not found:
        known = dict.fromkeys(part for key in provenance for part in _ancestors(key))
        raise ScenarioError(f"the scenario has no value {path!r}{hint(path, known)}")
    return found


def _ancestors(key: str) -> list[str]:
    """``a.b[0].c`` as ``a``, ``a.b``, ``a.b[0]``, ``a.b[0].c``."""
    return [key[:i] for i, letter in enumerate(key) if letter in ".["] + [key]
