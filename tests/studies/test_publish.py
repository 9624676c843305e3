"""Points that appear whole or not at all, and folders told from those of the dead."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from dismech_cli.errors import OutputError
from dismech_cli.studies.sweep.publish import (
    Owner,
    Work,
    begin,
    discard,
    in_work,
    is_done,
    others_at,
    publish,
    remove_dead,
    withdraw,
)

ID = "0123456789abcdef"


@pytest.fixture
def points(tmp_path: Path) -> Path:
    (tmp_path / "points").mkdir()
    return tmp_path / "points"


def made(points: Path, text: str, owner: Owner | None = None) -> Work:
    """A finished point, not published."""
    work = begin(points, ID)
    work.folder.mkdir()
    (work.folder / "result.json").write_text(text)
    if owner is not None:
        (work.hidden / "owner.json").write_text(json.dumps(asdict(owner)))
    return work


def dead() -> Owner:
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return replace(Owner.this(), pid=process.pid)


def test_the_first_wins_and_the_second_throws_its_work_away(points):
    first, second = made(points, "first"), made(points, "second")
    assert not is_done(points, ID)
    assert publish(second)
    assert not publish(first)
    assert (points / ID / "result.json").read_text() == "second"
    assert [entry.name for entry in points.iterdir()] == [ID]


def test_what_stands_in_the_way_is_no_result(points):
    (points / ID).mkdir()
    (points / ID / "thesis.tex").write_text("")
    with pytest.raises(OutputError, match=ID):
        publish(made(points, "{}"))


def test_a_folder_of_points_that_is_not_there_is_not_made(tmp_path):
    """A worker that does not see the folder of a sweep would else fill one of its own."""
    with pytest.raises(OutputError, match="does not exist"):
        begin(tmp_path / "elsewhere" / "points", ID)


def test_folders_of_the_dead_are_removed_and_no_others(points):
    mine, theirs, abroad = made(points, "a"), made(points, "b", dead()), made(points, "c")
    other = replace(Owner.this(), host="elsewhere")
    (abroad.hidden / "owner.json").write_text(json.dumps(asdict(other)))
    begun = made(points, "d")
    (begun.hidden / "owner.json").unlink()
    (points / ".thesis").mkdir()
    assert remove_dead(points) == 1
    assert not theirs.hidden.exists()
    assert {work.hidden for work in in_work(points)} == {mine.hidden, abroad.hidden, begun.hidden}
    # who has not said for a minute who it is was killed before it could
    for path in (begun.hidden, *begun.hidden.rglob("*")):
        os.utime(path, (0, 0))
    for path in (abroad.hidden, *abroad.hidden.rglob("*")):
        os.utime(path, (0, 0))
    assert remove_dead(points) == 2
    assert (points / ".thesis").is_dir()


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not tell when a process started")
def test_a_later_process_of_the_same_number_is_another():
    assert not Owner.this().is_dead
    assert replace(Owner.this(), started="1").is_dead


def test_others_are_those_alive_here(points):
    made(points, "a")
    assert others_at(points, frozenset()) == {ID}
    assert others_at(points, frozenset({ID})) == set()
    for work in in_work(points):
        discard(work)
    made(points, "b", dead())
    assert others_at(points, frozenset()) == set()


def test_a_withdrawn_point_can_be_made_again(points):
    publish(made(points, "bad"))
    withdraw(points, ID)
    assert not is_done(points, ID)
    assert list(points.iterdir()) == []
    withdraw(points, ID)
    assert publish(made(points, "good"))
