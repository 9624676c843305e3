"""The table of adaptive steps in docs/trade.md is the one that its command writes."""

from __future__ import annotations

from benchmarks.adaptive import BEGIN, END, PAGE, SCENES, read, told


def test_the_table_is_what_was_measured() -> None:
    measured = read()
    assert {name.partition(":")[0] for name in measured} == set(SCENES)
    text = PAGE.read_text(encoding="utf-8")
    assert text.split(BEGIN)[1].split(END)[0].strip() == told(measured)


def test_the_default_integrator_keeps_the_bars_at_the_default_tolerance() -> None:
    measured = read()
    for name, scene in SCENES.items():
        (default,) = [one for one in measured[f"{name}:tr_bdf2"] if one.rtol == 1e-3]
        assert default.ratio <= scene.bar, name
