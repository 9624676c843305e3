"""Extensions of a pattern, by NumPy or by compiled loops."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any, Final, Protocol, TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling
from . import entry_loops
from .pattern import Blocks, Extension, SparsityPattern

_Loop: TypeAlias = Callable[..., Any]

LOOPS: Final[tuple[_Loop, ...]] = (
    entry_loops.count_pairs,
    entry_loops.fill_pairs,
    entry_loops.spread_pairs,
    entry_loops.merge,
    entry_loops.add_at,
)
"""What :class:`CompiledExtender` is made of, after its blocks."""


class Extender(Protocol):
    """Extends one pattern again and again."""

    def entries(self, couplings: Iterable[Coupling]) -> IntArray:
        """Keys of all entries of cliques, each once, ascending."""

    def extended(self, entries: IntArray) -> Extension:
        """The pattern with more entries, given by their keys."""

    def add_at(self, base: FloatArray, slots: IntArray, values: FloatArray) -> None:
        """Add values of the pattern to those of an extension, at its ``base_slots``."""


@dataclass(frozen=True, slots=True)
class CompiledExtender:
    """By loops; implements :class:`Extender`.

    Attributes:
        base: The pattern.
        blocks: Its blocks of DOFs.
        count: See :func:`.entry_loops.count_pairs`.
        fill: See there.
        spread: See there.
        merge: See there.
        add_at: See there.
    """

    base: SparsityPattern
    blocks: Blocks
    count: _Loop
    fill: _Loop
    spread: _Loop
    merge: _Loop
    add_at: _Loop

    def entries(self, couplings: Iterable[Coupling]) -> IntArray:
        """Keys of all entries of cliques: the pairs of blocks in buckets by rows."""
        both, blocks = not self.base.symmetric, self.blocks
        m = len(blocks.width)
        counts = np.zeros(m + 1, dtype=np.int64)
        cliques = [self._counted(coupling, both, counts) for coupling in couplings]
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
        base, m = self.base.keys, self.base.m
        keys, indices = np.empty((2, len(base) + len(entries)), dtype=np.int64)
        base_slots, entry_slots = np.empty(len(base) + 1, dtype=np.int64), np.empty_like(entries)
        indptr, diagonal = np.empty(m + 1, dtype=np.int64), np.empty(m, dtype=np.int64)
        found = self.merge(
            base, self.base.indptr, entries, keys, base_slots, entry_slots, indptr, indices, diagonal
        )
        base_slots[-1] = found
        pattern = replace(
            self.base, keys=keys[:found], indptr=indptr, indices=indices[:found], diagonal=diagonal
        )
        return Extension(pattern, base_slots, entry_slots, entries)

    def _counted(self, coupling: Coupling, both: bool, counts: IntArray) -> IntArray:
        """Starts of the blocks of each clique, shape (S, blocks), their pairs counted."""
        dofs, blocks = coupling.dofs, self.blocks
        places = np.empty(dofs.size, dtype=np.int64)
        n = self.count(dofs, blocks.of, blocks.start, len(blocks.width), both, places, counts)
        return places[: len(dofs) * n].reshape(len(dofs), n)


def extender_of(base: SparsityPattern, driver: Driver) -> Extender:
    """The one that a driver runs."""
    loops: list[_Loop] = [made for one in LOOPS if (made := driver.compiled(one)) is not None]
    return CompiledExtender(base, base.blocks(), *loops) if len(loops) == len(LOOPS) else base
