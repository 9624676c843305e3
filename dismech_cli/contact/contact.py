"""Contact as a term of the model, and what its bound terms share."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..arrays import FloatArray
from ..frozen import frozen
from ..kernels.driver import Driver
from ..kernels.linearization import Coupling
from ..kinematics.dofs import DofMap
from ..model.configuration import Configuration
from ..model.term import BoundChanging, Memory
from ..model.touch import Touch
from .drivers.loops import Loops, loops_of
from .gather.source import Source
from .gather.stencils import Stencils
from .gather.touching import Touching
from .guards.guarding import Guarding
from .law.stiffness import Hardness, Rule, given_up
from .nearby.faces import Faces
from .nearby.neighbours import Neighbours
from .nearby.searches import Searches
from .obstacles.near_wall import NearWall
from .obstacles.walls import Wall
from .pairs.anchored_pairs import Paired
from .pairs.rod_pairs import RodPairs
from .pairs.search import Search
from .pairs.surface_pairs import SurfacePairs
from .pairs.surface_search import FaceSearch
from .pieces.lines import Lines
from .sums import deepest, summed, worst
from .terms import AnchoredFriction, FullFriction, MeasuredFriction, NormalTerm, SymmetricFriction

# The start of a step, an iterate and the next one.
_KEPT: Final = 3

# Factor of the stiffness before a step and after, calm steps, depth that could not be prevented.
_AS_MADE: Final = np.array([1.0, 1.0, 0.0, 0.0])

HARDNESS, DEEPEST, WORST = "contact.hardness", "contact.deepest", "contact.worst"


def as_found(pairs: Source, name: str) -> Source:
    """What finds bodies that touch each other, as it is."""
    return pairs


@frozen
class Friction:
    """Regularised Coulomb friction.

    Attributes:
        full: Speed at which it is all but full [m/s]; of anchored friction a way [m].
        kind: Which tangent Newton's method is given.
        wall: Makes of obstacles what finds lines that touch them.
        pairs: Makes of what finds bodies that touch each other, with its name, what it is for this friction.
    """

    full: float
    kind: type[SymmetricFriction] | type[FullFriction]
    wall: Callable[[Wall], Source] = NearWall
    pairs: Callable[[Paired, str], Source] = as_found


def along_lines(contact: Contact, driver: Driver) -> Iterator[Source]:
    """What finds lines that touch obstacles and bodies, and what keeps things apart."""
    wall = NearWall if contact.friction is None else contact.friction.wall
    pairs = as_found if contact.friction is None else contact.friction.pairs
    yield from (wall(one) for one in contact.walls)
    # each search has loops of its own: what it found last stays until it looks again
    searches = Searches()
    if contact.neighbours is not None:
        rods = Search(contact.neighbours, loops_of(driver))
        searches = replace(searches, rods=rods)
        yield pairs(RodPairs(rods), "rods")
    if contact.faces is not None:
        faces = FaceSearch(contact.faces, loops_of(driver))
        searches = replace(searches, faces=faces)
        yield pairs(SurfacePairs(faces), "faces")
    yield from contact.guards.sources(searches, loops_of(driver))


@frozen
class Contact:
    """Who may touch whom, how stiff and how rough; implements :class:`~dismech_cli.model.term.ChangingTerm`.

    Attributes:
        map: Numbering of the DOFs.
        lines: All lines.
        walls: Obstacles with the lines that may touch them.
        neighbours: Rods that may touch each other; None if none may.
        faces: What may touch shells; None if nothing may.
        rule: Decides on the stiffness.
        friction: None where all is smooth.
        guards: What keeps things at a distance.
        pairs: Names of the pairs of bodies.
        finding: Makes what finds who touches.
    """

    map: DofMap
    lines: Lines
    walls: tuple[Wall, ...]
    neighbours: Neighbours | None
    faces: Faces | None
    rule: Rule
    friction: Friction | None
    guards: Guarding
    pairs: tuple[tuple[str, str], ...]
    finding: Callable[[Contact, Driver], Iterable[Source]] = along_lines

    @property
    def velocity_dependent(self) -> bool:
        """Whether anything rubs."""
        return self.friction is not None

    @property
    def symmetric(self) -> bool:
        """Whether the tangents are symmetric."""
        return self.friction is None or self.friction.kind.symmetric

    @property
    def spreads(self) -> bool:
        """Whether bodies touch each other; obstacles couple nothing that their lines do not."""
        return self.neighbours is not None or self.faces is not None

    def start(self, driver: Driver) -> Contacts:
        """What the terms share, with the terms."""
        return Contacts(self, driver)

    def exactly(self) -> Contact:
        """The same with the slope that friction has."""
        rough = self.friction
        return self if rough is None else replace(self, friction=replace(rough, kind=MeasuredFriction))

    def untold(self, left: Iterable[Memory]) -> str:
        """Why more than states and velocities tells what it does; empty if nothing does."""
        if self.finding is not along_lines:
            return "the law 'compat' goes by pairs, whose tangents are not exact across their ends"
        if self.guards.pairings or self.guards.walls:
            return "the barrier of contact has no exact tangent; 'contact.law.core: off' leaves it out"
        if self.faces is not None:
            return "where shells are touched contact has no exact tangent"
        if self.friction is not None and self.friction.kind is AnchoredFriction:
            return "anchors of friction depend on all steps before"
        if any(memory.get(HARDNESS, _AS_MADE)[:2].tolist() != [1.0, 1.0] for memory in left):
            return "the stiffness of contact changes between steps; 'contact.law.stiffness' gives one"
        return ""


class Contacts:
    """Who touches whom; implements :class:`~dismech_cli.model.term.ChangingSet`."""

    def __init__(self, contact: Contact, driver: Driver) -> None:
        self._contact = contact
        self.loops: Loops = loops_of(driver)
        # in this step, before it, and in the next
        self._now = self._early = self._later = Hardness()
        self._deepest = self._by_end = np.zeros(len(contact.lines.nodes))
        self._worst = self._worst_by_end = np.zeros(4)
        self._end = np.empty((0, 3))
        self._places: list[tuple[Configuration, FloatArray]] = []
        rough = contact.friction
        self._sources = tuple(contact.finding(contact, driver))
        self.couplings: tuple[Coupling, ...] = ()
        self._list()
        self._at: Configuration | None = None
        self._touching: tuple[Touching, ...] = ()
        normal = NormalTerm(self, steady=all(source.steady for source in self._sources))
        self._friction = None if rough is None else rough.kind(self, rough.full)
        self.terms: tuple[BoundChanging, ...] = (
            (normal,) if self._friction is None else (normal, self._friction)
        )

    def recall(self, memory: Memory) -> None:
        """Take the stiffness that the last step left."""
        early, later, calm, mark = memory.get(HARDNESS, _AS_MADE).tolist()
        self._deepest = self._by_end = memory.get(DEEPEST, np.zeros(len(self._deepest)))
        self._worst = self._worst_by_end = memory.get(WORST, np.zeros(4))
        self._early = Hardness(early)
        self._take(Hardness(later, int(calm), mark))
        for source in self._sources:
            source.recall(memory)

    def begin(self, start: Configuration, dt: float) -> None:
        """Take a higher stiffness for what is about to hit."""
        self._take(self._contact.rule.before(self._now, self._needed(start, dt)))

    def detect(self, c: Configuration) -> bool:
        """Find what touches; True if items came or went."""
        x = self._space(c)
        if not any([source.detect(x) for source in self._sources]):
            return False
        self._list()
        return True

    def longest_step(self, start: Configuration, end: Configuration) -> float:
        """The part on which nothing passes through anything."""
        x0, x1 = self._space(start), self._space(end)
        return min(source.longest_step(x0, x1, start.t, end.t) for source in self._sources)

    def reverses(self, start: Configuration, end: Configuration) -> bool:
        """Whether the slip of a point that touches at the start turns round, and is no creep."""
        if self._friction is None:
            return False
        return any(
            self._friction.reverses(touching, self.velocities(touching, end, end.v))
            for touching in self.touching(start)
        )

    def settle(self, end: Configuration) -> bool:
        """Whether nothing is deeper than the rule allows."""
        rule = self._contact.rule
        self._end = self._space(end)
        depths = [source.depths(self._end, end.t) for source in self._sources]
        depth = deepest(len(self._deepest), depths)
        self._by_end = np.maximum(self._deepest, depth)
        self._worst_by_end = worst(self._worst, depths, end.t)
        deep = float(depth.max(initial=0.0)) / rule.tolerance
        after = rule.after(self._now, deep)
        self._stood = self._now, given_up(self._now, deep)
        if after.redos > self._now.redos:
            self._take(after)
            return False
        self._later = after
        return True

    def take_back(self) -> None:
        """Go back to the stiffness of the step that was too deep."""
        self._take(self._stood[0])
        self._later = self._stood[1]

    def put_in(self, start: Configuration) -> float:
        """Energy of the change of stiffness since the last step [J]."""
        share = 1.0 - self._early.factor / self._now.factor
        return (
            share * sum(float(touching.points.energy.sum()) for touching in self.touching(start))
            if share
            else 0.0
        )

    def memory(self) -> Memory:
        """The stiffness in use and the next one, calm steps, how deep each line has been, and the worst."""
        later = self._later
        return {
            HARDNESS: np.array([self._now.factor, later.factor, float(later.calm), later.mark]),
            DEEPEST: self._by_end,
            WORST: self._worst_by_end,
            **{name: values for source in self._sources for name, values in source.memory(self._end).items()},
        }

    def touching(self, c: Configuration) -> Sequence[Touching]:
        """What touches at a configuration; kept until another is asked for."""
        if self._at is not c:
            self._touching = tuple(self._found(c))
            self._at = c
        return self._touching

    def velocities(self, touching: Touching, c: Configuration, v: FloatArray) -> FloatArray:
        """Relative velocities at points of contact if the DOFs at ``c`` had velocities (n,), shape (3, K)."""
        source = self._sources[bisect_right(self._begins, touching.kind) - 1]
        return source.velocities(touching, self._space(c), self._speed(v), c.t)

    def touch(self, c: Configuration) -> Touch:
        """Sums by pair of bodies."""
        x = self._space(c)
        depths = [source.depths(x, c.t) for source in self._sources]
        return summed(self._contact.pairs, self.touching(c), depths, self._friction, len(x))

    def nodal(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        """Places and velocities of all nodes in space."""
        return self._space(c), self._speed(c.v)

    @property
    def stencils(self) -> tuple[Stencils, ...]:
        """Nodes of all items that have places in the matrix, by kind."""
        return self._stencils

    def _list(self) -> None:
        """Note which items have places, and where the kinds of each source begin."""
        kinds = [source.stencils for source in self._sources]
        self._begins = np.cumsum([0, *(len(own) for own in kinds)]).tolist()
        self._stencils = tuple(stencils for own in kinds for stencils in own)
        self.couplings = tuple(stencils.coupling for stencils in self._stencils)
        self._at = None

    def _take(self, hardness: Hardness) -> None:
        self._now = self._later = hardness
        self._at = None

    def _needed(self, start: Configuration, dt: float) -> float:
        """Factor that stops in time what comes in a step."""
        x = self._space(start)
        ahead = x + dt * self._speed(start.v)
        tolerance = self._contact.rule.tolerance
        return max(source.needed(x, ahead, start.t, dt, tolerance) for source in self._sources)

    def _found(self, c: Configuration) -> Iterator[Touching]:
        x, v = self._space(c), self._speed(c.v)
        for source, begin in zip(self._sources, self._begins, strict=False):
            for touching in source.touching(x, v, c.t, self._now.factor):
                yield replace(touching, kind=begin + touching.kind) if begin else touching

    def _space(self, c: Configuration) -> FloatArray:
        """Places of nodes, kept for the last few trial points: the ends of a step are asked for often."""
        for one, x in self._places:
            if one is c:
                return x
        x = self._contact.map.space_positions(c.q)
        self._places = [*self._places[1 - _KEPT :], (c, x)]
        return x

    def _speed(self, v: FloatArray) -> FloatArray:
        return self._contact.map.embed(self._contact.map.positions(v))
