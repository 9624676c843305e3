"""Frozen dataclasses at a third of the price: a program makes hundreds of them before it does anything.

``dataclass`` writes and compiles six methods anew for each class, a quarter of a short run. Of these only
``__init__`` is another one for each class; the rest do the same for all.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, Field, FrozenInstanceError, dataclass, field, fields
from operator import attrgetter
from typing import Any, Final, NoReturn, TypeVar, dataclass_transform, overload

T = TypeVar("T")

# Stands for what a field without a value makes anew.
_ANEW: Final = object()


@overload
def frozen(cls: type[T], /) -> type[T]: ...


@overload
def frozen(*, kw_only: bool = False, eq: bool = True) -> Callable[[type[T]], type[T]]: ...


@dataclass_transform(frozen_default=True, field_specifiers=(Field, field))
def frozen(cls: type[T] | None = None, /, *, kw_only: bool = False, eq: bool = True) -> Any:
    """Make a class what ``dataclass(frozen=True, slots=True)`` makes it.

    Args:
        cls: The class, its fields annotated.
        kw_only: Whether its fields are given by name only.
        eq: Whether two are equal, and hash alike, if their fields do.
    """

    def make(cls: type[T]) -> type[T]:
        made = dataclass(init=False, repr=False, eq=False, slots=True, kw_only=kw_only)(cls)
        methods = {"__init__": _initializer(made), **_SHARED, **(_comparison(made) if eq else {})}
        for name, method in methods.items():
            if name not in vars(cls):
                setattr(made, name, method)
        return made

    return make if cls is None else make(cls)


def _initializer(cls: type[Any]) -> Callable[..., None]:
    """``__init__`` of a class; the names of its fields are all that is its own."""
    around: dict[str, Any] = {"_put": object.__setattr__, "_ANEW": _ANEW}
    given, by_name, lines = ["self"], ["*"], ["pass"]
    for one in fields(cls):
        name, preset = one.name, f"_default_{one.name}"
        anew = one.default_factory is not MISSING
        around[preset] = one.default_factory if anew else one.default
        value = f"{preset}()" if anew else preset
        if one.init:
            optional = anew or one.default is not MISSING
            parameter = f"{name}={'_ANEW' if anew else preset}" if optional else name
            (by_name if one.kw_only else given).append(parameter)
            value = f"{value} if {name} is _ANEW else {name}" if anew else name
        if one.init or around[preset] is not MISSING:
            lines.append(f"_put(self, {name!r}, {value})")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    parameters = ", ".join(given + by_name if by_name[1:] else given)
    made: dict[str, Any] = {}
    exec(f"def __init__({parameters}):\n " + "\n ".join(lines), around, made)
    initializer: Callable[..., None] = made["__init__"]
    return initializer


def _comparison(cls: type[Any]) -> dict[str, Callable[..., Any]]:
    """``__eq__`` and ``__hash__`` of a class, by the values of its fields."""
    names = [one.name for one in fields(cls) if one.compare]
    values: Callable[[Any], Any] = attrgetter(*names) if names else lambda _: ()

    def equal(self: Any, other: Any) -> Any:
        return values(self) == values(other) if type(self) is type(other) else NotImplemented

    def hashed(self: Any) -> int:
        return hash(values(self))

    return {"__eq__": equal, "__hash__": hashed}


def _repr(self: Any) -> str:
    shown = ", ".join(f"{one.name}={getattr(self, one.name)!r}" for one in fields(self) if one.repr)
    return f"{type(self).__qualname__}({shown})"


def _setattr(self: Any, name: str, value: Any) -> NoReturn:
    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _delattr(self: Any, name: str) -> NoReturn:
    raise FrozenInstanceError(f"cannot delete field {name!r}")


def _getstate(self: Any) -> list[Any]:
    return [getattr(self, one.name) for one in fields(self)]


def _setstate(self: Any, state: list[Any]) -> None:
    for one, value in zip(fields(self), state, strict=True):
        object.__setattr__(self, one.name, value)


_SHARED: Final = {
    "__repr__": _repr,
    "__setattr__": _setattr,
    "__delattr__": _delattr,
    "__getstate__": _getstate,
    "__setstate__": _setstate,
}
