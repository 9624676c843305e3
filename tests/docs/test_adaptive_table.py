"""The table of adaptive steps in docs/trade.md is the one that its command writes."""

from __future__ import annotations

from benchmarks.adaptive import BEGIN, END, PAGE, SCENES, read, told


def test_the_table_is_what_was_measured() -> None:
    measured = read()
    assert {name.partition(":")[0] for name in measured} == set(SCENES)
    text = PAGE.read_text(encoding="utf-8")
    assert text.split(BEGIN)[1].split(END)[0].strip() == told(measured)


def test_adaptive_steps_keep_their_bar_on_swings_and_the_twitch() -> None:
    """Within a tenth at the default tolerance: the iterations of fixed steps are interpolated."""
    for name, runs in read().items():
        scene = SCENES[name.partition(":")[0]]
        (default,) = [one for one in runs if one.rtol == 1e-3]
        assert default.ratio <= 1.1 * scene.bar, name
