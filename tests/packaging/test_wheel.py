"""What a wheel holds, and that shipped scenes run from an installed one."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path
from zipfile import ZipFile

import pytest
import yaml

import dismech_cli

ROOT = Path(__file__).resolve().parents[2]


def call(*words: object, folder: Path) -> str:
    alone = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        [*map(str, words)], cwd=folder, env=alone, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """The wheel made of the source distribution, without a network."""
    folder = tmp_path_factory.mktemp("dist")
    call(sys.executable, "-m", "build", "--no-isolation", "-o", folder, ROOT, folder=folder)
    (file,) = folder.glob("*.whl")
    assert len(list(folder.glob("*.tar.gz"))) == 1
    return file


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory) -> Path:
    """The program of a wheel in an environment of its own, which borrows the libraries of this one."""
    folder = tmp_path_factory.mktemp("fresh")
    call(sys.executable, "-m", "venv", folder, folder=folder)
    (site,) = folder.glob("lib/python*/site-packages")
    (site / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")
    call(folder / "bin/pip", "install", "--no-deps", "--no-index", wheel, folder=folder)
    return folder / "bin" / "dismech"


@pytest.mark.slow
def test_the_wheel_holds_scenes_with_what_they_name_and_meshes(wheel: Path):
    held = set(ZipFile(wheel).namelist())
    for file in [*(ROOT / "scenarios").rglob("*.*"), *(ROOT / "meshes").glob("*.*")]:
        if "__pycache__" in file.parts:
            continue
        if file.is_relative_to(ROOT / "meshes"):
            name = f"meshes/simple/{file.name}"
        else:
            name = str(file.relative_to(ROOT / "scenarios"))
        assert f"dismech_cli/examples/{name}" in held
    assert not [name for name in held if "__pycache__" in name or name.startswith(("tests", "benchmarks"))]


@pytest.mark.slow
def test_shipped_scenes_run_from_an_installed_wheel(installed: Path, tmp_path: Path):
    asked = "import dismech_cli; print(dismech_cli.__file__)"
    where = call(installed.parent / "python", "-c", asked, folder=tmp_path)
    assert Path(where.strip()).is_relative_to(installed.parents[1])
    made = call(installed, "init", "parachute", folder=tmp_path).splitlines()
    assert made == ["parachute.yaml", "meshes/parachute.txt", "dismech.schema.json"]
    call(installed, "run", "parachute.yaml", "--until", "0.02 s", "--no-render", folder=tmp_path)
    call(installed, "init", "cantilever_small", folder=tmp_path)
    said = call(installed, "run", "cantilever_small.yaml", "--no-render", folder=tmp_path)
    assert re.search(r"^tip .* pass ", said, re.MULTILINE)


def test_the_citation_is_of_this_version():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    required = {"cff-version", "message", "title", "authors", "version"}
    assert required <= citation.keys()
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == dismech_cli.__version__
    for source in citation["references"]:
        assert {"type", "title", "authors", "year", "doi"} <= source.keys()
