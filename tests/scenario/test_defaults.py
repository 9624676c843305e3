"""Defaults that nobody compiled are those that a schema makes."""

from __future__ import annotations

from collections.abc import Iterator

from dismech_cli.scenario.language.scenario import Scenario
from dismech_cli.scenario.values.spec import Spec


def classes(of: type[Spec] = Spec) -> Iterator[type[Spec]]:
    for one in of.__subclasses__():
        yield one
        yield from classes(one)


def test_what_nothing_says_is_what_a_schema_makes_of_nothing():
    assert Scenario
    found = 0
    for one in set(classes()):
        for name, field in one.model_fields.items():
            default = field.default
            if isinstance(default, Spec):
                said = {key: getattr(default, key) for key in default.model_fields_set}
                made = type(default)(**said)
                assert made == default, (one.__name__, name)
                assert made.model_dump() == default.model_dump(), (one.__name__, name)
                found += 1
    assert found > 10
