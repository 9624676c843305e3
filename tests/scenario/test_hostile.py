"""Texts and files that are broken or meant to harm: refused at once, with a place."""

from __future__ import annotations

import os
from pathlib import Path
from time import perf_counter

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scenario_folder import SCENE, Folder, folder

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load
from dismech_cli.scenario.text.toml_text import parse_toml
from dismech_cli.scenario.text.tree import Source
from dismech_cli.scenario.text.yaml_text import parse_yaml

__all__ = ["folder"]


def _yaml_error(text: str) -> str:
    with pytest.raises(ScenarioError) as error:
        parse_yaml(Source("s.yaml", text))
    return str(error.value)


def _toml_error(text: str) -> str:
    with pytest.raises(ScenarioError) as error:
        parse_toml(Source("s.toml", text))
    return str(error.value)


def test_alias_bomb_is_counted_not_expanded() -> None:
    levels = [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 10)]
    start = perf_counter()
    message = _yaml_error("\n".join(["a0: &a0 [1, 1]", *levels]))
    assert (
        "more than 100000 values: give long curves and tables as CSV files, once aliases are expanded"
        in message
    )
    assert perf_counter() - start < 2.0


def test_chain_of_aliases_counts_as_depth() -> None:
    chain = "\n".join(["a0: &a0 [1]", *(f"a{i}: &a{i} [*a{i - 1}]" for i in range(1, 2000))])
    assert "nested deeper than 64 levels once aliases are expanded" in _yaml_error(chain)


def test_plain_aliases_work() -> None:
    assert parse_yaml(Source("s", "a: &x {b: 1}\nc: *x")).plain() == {"a": {"b": 1}, "c": {"b": 1}}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: &a [*a]", "s.yaml:1:4: an alias refers to the value that contains it"),
        ("a: " + "[" * 100_000, "s.yaml:1:67: nested deeper than 64 levels"),
        ("a: 1\nb: 2\na: 3", "s.yaml:3:1: key 'a' appears twice, first on line 1"),
        ("a:\n\tb: 1", "s.yaml:2:1: a tab cannot indent YAML; use blanks"),
        ("a: !!python/object/apply:os.system [ls]", "s.yaml:1:4: tags such as tag:yaml.org,2002:python"),
        ("a: .nan", "s.yaml:1:4: a: expected a finite number, got .nan"),
        ("a: -.inf", "s.yaml:1:4: a: expected a finite number, got -.inf"),
        ("a: 1e999", "s.yaml:1:4: a: expected a finite number, got 1e999"),
        ("a: 99999999999999999999", "s.yaml:1:4: a: integer too large, got 99999999999999999999"),
        ("a: " + "9" * 5000, "s.yaml:1:4: a: integer too large, got 999999999999999999999999..."),
        ("<<: {a: 1}", "s.yaml:1:1: merge keys (<<) are not part of YAML 1.2; use include"),
        ("[1]: 2", "s.yaml:1:1: a key must be plain text"),
        ("a: 1\n---\nb: 2", "s.yaml:2:1: not valid YAML: but found another document"),
        ("a: [1, 2", "s.yaml:1:9: not valid YAML: expected ',' or ']'"),
        ("a: *x", "s.yaml:1:4: not valid YAML: found undefined alias 'x'"),
        ("a: 1\nb: \x07", "s.yaml:2:1: not a readable YAML text"),
        ('a: "\\UFFFFFFFF"', "s.yaml:1:1: not a readable YAML text"),
        ("", "s.yaml:1:1: the text is empty"),
        ("# nothing\n", "s.yaml:1:1: the text is empty"),
    ],
)
def test_hostile_yaml(text: str, message: str) -> None:
    assert message in _yaml_error(text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a = 1\na = 2", "not valid TOML: Cannot overwrite a value"),
        ("a = nan", "s.toml:1:5: a: expected a finite number, got nan"),
        ("b = 1\n[t]\na = [1, inf]", "s.toml:3:9: t.a[1]: expected a finite number, got inf"),
        ("a = 1979-05-27", "s.toml:1:5: a: dates and times of day have no meaning here"),
        ("a = " + "[" * 100 + "]" * 100, "nested deeper than 64 levels"),
        ("a = " + "[" * 20_000 + "]" * 20_000, "nested deeper than 64 levels"),
        ("a." * 100 + "b = 1", "nested deeper than 64 levels"),
        ("a = 99999999999999999999", "s.toml:1:5: a: integer too large"),
        ("a = [1", "not valid TOML"),
    ],
)
def test_hostile_toml(text: str, message: str) -> None:
    assert message in _toml_error(text)


def test_all_faults_of_a_text_are_told_at_once() -> None:
    message = _yaml_error("a: 1\na: 2\nb: .nan\nb: 3\n")
    assert [line for line in message.splitlines() if line.startswith("s.yaml")] == [
        "s.yaml:2:1: key 'a' appears twice, first on line 1",
        "s.yaml:3:4: b: expected a finite number, got .nan",
        "s.yaml:4:1: key 'b' appears twice, first on line 3",
    ]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2e6", 2e6),
        ("2e-3", 2e-3),
        ("1.", 1.0),
        (".5", 0.5),
        ("+1", 1),
        ("010", 10),
        ("0o10", 8),
        ("0x10", 16),
        ("no", "no"),
        ("on", "on"),
        ("y", "y"),
        ("1:30", "1:30"),
        ("1_000", "1_000"),
        ("0b1", "0b1"),
        ("2024-01-01", "2024-01-01"),
        ("true", True),
        ("False", False),
        ("~", None),
        ("", None),
        ("'1'", "1"),
        ("=", "="),
    ],
)
def test_scalars_are_those_of_yaml_1_2(text: str, value: object) -> None:
    read = parse_yaml(Source("s", f"a: {text}")).plain()["a"]
    assert read == value
    assert type(read) is type(value)


@given(st.text(max_size=200))
def test_any_yaml_text_is_a_tree_or_a_scenario_error(text: str) -> None:
    try:
        node = parse_yaml(Source("s", text))
    except ScenarioError:
        return
    assert node.mark.line >= 1


_KEYS = st.from_regex(r"[a-z_]{1,4}|\"[^\"\\\x00-\x1f\x7f]{0,3}\"", fullmatch=True)
_VALUES = st.recursive(
    st.sampled_from(["1", "2.5", "true", '"a#,]}"', "'x'", '"""\nm "" ]"""', "'''\n}'''", "0xff"]),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda items: f"[ {' , '.join(items)} ]"),
        st.lists(inner, min_size=1, max_size=3).map(lambda items: "[\n" + ", # ]\n".join(items) + ",\n]"),
        st.tuples(_KEYS, inner).map(lambda pair: f"{{ {pair[0]} = {pair[1]} }}"),
    ),
    max_leaves=6,
)
_LINES = st.one_of(
    st.tuples(_KEYS, _VALUES).map(lambda pair: f"{pair[0]} = {pair[1]} # end"),
    st.tuples(_KEYS, _KEYS, _VALUES).map(lambda t: f"{t[0]} . {t[1]} = {t[2]}"),
    _KEYS.map(lambda key: f"[ {key} ]"),
    st.tuples(_KEYS, _KEYS).map(lambda pair: f"[[{pair[0]}.{pair[1]}]]"),
    _KEYS.map(lambda key: f"[[{key}]]"),
)


@given(st.lists(_LINES, max_size=8))
def test_any_toml_text_is_a_tree_with_places_or_a_scenario_error(lines: list[str]) -> None:
    text = "\n".join(lines)
    try:
        tree = parse_toml(Source("s", text))
    except ScenarioError:
        return
    stack = [tree]
    while stack:
        node = stack.pop()
        line = text.split("\n")[node.mark.line - 1]
        assert 1 <= node.mark.column <= max(len(line), 1)
        if isinstance(node.value, tuple):
            stack += node.value
        elif isinstance(node.value, dict):
            stack += node.value.values()
        elif node.value is True:
            assert line[node.mark.column - 1 :].startswith("true")
        elif node.value == "x":
            assert line[node.mark.column - 1 :].startswith("'x'")


def test_huge_file(folder: Folder) -> None:
    folder.write("big.yaml", "a: 1\n" + "#" * (8 * 1024 * 1024))
    with pytest.raises(ScenarioError, match=r"big\.yaml: larger than 4 MB"):
        load("big.yaml")


def test_binary_file(folder: Folder) -> None:
    (folder.path / "a.yaml").write_bytes(b"a: 1\n\xff\xfe")
    with pytest.raises(ScenarioError, match=r"a\.yaml:2: not a text file in UTF-8"):
        load("a.yaml")
    (folder.path / "b.yaml").write_bytes(b"a: 1\n\0")
    with pytest.raises(ScenarioError, match=r"b\.yaml:2: not a text file"):
        load("b.yaml")


def test_fifo_device_folder_and_missing_file(folder: Folder) -> None:
    os.mkfifo(folder.path / "pipe.yaml")
    with pytest.raises(ScenarioError, match=r"pipe\.yaml: not a regular file"):
        load("pipe.yaml")
    with pytest.raises(ScenarioError, match="/dev/zero: not a regular file"):
        load("/dev/zero")
    with pytest.raises(ScenarioError, match=r"none\.yaml: cannot read: no such file"):
        load("none.yaml")
    with pytest.raises(ScenarioError, match=r"cannot read|not a regular file"):
        load(folder.path)


def test_suffix(folder: Folder) -> None:
    folder.write("scene.json", "{}")
    with pytest.raises(ScenarioError, match=r"ends in \.yaml, \.yml or \.toml, not '\.json'"):
        load("scene.json")


def test_byte_order_mark_is_no_part_of_the_text(folder: Folder) -> None:
    folder.write("scene.yaml", "\ufeff" + SCENE)
    assert load("scene.yaml").scenario.name == "cantilever"


@pytest.mark.parametrize("name", ["../evil", "a/b", "..", ".hidden", "", "a\\b", "x" * 200, "a\n", "end."])
def test_name_must_be_safe(folder: Folder, name: str) -> None:
    with pytest.raises(ScenarioError, match="not a usable name"):
        folder.load(SCENE.replace("name: cantilever", f"name: {name!r}"))


MESH = SCENE.replace(
    "generate: {shape: line, from: [0, 0, 0], to: [100 mm, 0, 0], nodes: 11}", "mesh: {file: FILE}"
)


def test_paths_stay_in_the_tree(folder: Folder, tmp_path: Path) -> None:
    outside = tmp_path.parent / "outside.msh"
    outside.write_text("x")
    (tmp_path / "link.msh").symlink_to(outside)
    for file in ("../outside.msh", str(outside), "link.msh"):
        with pytest.raises(ScenarioError, match="lies outside the folder of the scenario"):
            folder.load(MESH.replace("FILE", file))
        assert load("scene.yaml", allow_outside=True).scenario.name == "cantilever"
    os.mkfifo(tmp_path / "pipe.msh")
    with pytest.raises(ScenarioError, match=r"geometry\[0\]\.mesh\.file: 'pipe\.msh' is not a regular file"):
        folder.load(MESH.replace("FILE", "pipe.msh"))
    with pytest.raises(ScenarioError, match=r"cannot open 'none\.msh': no such file"):
        folder.load(MESH.replace("FILE", "none.msh"))
    with pytest.raises(ScenarioError, match=r"include: '\.\./outside\.msh' lies outside"):
        folder.load(SCENE + "include: [../outside.msh]\n")


def test_include_cycle(folder: Folder) -> None:
    folder.write("a.yaml", "include: [b.yaml]\n")
    folder.write("b.yaml", "include: [a.yaml]\n")
    with pytest.raises(
        ScenarioError, match=r"b\.yaml:1:11: include: files include each other: a.yaml -> b.yaml"
    ):
        folder.load(SCENE + "include: [a.yaml]\n")


def test_include_fan_is_bounded(folder: Folder) -> None:
    folder.write("f0.yaml", "description: x\n")
    for i in range(1, 12):
        folder.write(f"f{i}.yaml", f"include: [f{i - 1}.yaml, f{i - 1}.yaml]\n")
    with pytest.raises(ScenarioError, match="more than 100 files included"):
        folder.load(SCENE + "include: [f11.yaml]\n")


def test_a_missing_file_is_looked_for_by_its_name(folder: Folder) -> None:
    folder.write("arm.yaml", "a: 1\n")
    folder.write("arm.csv", "a\n")
    with pytest.raises(ScenarioError, match=r"arm\.yml: cannot read: .*; did you mean 'arm\.yaml'\?"):
        load("arm.yml")
    with pytest.raises(ScenarioError, match=r"other\.toml: cannot read: no such file or directory$"):
        load("other.toml")
