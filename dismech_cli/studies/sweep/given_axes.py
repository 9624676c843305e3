"""Axes as the command line gives them: ``--over KEY=V1,V2``, ``KEY=FROM:TO:COUNT:log``, ``--range``."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError

from ...errors import ScenarioError
from ...frozen import frozen
from ...scenario.language.sweep import Sweep
from ...scenario.text.problems import ProblemsError
from ...scenario.text.tree import Source
from ...scenario.text.yaml_text import parse_yaml

_SPAN: Final = re.compile(r"(?P<from>[^:]+):(?P<to>[^:]+):(?P<count>\d+)(:(?P<scale>log|linear))?")
_RANGE: Final = re.compile(r"(?P<from>[^:]+):(?P<to>[^:]+)(:(?P<scale>log|linear))?")


@frozen(kw_only=True)
class Given:
    """Options of the command line that say what is varied.

    Attributes:
        over: ``KEY=V1,V2,...`` or ``KEY=FROM:TO:COUNT[:log]``, all combinations.
        zip: ``KEY=V1,V2,...``, gone through side by side.
        csv: A table.
        lhs: Points of a Latin hypercube.
        ranges: ``KEY=FROM:TO[:log]`` of the hypercube.
        seed: Of the hypercube.
    """

    over: Sequence[str] = ()
    zip: Sequence[str] = ()
    csv: Path | None = None
    lhs: int | None = None
    ranges: Sequence[str] = ()
    seed: int | None = None

    def axes(self, directory: Path) -> Sweep | None:
        """What is varied; None if no option says so.

        Args:
            directory: Folder of the scenario, from where the table is named.

        Raises:
            ScenarioError: An option cannot be read, or they do not go together.
        """
        if (self.lhs is None) == bool(self.ranges):
            raise ScenarioError("--lhs N and --range KEY=FROM:TO go together")
        if self.seed is not None and self.lhs is None:
            raise ScenarioError("--seed is the seed of --lhs")
        if not (self.over or self.zip or self.csv or self.lhs is not None):
            return None
        data: dict[str, Any] = {
            "over": _by_key("--over", self.over, _axis, "V1,V2,... or KEY=FROM:TO:COUNT"),
            "zip": _by_key("--zip", self.zip, _listed, "V1,V2,..."),
        }
        if self.csv is not None:
            data["csv"] = os.path.relpath(self.csv.resolve(), directory.resolve())
        if self.lhs is not None:
            sampled = _by_key("--range", self.ranges, _range, "FROM:TO or KEY=FROM:TO:log")
            data["sample"] = {"count": self.lhs, "over": sampled, "seed": self.seed or 0}
        try:
            return Sweep.model_validate(data)
        except ValidationError as error:
            raise ScenarioError("\n".join(_told(detail) for detail in error.errors())) from None


def _told(detail: Mapping[str, Any]) -> str:
    """A fault of the axes, by the option and key that it is about."""
    option, *rest = (str(part) for part in detail["loc"] if part not in ("list", "span"))
    options = {"over": "--over", "zip": "--zip", "csv": "--csv", "sample": "--lhs"}
    key = " ".join(part for part in rest if part != "over")
    return f"{options.get(option, option)} {key}: {detail['msg']}".replace(" :", ":")


def _by_key(option: str, texts: Sequence[str], read: Callable[[str, str], Any], form: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for text in texts:
        key, equals, values = text.partition("=")
        key = key.strip()
        if not equals or not key or not values.strip():
            raise ScenarioError(f"{option} {text!r}: expected KEY={form}")
        if key in found:
            raise ScenarioError(f"{option} {text!r}: {key} is given twice")
        found[key] = read(f"{option} {text!r}", values)
    return found


def _listed(option: str, text: str) -> tuple[Any, ...]:
    try:
        node = parse_yaml(Source(option, f"[{text}]", positions=False))
    except ProblemsError as error:
        raise ScenarioError(f"{option}: {error.problems[0].message}") from None
    values = node.plain()
    if not values or any(value is None for value in values):
        raise ScenarioError(f"{option}: expected values with commas between them")
    return tuple(values)


def _axis(option: str, text: str) -> Any:
    if span := _SPAN.fullmatch(text.strip()):
        return _interval(span) | {"count": int(span["count"])}
    return _listed(option, text)


def _range(option: str, text: str) -> dict[str, Any]:
    interval = _RANGE.fullmatch(text.strip())
    if interval is None:
        raise ScenarioError(f"{option}: expected KEY=FROM:TO or KEY=FROM:TO:log")
    return _interval(interval)


def _interval(match: re.Match[str]) -> dict[str, Any]:
    return {"from": match["from"].strip(), "to": match["to"].strip(), "scale": match["scale"] or "linear"}
