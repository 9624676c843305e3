"""Large scenario texts are loaded or refused: within ten seconds of processor time and a gigabyte."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from cli_process import environment
from large_decks import LARGE, large_deck

from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load_text
from dismech_cli.scenario.text.tree import MAX_BYTES, MAX_NODES

LOAD = """
import resource, sys
from pathlib import Path
from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.load import load
resource.setrlimit(resource.RLIMIT_CPU, (int(sys.argv[2]), int(sys.argv[2])))
resource.setrlimit(resource.RLIMIT_DATA, (10**9, 10**9))
try:
    load(sys.argv[1])
    print("loaded")
except ScenarioError as error:
    print(error)
"""


@pytest.mark.parametrize(
    ("format", "text"),
    [("yaml", "forces: [" + "1," * MAX_NODES + "1]"), ("toml", "forces = [" + "1," * MAX_NODES + "1]")],
)
def test_more_values_than_are_read_soon_are_refused(format: str, text: str) -> None:
    with pytest.raises(ScenarioError, match="more than 100000 values: give long curves and tables as CSV"):
        load_text(text, format=format)  # type: ignore[arg-type]


@pytest.mark.parametrize("format", ["yaml", "toml"])
def test_long_texts_are_refused_from_python_too(format: str) -> None:
    with pytest.raises(ScenarioError, match="<text>: larger than 4 MB, the limit for a scenario"):
        load_text("#" * (MAX_BYTES + 1), format=format)  # type: ignore[arg-type]


@pytest.mark.parametrize("key", ["a" + ".a" * 100_000, "a" + " . 'a'" * 100_000])
def test_a_key_of_many_parts_is_too_deep(key: str) -> None:
    with pytest.raises(ScenarioError, match=r"<text>:2:1: nested deeper than 64 levels"):
        load_text(f"x = 1\n{key} = 1\n", format="toml")


def test_of_many_faults_the_first_are_told_and_all_are_counted() -> None:
    text = large_deck("yaml", "keys", 40_000)
    with pytest.raises(ScenarioError) as caught:
        load_text(text)
    lines = str(caught.value).splitlines()
    assert lines[0].startswith("<text>:8:1: key0: unknown key")
    assert lines[-1] == f"... and {text.count('key') - 25} more"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited by the system")
@pytest.mark.parametrize(("format", "name"), LARGE)
def test_a_text_as_large_as_may_be_is_loaded_or_refused_soon(tmp_path: Path, format: str, name: str) -> None:
    text = large_deck(format, name, MAX_BYTES)
    assert 0.99 * MAX_BYTES < len(text) <= MAX_BYTES
    file = tmp_path / f"large.{format}"
    file.write_text(text)
    command = [sys.executable, "-c", LOAD, str(file), "12"]  # two seconds for the imports
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(("loaded", f"{file}:"))


CHECK = """\
import resource, sys
from dismech_cli.session.inspect import inspect
from pathlib import Path
resource.setrlimit(resource.RLIMIT_CPU, (int(sys.argv[2]), int(sys.argv[2])))
print(inspect(Path(sys.argv[1]), overrides=(), profile=None, allow_outside=False))
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="processor time is limited by the system")
def test_a_rod_of_a_million_nodes_is_checked_soon(tmp_path: Path) -> None:
    file = tmp_path / "long.yaml"
    file.write_text(
        "schema_version: 1\nname: long\n"
        "materials: {rubber: {youngs_modulus: 1 MPa, poisson_ratio: 0.5, density: 1000}}\n"
        "geometry: [{type: rod, name: rope, material: rubber, radius: 1 mm, generate: "
        "{shape: line, from: [0, 0, 0], to: [10000, 0, 0], nodes: 1000000}}]\n"
        "numerics: {dt: 1 ms, t_end: 10 ms}\n"
    )
    # four to five seconds alone, three times as many where others wait for the memory too
    command = [sys.executable, "-c", CHECK, str(file), "20"]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "3000000 free of 3000000 DOFs" in done.stdout
