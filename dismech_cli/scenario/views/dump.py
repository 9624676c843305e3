"""A scenario written back: complete, in SI units, and readable to the same scenario."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import yaml

from ..language.scenario import Scenario
from ..text.parameters import Parameter
from ..text.substitution import PROSE
from ..text.yaml_text import SCALARS
from .walk import leaves

_LOADER_KEYS = ("include", "profiles", "parameters", "sweep")


class _Dumper(yaml.SafeDumper):
    """Quotes what YAML 1.2 would not read as text, and no more."""

    yaml_implicit_resolvers: dict[Any, Any] = {}  # noqa: RUF012  PyYAML's own protocol

    def ignore_aliases(self, data: Any) -> bool:
        return True


for _tag, _pattern in SCALARS:
    _Dumper.add_implicit_resolver(_tag, _pattern, None)


def resolved(scenario: Scenario) -> dict[str, Any]:
    """The scenario as plain data, defaults filled in, keys that are not set left out."""
    data = scenario.model_dump(mode="json", by_alias=True, exclude_none=True)
    unused = _LOADER_KEYS if scenario.dimension == 2 else (*_LOADER_KEYS, "plane")
    return {key: value for key, value in data.items() if key not in unused}


def dump_resolved(
    scenario: Scenario,
    renamed: Mapping[str, str] | None = None,
    parameters: Mapping[str, Parameter] = MappingProxyType({}),
) -> str:
    """YAML text that loads again to an equal scenario.

    Args:
        scenario: What to write.
        renamed: New names of files by the names in ``scenario``, for a copy in another folder.
        parameters: Told in comments: the values are those that follow from them.
    """
    data = resolved(scenario)
    if renamed:
        _rename_files(scenario, data, renamed)
    text: str = yaml.dump(
        _dollars_doubled(data),
        Dumper=_Dumper,
        sort_keys=False,
        allow_unicode=True,
        default_flow_style=None,
        width=110,
    )
    head = (f"# parameter {name} = {one.amount}, {one.origin}\n" for name, one in parameters.items())
    return "".join([*map(_printable, head), text])


def _printable(line: str) -> str:
    """A comment that stays one line, whatever a file is called."""
    return "".join(letter if letter.isprintable() else "?" for letter in line[:-1]) + "\n"


def _dollars_doubled(data: Any, key: str = "") -> Any:
    """Plain data in which a dollar sign does not begin a parameter."""
    match data:
        case dict():
            return {name.replace("$", "$$"): _dollars_doubled(value, name) for name, value in data.items()}
        case list():
            return [_dollars_doubled(value) for value in data]
        case str() if key not in PROSE:
            return data.replace("$", "$$")
        case _:
            return data


def _rename_files(scenario: Scenario, data: dict[str, Any], renamed: Mapping[str, str]) -> None:
    for leaf in leaves(scenario):
        if leaf.file and leaf.value in renamed and leaf.path[0] not in _LOADER_KEYS:
            place: Any = data
            for part in leaf.path[:-1]:
                place = place[part]
            place[leaf.path[-1]] = renamed[leaf.value]


def text_hash(scenario: Scenario) -> str:
    """SHA-256 of the resolved scenario: the same for every way of writing the same thing."""
    canonical = json.dumps(resolved(scenario), sort_keys=True, ensure_ascii=True, allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()
