"""The page of published benchmarks: made of what was run, and of what the scenarios promise now."""

from __future__ import annotations

import pytest
from numpy.testing import assert_allclose

from benchmarks.published.benchmarks import BENCHMARKS
from benchmarks.published.page import PAGE, page, read
from benchmarks.published.promises import Promises
from benchmarks.published.row import SCENARIOS, Row, RunError
from benchmarks.published.thresholds import Threshold
from dismech_cli import load

CASES = [case for benchmark in BENCHMARKS.values() for case in benchmark.cases]
PROMISES = [case for case in CASES if isinstance(case, Promises)]
KEPT = {name: [Row(**row) for row in one["rows"]] for name, one in read().items()}


def test_the_page_is_what_was_kept() -> None:
    assert set(KEPT) == set(BENCHMARKS)
    assert PAGE.read_text(encoding="utf-8") == page(read())
    assert all(row.met for rows in KEPT.values() for row in rows)


@pytest.mark.parametrize("case", PROMISES, ids=lambda case: " ".join((case.file, *case.changes)))
def test_published_values_are_those_of_the_scenario(case: Promises) -> None:
    """A value, tolerance or source that is changed in a scenario is to be run and written anew."""
    expected = load(SCENARIOS / f"{case.file}.yaml", overrides=case.changes).scenario.expect
    names = case.only or tuple(expected)
    rows = {row.quantity: row for rows in KEPT.values() for row in rows if row.command == case.command}
    assert set(rows) == set(names)
    for name in names:
        e, row = expected[name], rows[name]
        assert row.published == e.value
        assert row.source == e.source or e.source == "as above"
        assert e.tolerance.allows(row.here, e.value)


@pytest.mark.parametrize("name", ["elastica", "ring"])
def test_the_command_gives_the_kept_numbers(name: str) -> None:
    (case,) = BENCHMARKS[name].cases
    rows = case.rows()
    assert [row.quantity for row in rows] == [row.quantity for row in KEPT[name]]
    assert_allclose([row.here for row in rows], [row.here for row in KEPT[name]], rtol=1e-6)


def test_a_missing_expectation_and_a_load_out_of_reach_are_told() -> None:
    with pytest.raises(RunError, match="does not expect lowest"):
        Promises("verification/elastica", ("lowest",)).rows()
    (ring,) = BENCHMARKS["ring"].cases
    assert isinstance(ring, Threshold)
    too_high = Threshold(
        file=ring.file,
        loaded=ring.loaded,
        quantity=ring.quantity,
        value=1.2 * ring.value,
        tolerance=ring.tolerance,
        source=ring.source,
    )
    with pytest.raises(RunError, match="stability is not lost between"):
        too_high.rows()
