"""What ``frozen`` makes of a class is what ``dataclass(frozen=True, slots=True)`` makes of it."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, asdict, dataclass, field, fields, replace
from typing import Any, Generic, TypeVar

import pytest

from dismech_cli.frozen import frozen

T = TypeVar("T")


@frozen
class Point(Generic[T]):
    """A class of any kind of fields."""

    x: T
    y: float = 1.5
    names: list[str] = field(default_factory=list)
    hidden: int = field(default=3, repr=False)
    ignored: int = field(default=4, compare=False)
    length: float = field(init=False)
    counted: dict[str, int] = field(default_factory=dict, init=False)
    fixed: str = field(default="so", init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "length", self.y * 2.0)


@dataclass(frozen=True, slots=True)
class Reference(Generic[T]):
    """The same by the library."""

    x: T
    y: float = 1.5
    names: list[str] = field(default_factory=list)
    hidden: int = field(default=3, repr=False)
    ignored: int = field(default=4, compare=False)
    length: float = field(init=False)
    counted: dict[str, int] = field(default_factory=dict, init=False)
    fixed: str = field(default="so", init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "length", self.y * 2.0)


@frozen
class Further(Point[int]):
    """One that goes on from another."""

    z: float = 0.0


@frozen(kw_only=True)
class Named:
    """One whose fields are given by name."""

    b: int = 2
    a: int


@frozen(eq=False)
class Itself:
    """One that equals nothing else."""

    values: list[int]


@frozen
class Own:
    """One with methods of its own."""

    a: int

    def __repr__(self) -> str:
        return "mine"

    def __eq__(self, other: object) -> bool:
        return True

    def __hash__(self) -> int:
        return 7


@frozen
class Nothing:
    """One without fields."""


GIVEN: tuple[Callable[[Any], Any], ...] = (
    lambda make: make(1),
    lambda make: make(1, 2.0),
    lambda make: make(x=1, y=2.0, names=["a"], hidden=5),
    lambda make: make((1, 2), ignored=9),
)


@pytest.mark.parametrize("given", GIVEN)
def test_values_text_and_copies_are_those_of_a_dataclass(given: Callable[[Any], Any]) -> None:
    ours, theirs = given(Point), given(Reference)
    assert asdict(ours) == asdict(theirs)
    assert repr(ours) == repr(theirs).replace("Reference", "Point")
    assert [one.name for one in fields(ours)] == [one.name for one in fields(theirs)]
    assert Point.__match_args__ == Reference.__match_args__
    for again in (copy.copy(ours), copy.deepcopy(ours), pickle.loads(pickle.dumps(ours)), given(Point)):
        assert again == ours
        assert asdict(again) == asdict(ours)
    assert asdict(replace(ours, y=3.0)) == asdict(replace(theirs, y=3.0))


def test_each_gets_a_mutable_value_of_its_own() -> None:
    one, other = Point(1), Point(1)
    assert one.names is not other.names
    assert one.counted is not other.counted


def test_equality_and_hash_are_by_fields_and_class() -> None:
    assert Named(a=1) == Named(a=1, b=2)
    assert hash(Named(a=1)) == hash(Named(a=1, b=2))
    assert Named(a=1) != Named(a=2)
    assert Further(1) != Point(1)
    assert Point(1) == Point(1, ignored=0)
    assert Point(1) != Point(1, hidden=0)
    assert Nothing() == Nothing()
    assert hash(Nothing()) == hash(Nothing())
    assert Itself([1]) != Itself([1])
    assert isinstance(hash(Itself([1])), int)
    with pytest.raises(TypeError):
        hash(Point(1))
    assert (repr(Own(1)), Own(1) == Own(2), hash(Own(1))) == ("mine", True, 7)


def test_nothing_is_set_or_deleted() -> None:
    point: Any = Further(1, z=2.0)
    assert repr(point).endswith("z=2.0)")
    assert not hasattr(point, "__dict__")
    with pytest.raises(FrozenInstanceError, match="'y'"):
        point.y = 2.0
    with pytest.raises(FrozenInstanceError, match="'y'"):
        del point.y
    with pytest.raises(FrozenInstanceError):
        point.unknown = 2.0


def test_what_is_missing_or_unknown_is_refused() -> None:
    made: tuple[Any, ...] = (Point, Named)
    for make, arguments, names in (
        (made[0], (), {}),
        (made[0], (1,), {"w": 2}),
        (made[0], (1,), {"length": 2.0}),
        (made[1], (1, 2), {}),
        (made[1], (), {"b": 1}),
    ):
        with pytest.raises(TypeError, match="argument"):
            make(*arguments, **names)
