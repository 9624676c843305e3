"""What runs the kernels: chosen by what a run takes, what compiled loops save and whether they are there."""

from __future__ import annotations

from pathlib import Path

import pytest

from dismech_cli.compose import compose as composing
from dismech_cli.compose.compose import compose
from dismech_cli.compose.structure import kernels
from dismech_cli.compose.structure.kernels import alone, among_many
from dismech_cli.compose.structure.plan import Plan
from dismech_cli.scenario.load import load

pytest.importorskip("numba")
SNAKE = Path(__file__).parents[2] / "scenarios" / "snake.yaml"
SHORT, LONG = "numerics.dt=100 ms", "numerics.t_end=200 s"


def _plan(monkeypatch: pytest.MonkeyPatch, missing: int, *overrides: str, repays: kernels.Repays) -> Plan:
    monkeypatch.setattr(kernels, "missing", lambda texts: missing)
    return compose(load(SNAKE, overrides=overrides), repays=repays).plan


@pytest.mark.parametrize(
    ("end", "missing", "chosen"),
    [(SHORT, 0, "numpy"), (SHORT, 5, "numpy"), (LONG, 0, "numba"), (LONG, 500, "numba")],
)
def test_length_decides_where_it_is_clear(
    monkeypatch: pytest.MonkeyPatch, end: str, missing: int, chosen: str
) -> None:
    plan = _plan(monkeypatch, missing, end, repays=alone)
    assert plan.kernels == chosen
    assert plan.compiling == (missing if chosen == "numba" else 0)


def test_in_between_a_warm_cache_decides(monkeypatch: pytest.MonkeyPatch) -> None:
    warm, cold = (_plan(monkeypatch, missing, repays=alone) for missing in (0, 100))
    assert (warm.kernels, cold.kernels) == ("numba", "numpy")
    (told,) = (one for one in cold.decisions if one.what == "kernels by numpy")
    assert "numerics.kernels=numba" in told.why
    (told,) = (one for one in warm.decisions if one.what == "kernels by numba")
    assert told.why.endswith("are compiled")


def test_runs_that_are_compared_choose_without_the_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else the first point of a sweep would end with other last digits than the second."""
    plans = [_plan(monkeypatch, missing, repays=among_many) for missing in (0, 100)]
    assert [plan.kernels for plan in plans] == ["numba", "numba"]
    assert [plan.compiling for plan in plans] == [0, 100]


@pytest.mark.parametrize("asked", ["numpy", "numba"])
def test_what_is_asked_for_is_taken(monkeypatch: pytest.MonkeyPatch, asked: str) -> None:
    plan = _plan(monkeypatch, 100, f"numerics.kernels={asked}", repays=alone)
    assert plan.kernels == asked


def test_rest_shapes_do_not_depend_on_kernels() -> None:
    """A run and its resumption compose the same, whatever chose the kernels."""
    one, two = (compose(load(SNAKE), kernels).simulation for kernels in ("numpy", "numba"))
    assert (one.model.rest == two.model.rest).all()
    for mine, theirs in zip(one.roles.elastic, two.roles.elastic, strict=True):
        assert (mine.natural_at(0.0, one.start.inputs) == theirs.natural_at(0.0, two.start.inputs)).all()
    assert composing.compose is compose


def _rows() -> list[tuple[str, str]]:
    """What `check` says and of which scene, from the table of the documentation."""
    text = (SNAKE.parents[1] / "docs" / "performance.md").read_text(encoding="utf-8")
    table = text.partition("### Steps that are compiled whole")[2].partition("\n| ")[2].partition("\n\n")[0]
    cells = [line.strip("| ").split(" | ") for line in table.splitlines()[2:]]
    return [(said, scene.strip("`")) for _, said, scene in cells]


@pytest.mark.parametrize(("said", "scene"), _rows())
def test_what_is_compiled_whole_is_told(monkeypatch: pytest.MonkeyPatch, said: str, scene: str) -> None:
    monkeypatch.setattr(kernels, "missing", lambda texts: 0)
    path = next(SNAKE.parent.rglob(f"{scene}.yaml"))
    plan = compose(load(path, overrides=["numerics.kernels=numba"])).plan
    (step,) = (one for one in plan.decisions if one.what.startswith("steps "))
    assert (step.what if plan.whole else step.why).startswith(said)
    assert plan.whole == (said == "steps compiled whole")
