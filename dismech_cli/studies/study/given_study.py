"""A study by options: ``--over KEY=FROM:LEVELS``, ``--quantity PROBE:NORM``, ``--target``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from ...errors import ScenarioError
from ...quantities import QuantityError, parse_quantity
from ...scenario.language.study import Axis, Measured, Study
from ...scenario.text.problems import ProblemsError
from ...scenario.text.tree import Source
from ...scenario.text.yaml_text import parse_yaml
from ...units import KINDS


def given_over(texts: Sequence[str]) -> Mapping[str, Axis] | None:
    """What is tried; None if no option says so.

    Raises:
        ScenarioError: One cannot be read.
    """
    if not texts:
        return None
    data: dict[str, Any] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or not key.strip() or not value.strip():
            raise ScenarioError(f"--over {text!r}: expected KEY=FROM:LEVELS or KEY=A,B")
        data[key.strip()] = _axis(text, value)
    return _read("--over", {"over": data}).over


def given_quantities(texts: Sequence[str]) -> Mapping[str, Measured] | None:
    """Whose errors count; None if no option says so.

    Raises:
        ScenarioError: One cannot be read.
    """
    if not texts:
        return None
    data = {}
    for text in texts:
        probe, _, norm = text.partition(":")
        data[probe.strip()] = {"probe": probe.strip(), "norm": norm.strip() or "max"}
    return _read("--quantity", {"quantities": data}).quantities


def given_target(text: str | None) -> float | None:
    """The largest error allowed, between 0 and 1.

    Raises:
        ScenarioError: It is none.
    """
    if text is None:
        return None
    try:
        share = parse_quantity(text, KINDS["ratio"])
    except QuantityError as error:
        raise ScenarioError(f"--target {text!r}: {error}") from None
    if not 0.0 < share < 1.0:
        raise ScenarioError(f"--target {text!r}: expected a share between 0 and 100 %, such as 1%")
    return share


def given_reference(text: str | None) -> str | None:
    """How errors are known.

    Raises:
        ScenarioError: There is no such way.
    """
    return None if text is None else _read("--reference", {"reference": text}).reference


def _axis(option: str, value: str) -> Any:
    start, colon, levels = value.rpartition(":")
    if colon and levels.strip().isdigit():
        return {"from": _values(option, start)[0], "levels": int(levels)}
    return _values(option, value)


def _values(option: str, text: str) -> list[Any]:
    """Values as YAML reads them."""
    try:
        values = parse_yaml(Source(f"--over {option!r}", f"[{text}]", positions=False)).plain()
    except ProblemsError as error:
        raise ScenarioError(f"--over {option!r}: {error.problems[0].message}") from None
    if not values or any(value is None for value in values):
        raise ScenarioError(f"--over {option!r}: expected a value")
    return list(values)


def _read(option: str, data: dict[str, Any]) -> Study:
    try:
        return Study.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"][1:])
        raise ScenarioError(f"{option} {where}: {first['msg']}") from None
