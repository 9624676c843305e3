"""Extensions of a pattern, by NumPy or by compiled loops."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Final, Protocol, TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling
from . import entry_loops
from .pattern import Blocks, Extension, SparsityPattern

_Loop: TypeAlias = Callable[..., Any]

LOOPS: Final[tuple[_Loop, ...]] = (
    entry_loops.gather_pairs,
    entry_loops.spread_pairs,
    entry_loops.merge,
    entry_loops.add_at,
)
"""What :class:`CompiledExtender` is made of, after its blocks."""

# Pairs of blocks that are remembered, a power of two.
_SEEN: Final = 512


class Extender(Protocol):
    """Extends one pattern again and again."""

    def entries(self, couplings: Iterable[Coupling]) -> IntArray:
        """Keys of all entries of cliques, each once, ascending."""

    def extended(self, entries: IntArray) -> Extension:
        """The pattern with more entries, given by their keys."""

    def add_at(self, base: FloatArray, slots: IntArray, values: FloatArray) -> None:
        """Add values of the pattern to those of an extension, at its ``base_slots``."""


@frozen
class CompiledExtender:
    """By loops; implements :class:`Extender`.

    Attributes:
        base: The pattern.
        blocks: Its blocks of DOFs.
        gather: See :func:`.entry_loops.gather_pairs`.
        spread: See there.
        merge: See there.
        add_at: See there.
    """

    base: SparsityPattern
    blocks: Blocks
    gather: _Loop
    spread: _Loop
    merge: _Loop
    add_at: _Loop

    def entries(self, couplings: Iterable[Coupling]) -> IntArray:
        """Keys of all entries of cliques: pairs of blocks, in buckets by rows."""
        blocks = self.blocks
        m = len(blocks.width)
        pairs, seen = np.empty((0, 2), dtype=np.int64), np.full(_SEEN, -1)
        for coupling in couplings:
            pairs = self.gather(coupling.dofs, blocks.of, blocks.start, m, seen, pairs)
        keys: IntArray = self.spread(pairs, blocks.width, not self.base.symmetric)
        return keys

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
        b, rows = self.base, (keys[:found], indptr, indices[:found], diagonal)
        pattern = SparsityPattern(b.free, b.order, b.block, *rows, symmetric=b.symmetric)
        return Extension(pattern, base_slots, entry_slots, entries)


def extender_of(base: SparsityPattern, driver: Driver) -> Extender:
    """The one that a driver runs."""
    loops: list[_Loop] = [made for one in LOOPS if (made := driver.compiled(one)) is not None]
    return CompiledExtender(base, base.blocks(), *loops) if len(loops) == len(LOOPS) else base
