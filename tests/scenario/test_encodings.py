"""Scenarios and tables as other systems and programs write their text."""

from pathlib import Path

import pytest
from numpy.testing import assert_array_equal
from scenario_folder import SCENE, TOML, Folder, folder

from dismech_cli.csv_columns import read_columns
from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load

__all__ = ["folder"]

POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:" + b"ab" * 32 + b"\nsize 4711\n"


@pytest.mark.parametrize(("name", "text"), [("scene.yaml", SCENE), ("scene.toml", TOML)])
@pytest.mark.parametrize("end", ["\r", "\r\n"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_encodings_and_line_ends(folder: Folder, name: str, text: str, end: str, encoding: str) -> None:
    Path(name).write_bytes(text.replace("\n", end).encode(encoding))
    loaded = load(name)
    Path(name).write_bytes(text.encode())
    plain = load(name)
    assert loaded.text_hash == plain.text_hash
    assert loaded.locate("geometry[0].radius") == plain.locate("geometry[0].radius")


def test_files_that_were_not_fetched_are_told(tmp_path: Path) -> None:
    for name in ("scene.yaml", "t.csv"):
        (tmp_path / name).write_bytes(POINTER)
    with pytest.raises(ScenarioError, match=r"scene\.yaml:1: a Git LFS pointer .* 'git lfs pull'"):
        load(tmp_path / "scene.yaml")
    with pytest.raises(ScenarioError, match=r"t\.csv:1: a Git LFS pointer .* 'git lfs pull'"):
        read_columns(tmp_path / "t.csv", (0,))


@pytest.mark.parametrize(
    "text",
    [
        "0.5,1\n2,-3e1\n",
        "0.5 1\n2   -3e1\n",
        "  0.5 1\n  2 -3e1\n",
        "0.5;1\n2;-3e1\n",
        "0,5;1\n2;-3e1\n",
        "0,5\t1\n2\t-3e1\n",
        "x y\n0.5 1\n2 -3e1\n",
        "x; y\n0,5; 1\n2; -3e1\n",
        "0.5,1\r2,-3e1\r",
        "# made by a machine\n\n0.5,1\n2,-3e1",
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_what_parts_the_cells_is_seen(tmp_path: Path, text: str, encoding: str) -> None:
    (tmp_path / "a.csv").write_bytes(text.encode(encoding))
    x, y = read_columns(tmp_path / "a.csv", (0, 1))
    assert_array_equal(x, [0.5, 2.0])
    assert_array_equal(y, [1.0, -30.0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("# note\n\n1 2\n3 x\n", r"a\.csv:4: column 1: expected a finite number, got 'x' .*parted by blanks"),
        ("1;2\n3;4,5,6\n", r"a\.csv:2: column 1: .* got '4,5,6' .*parted by semicolons"),
        ("1 2\n3 1_0\n", r"a\.csv:2: column 1: .* got '1_0'"),
        ("1:2\n3:4\n5:6\n", r"a\.csv:1: has no column 1: there are 1, .* parted by blanks"),
    ],
)
def test_messages_name_what_parts_the_cells(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(ScenarioError, match=message):
        read_columns(tmp_path / "a.csv", (0, 1))
