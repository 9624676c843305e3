"""Settings that the guides name are those of the language."""

from __future__ import annotations

import re

import pytest
import yaml
from cli_process import ROOT

from dismech_cli import load, load_text

ARM = ROOT / "docs" / "tuning" / "held_nowhere.yaml"
PAGES = ("docs/choosing.md", "docs/failed.md")
SETTING = re.compile(r"`((?:numerics|imperfection|materials|contact)[\w.\[\]]*=[^`]+)`")
SECTION = re.compile(r"`(numerics: [^`]+)`")


def found(pattern: re.Pattern[str]) -> list[str]:
    return sorted(
        {text for page in PAGES for text in pattern.findall((ROOT / page).read_text(encoding="utf-8"))}
    )


@pytest.mark.parametrize("setting", found(SETTING))
def test_a_setting_is_taken(setting: str):
    assert load(ARM, overrides=[setting]).scenario.name == "held_nowhere"


@pytest.mark.parametrize("section", found(SECTION))
def test_a_section_is_taken(section: str):
    deck = yaml.safe_load((ROOT / "docs" / "tuning" / "arm.yaml").read_text(encoding="utf-8"))
    text = yaml.safe_dump(deck | {"name": "arm"} | yaml.safe_load(section))
    assert load_text(text).scenario.numerics is not None


def test_there_are_settings():
    assert len(found(SETTING)) >= 4
    assert len(found(SECTION)) >= 2
