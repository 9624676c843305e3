"""Extensions of a pattern, by NumPy or by compiled loops."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

import numpy as np

from ..arrays import IntArray
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling
from . import entry_loops
from .pattern import Extension, SparsityPattern

_Loop: TypeAlias = Callable[..., Any]


class Extender(Protocol):
    """Extends one pattern again and again."""

    def entries(self, couplings: Iterable[Coupling]) -> IntArray:
        """Keys of all entries of cliques, each once, ascending."""

    def extended(self, entries: IntArray) -> Extension:
        """The pattern with more entries, given by their keys."""


@dataclass(frozen=True, slots=True)
class CompiledExtender:
    """By loops; implements :class:`Extender`.

    Attributes:
        base: The pattern.
        count: See :func:`.entry_loops.count_pairs`.
        fill: See there.
        spread: See there.
        merge: See there.
    """

    base: SparsityPattern
    count: _Loop
    fill: _Loop
    spread: _Loop
    merge: _Loop

    def entries(self, couplings: Iterable[Coupling]) -> IntArray:
        """Keys of all entries of cliques: the pairs of blocks in buckets by rows."""
        both, blocks = not self.base.symmetric, self.base.blocks()
        m = len(blocks.width)
        cliques = [blocks.places(coupling) for coupling in couplings]
        counts = np.zeros(m + 1, dtype=np.int64)
        for places in cliques:
            self.count(places, m, both, counts)
        begin = np.cumsum(counts)
        at, columns = begin.copy(), np.empty(int(begin[-1]), dtype=np.int64)
        for places in cliques:
            self.fill(places, m, both, at, columns)
        keys = np.empty(2 * len(columns), dtype=np.int64)
        found = self.spread(begin, columns, blocks.width, both, keys)
        if found > len(keys):
            keys = np.empty(found, dtype=np.int64)
            # rows are in order by now, with columns left behind their last one that are in them already
            self.spread(begin, columns, blocks.width, both, keys)
        return keys[:found]

    def extended(self, entries: IntArray) -> Extension:
        """The pattern with more entries."""
        base = self.base.keys
        keys = np.empty(len(base) + len(entries), dtype=np.int64)
        base_slots, entry_slots = np.empty_like(base), np.empty_like(entries)
        found = self.merge(base, entries, keys, base_slots, entry_slots)
        return Extension.of(self.base, keys[:found].copy(), base_slots, entry_slots, entries)


def extender_of(base: SparsityPattern, driver: Driver) -> Extender:
    """The one that a driver runs."""
    names = (
        entry_loops.count_pairs,
        entry_loops.fill_pairs,
        entry_loops.spread_pairs,
        entry_loops.merge,
    )
    loops: list[_Loop] = [made for one in names if (made := driver.compiled(one)) is not None]
    return CompiledExtender(base, *loops) if len(loops) == len(names) else base
