"""The page on sweeps tells what the program does; its workflow works as it stands."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest
import yaml
from cli_call import call
from cli_process import ROOT, Nursery, nursery
from scenario_folder import SCENE, Folder, folder
from sweeps import left_over, rows_of

__all__ = ["call", "folder", "nursery"]

PAGE = (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def workflow() -> dict:
    (text,) = (block for block in blocks("yaml") if "runs-on" in block)
    return yaml.safe_load(text)["jobs"]


def commands(job: dict, shard: int = 0) -> list[list[str]]:
    """What a job runs of this program; installing is not tried here."""
    lines = [step["run"].replace("${{ matrix.shard }}", str(shard)) for step in job["steps"] if "run" in step]
    return [shlex.split(line)[1:] for line in lines if line.startswith("dismech ")]


def artifact(job: dict) -> Path:
    return Path(next(step["with"]["path"] for step in job["steps"] if "artifact" in step.get("uses", "")))


def checkout(folder: Path) -> Path:
    folder.mkdir()
    (folder / "scenarios").mkdir()
    shutil.copy(ROOT / "scenarios" / "sag_sweep.yaml", folder / "scenarios")
    return folder


@pytest.mark.slow
def test_the_workflow_gathers_its_shards(nursery: Nursery, tmp_path: Path):
    jobs = workflow()
    machine = checkout(tmp_path / "table")
    gathered = machine / artifact(jobs["table"])
    for number in jobs["shard"]["strategy"]["matrix"]["shard"]:
        own = checkout(tmp_path / f"shard-{number}")
        for words in commands(jobs["shard"], number):
            done = nursery.start(own, *words).wait(timeout=120)
            assert done.code == 0, done.stderr
        assert (own / "shard.xml").read_text().count("<testcase") == 6
        shutil.copytree(own / artifact(jobs["shard"]), gathered, dirs_exist_ok=True)
    for words in commands(jobs["table"]):
        done = nursery.call(machine, *words)
        assert done.code == 0, done.stderr
    assert len(rows_of(machine / "out")) == 12
    assert not left_over(machine / "out")
    assert (machine / "sweep.xml").read_text().count("<testcase") == 12
    assert all(row["expect.tip.kept"] == "yes" for row in rows_of(machine / "out"))


@pytest.mark.slow
def test_the_comparison_and_the_report_of_the_page(call, tmp_path: Path):
    (tmp_path / "scenarios").mkdir()
    shutil.copy(ROOT / "scenarios" / "cantilever_small.yaml", tmp_path / "scenarios")
    ran = []
    for block in blocks("sh"):
        for line in block.splitlines():
            words = shlex.split(line)[1:]
            if words[0] != "sweep":
                assert call(*words).code == 0, line
                ran.append(words[0])
    assert ran == ["run", "run", "compare", "report"]


def test_the_section_of_the_page_is_read(folder: Folder):
    section = next(block for block in blocks("yaml") if block.startswith("sweep:"))
    folder.write("points.csv", "a\n1\n")
    sweep = folder.load(SCENE + section).scenario.sweep
    assert sweep is not None
    assert sweep.sample is not None
    assert len(sweep.over) == 3
    assert len(sweep.zip) == 2


def test_every_option_is_listed(call):
    offered = set(re.findall(r"--[a-z][a-z-]+", call("sweep", "-h").stdout))
    listed = set(re.findall(r"--[a-z][a-z-]+", PAGE))
    common = {"--help", "--quiet", "--verbose", "--output", "--jobs", "--profile", "--allow-outside"}
    assert offered - listed == common | {"--deterministic"}


@pytest.mark.parametrize("command", ["compare", "report"])
def test_every_option_of_the_others_is_listed(call, command):
    offered = set(re.findall(r"--[a-z][a-z-]+", call(command, "-h").stdout))
    listed = set(re.findall(r"--[a-z][a-z-]+", PAGE))
    assert offered - listed == {"--help", "--quiet"} | ({"--output"} if command == "report" else set())
