"""A decimal comma is told as one, whatever YAML and TOML make of it."""

from typing import Literal

import pytest

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load_text


@pytest.mark.parametrize(
    ("format", "text", "message"),
    [
        ("yaml", "materials: {m: {poisson_ratio: 0,3, density: 1}}", r"1:32: .*poisson_ratio: .* write 0\.3"),
        ("yaml", "materials: {m: {density: 1,5 g/cm^3}}", r"1:26: .*density: .* write 1\.5 g/cm\^3"),
        ("yaml", "materials: {m: {density: -1,2e3}}", r"1:26: .*density: .* write -1\.2e3"),
        ("yaml", "numerics:\n  dt: 1,5 ms", r"2:7: .*dt: '1,5 ms' has a decimal comma; write 1\.5 ms"),
        ("toml", "numerics.t_end = 2,5\n", r"1:18: a comma parts values; write 2\.5"),
        ("toml", "materials.m = {a = 0,3, b = 1}\n", r"1:20: a comma parts values; write 0\.3"),
    ],
)
def test_a_decimal_comma_is_told(format: Literal["yaml", "toml"], text: str, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        load_text(text, format=format)


def test_other_commas_are_left_alone() -> None:
    with pytest.raises(ScenarioError, match=r"1:19: numerics\.b: unknown key"):
        load_text("numerics: {dt: 1, b: 2}")
    with pytest.raises(ScenarioError, match=r"1:19: numerics\.3: unknown key"):
        load_text("numerics: {dt: 1, 3}")
