"""Collecting the members of named groups while a file is read."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ...arrays import IntArray, distinct


class GroupBuilder:
    """Gathers indices under names; :meth:`build` gives sorted arrays without repeats."""

    def __init__(self) -> None:
        self._members: dict[str, list[int]] = {}

    def add(self, names: Iterable[str], indices: Iterable[int]) -> None:
        """Add indices to each of the named groups."""
        found = list(indices)
        for name in names:
            self._members.setdefault(name, []).extend(found)

    def build(self) -> dict[str, IntArray]:
        """Return the groups, leaving out empty ones."""
        return {
            name: distinct(np.array(found, dtype=np.int64)) for name, found in self._members.items() if found
        }
