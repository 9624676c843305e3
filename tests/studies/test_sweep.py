"""Sweeps in processes of their own: every point once, whatever happens to whom."""

from __future__ import annotations

import json
import os
import random
import re
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from cli_process import Done, Nursery, nursery, wait_until
from sweeps import arm, left_over, published, results_of, rows_of, timeless

from dismech_cli.cli.result_schema import SWEEP
from dismech_cli.output.read import read

__all__ = ["arm", "nursery"]

MODULI = ("1 MPa", "2 MPa", "3 MPa", "4 MPa")
FOUR = ("--over", "parameters.E=" + ",".join(MODULI))


@pytest.fixture
def swept(nursery: Nursery, arm: Path) -> Callable[..., Done]:
    """Sweep ``arm.yaml`` into ``out``."""

    def run(*options: object, out: str = "out", **environment: str) -> Done:
        more = {"PYTHONPATH": f"{arm / 'trouble'}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"}
        # one child where nothing depends on there being more: each imports for seconds
        jobs = () if {"-j", "--executor"} & {*options} else ("-j", 1)
        return nursery.call(arm, "sweep", "arm.yaml", "-o", out, *jobs, *options, **more, **environment)

    return run


PLUGIN = """\
import numpy as np
class Hold:
    def __init__(self, most): self.most = most
    def start(self, n): return {"taken": np.zeros(n)}
    def sample(self, t, y, r, memory):
        taken = memory["taken"] + 1.0
        return np.full_like(taken, self.most), {"taken": taken}
"""
LOOPS = """
actuation: [{type: curvature_1, rod: beam, value: {controlled_by: bend}}]
controllers:
  bend: {type: plugin, name: "hold:Hold", settings: {most: 2.0}, period: 10 ms}
"""


def test_points_take_plugins_and_are_named_by_what_is_in_them(swept, arm):
    (arm / "arm.yaml").write_text((arm / "arm.yaml").read_text() + LOOPS)
    (arm / "hold.py").write_text(PLUGIN)
    axis = ("--over", "parameters.E=1 MPa,2 MPa")
    refused = swept(*axis, out="without")
    assert refused.code == 2
    assert "--plugin" in refused.stderr + json.dumps(results_of(arm / "without"))
    done = swept(*axis, "--plugin", "hold.py")
    assert done.code == 0, done.stderr
    first = published(arm / "out")
    for one in first:
        manifest = json.loads((arm / "out" / "points" / one / "manifest.json").read_text())
        assert any(name.endswith("hold.py") for name in manifest["hashes"])
    # another text of the plugin is another point
    (arm / "hold.py").write_text(PLUGIN.replace("+ 1.0", "+ 2.0"))
    other = swept(*axis, "--plugin", "hold.py", out="other")
    assert other.code == 0, other.stderr
    assert len(first) == 2
    assert not first & published(arm / "other")


def test_a_sweep_leaves_points_tables_and_a_report(swept, arm):
    done = swept(*FOUR, "-j", 2, "--json", "--junit", "out.xml")
    assert done.code == 0, done.stderr
    told = SWEEP.validate_python(json.loads(done.stdout))
    assert told.counts["done"] == 4
    assert [one.settings["parameters.E"].value for one in told.points] == [1e6, 2e6, 3e6, 4e6]
    out = arm / "out"
    assert published(out) == {one.id for one in told.points}
    assert not left_over(out)
    assert {p.name for p in out.iterdir()} == {"points", "sweep.json", "table.csv", "table.h5", "report.html"}
    for point in told.points:
        folder = out / "points" / point.id
        assert (folder / "run.vtkhdf").is_file()
        assert json.loads((folder / "manifest.json").read_text())["run_id"] == point.id
        log = (folder / "log.txt").read_text()
        assert f"results: {folder}" in log
        assert "/." not in log
    assert len({row["probe.tip [m]"] for row in rows_of(out)}) == 4
    assert [row["parameters.E [Pa]"] for row in rows_of(out)] == [
        "1000000.0",
        "2000000.0",
        "3000000.0",
        "4000000.0",
    ]
    assert (arm / "out.xml").read_text().count("<testcase") == 4


def test_a_point_is_what_a_run_of_it_is(swept, nursery, arm):
    assert swept(*FOUR[:1], "parameters.E=1 MPa,2 MPa").code == 0
    assert nursery.call(arm, "run", "arm.yaml", "--set", "parameters.E=2 MPa", "-o", "alone").code == 0

    def positions(run_dir: Path) -> bytes:
        with read(run_dir) as run:
            return run.positions[-1].tobytes()

    alone = positions(arm / "alone")
    assert [positions(folder) == alone for folder in (arm / "out" / "points").iterdir()].count(True) == 1


def test_shards_and_a_light_sweep_give_the_table_of_the_whole(swept, arm):
    assert swept(*FOUR).code == 0
    assert swept(*FOUR, "--shard", "1/2", "--light", out="parts").code == 0
    first = published(arm / "parts")
    assert swept(*FOUR, "--resume", "--no-run", out="parts").code == 130
    assert swept(*FOUR, "--shard", "2/2", "--light", "--resume", out="parts").code == 0
    assert len(first) == 2
    assert first < published(arm / "parts") == published(arm / "out")
    assert [p.name for p in (arm / "parts" / "points").glob("*/*")] == ["result.json"] * 4
    assert timeless(arm / "parts") == timeless(arm / "out")
    merged = swept(*FOUR, "--resume", "--no-run", out="parts")
    assert merged.code == 0, merged.stderr


def test_a_folder_with_points_is_gone_on_with_only_when_asked(swept, arm):
    assert swept("--over", "parameters.E=1 MPa,2 MPa").code == 0
    before = {p: p.stat().st_mtime_ns for p in (arm / "out" / "points").glob("*/result.json")}
    refused = swept(*FOUR)
    assert refused.code == 2
    assert "holds 2 points already: --resume" in refused.stderr
    more = swept(*FOUR, "--resume")
    assert more.code == 0
    assert "2 of 4 points have a result already" in more.stderr
    assert {p: p.stat().st_mtime_ns for p in before} == before
    less = swept("--over", "parameters.E=2 MPa", "--resume")
    assert less.code == 0
    assert "3 points in out belong to other values" in less.stderr
    assert len(rows_of(arm / "out")) == 1
    (arm / "full").mkdir()
    (arm / "full" / "thesis.tex").write_text("")
    assert swept(*FOUR, out="full").code == 2


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ((), "nothing to vary: add a section 'sweep'"),
        (("--over", "parameters.F=1"), "unknown parameter"),
        (("--over", "parameters.E=1 Pa,2 MPa"), "must be at least"),
        (("--shard", "3/2"), "expected PART/PARTS"),
        (("--no-run",), "needs --resume"),
        (("--retry-failed",), "needs --resume"),
        (("--gather",), "needs --executor"),
        (("-j", "2", "--executor", "dask://x:1"), "is of this machine"),
        ((*FOUR, "--executor", "ray://x:1"), "expected dask://HOST:PORT"),
    ],
)
def test_what_cannot_be_swept_is_refused_before_anything_is_made(swept, arm, options, told):
    done = swept(*options)
    assert done.code == 2
    assert told in done.stderr
    assert not (arm / "out").exists()


def test_a_dry_run_lists_the_points(swept, arm):
    done = swept(*FOUR, "--dry-run")
    assert done.code == 0
    assert re.findall(r"^[0-9a-f]{16}  parameters.E=(.*)$", done.stdout, re.MULTILINE) == list(MODULI)
    assert not (arm / "out").exists()


@pytest.mark.slow
def test_points_that_die_hang_and_fail_do_not_stop_the_others(swept, arm):
    kinds = ("segfault", "hang", "bug", "noise")
    trouble = ";".join(f"parameters.E={E}=>{kind}" for E, kind in zip(MODULI, kinds, strict=True))
    done = swept(*FOUR, "-j", 2, "--wall-limit", "20s", "--json", "--junit", "out.xml", TROUBLE=trouble)
    assert done.code == 3, done.stderr
    told = SWEEP.validate_python(json.loads(done.stdout))
    assert told.counts == {
        "points": 4, "done": 1, "missed": 0, "failed": 1, "timeout": 1, "broken": 1, "missing": 0
    }  # fmt: skip
    found = results_of(arm / "out")
    assert found["parameters.E=1 MPa"]["status"] == "broken"
    assert "SIGSEGV" in found["parameters.E=1 MPa"]["message"]
    assert found["parameters.E=2 MPa"]["status"] == "timeout"
    assert "KeyError" in found["parameters.E=3 MPa"]["message"]
    entries = [json.loads(line) for line in (arm / "out" / "failed.jsonl").read_text().splitlines()]
    assert [e["settings"]["parameters.E"] for e in entries].count("1 MPa") == 2
    assert all("about to read address 0" in e["log"] for e in entries if "SIGSEGV" in e["reason"])
    assert not left_over(arm / "out")
    xml = (arm / "out.xml").read_text()
    assert 'errors="3"' in xml
    page = (arm / "out" / "report.html").read_text()
    assert "What did not end well" in page

    again = swept(*FOUR, "--resume")
    assert again.code == 3, "what failed is not run again unasked"
    well = swept(*FOUR, "--resume", "--retry-failed")
    assert well.code == 0, well.stderr
    assert "3 points that did not end well are run again" in well.stderr


def test_a_point_that_the_system_kills_may_have_lacked_memory(swept, arm):
    done = swept("--over", "parameters.E=1 MPa", TROUBLE="parameters.E=1 MPa=>killed")
    assert done.code == 1
    assert "signal SIGKILL; was there enough memory?" in done.stderr
    assert "(2 attempts)" in done.stdout


def test_a_point_that_is_slow_stops_after_a_step_and_can_be_resumed(swept, nursery, arm):
    endless = ("--set", "numerics.t_end=1e4", "--set", "output.every=10")
    done = swept("--over", "parameters.E=2 MPa", "--wall-limit", "1s", *endless)
    assert done.code == 3
    (point,) = (arm / "out" / "points").iterdir()
    result = json.loads((point / "result.json").read_text())
    assert result["status"] == "timeout"
    assert "the wall-clock limit is reached" in result["message"]
    assert nursery.call(arm, "resume", point, "--until", "1 s").code == 0


def test_a_missed_expectation_is_a_failure_of_its_case(swept, arm):
    low = "expect.tip.value=1 m"
    done = swept(*FOUR, "--set", low, "--set", "expect.tip.tolerance=1 %", "--junit", "out.xml")
    assert done.code == 4
    assert 'failures="4"' in (arm / "out.xml").read_text()
    assert {row["expect.tip.kept"] for row in rows_of(arm / "out")} == {"no"}


@pytest.mark.slow
def test_frames_that_do_not_fit_are_the_failure_of_their_point(nursery, arm):
    two = ("--over", "numerics.t_end=0.02 s,20 s", "--set", "expect={}", "-j", 1)
    done = nursery.start(arm, "sweep", "arm.yaml", "-o", "out", *two, file_limit=2_000_000).wait()
    assert done.code == 5, done.stderr
    assert [row["status"] for row in rows_of(arm / "out")] == ["done", "failed"]
    assert "the file size limit is reached" in done.stdout
    assert not left_over(arm / "out")


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), pytest.param(signal.SIGTERM, 143, marks=pytest.mark.slow)]
)
def test_a_signal_stops_the_sweep_and_its_children(nursery, arm, number, code):
    process = slow_sweep(nursery, arm, FOUR)
    wait_until(lambda: any((arm / "out").glob("points/*/result.json")))
    process.signal(number)
    done = process.wait()
    assert done.code == code, done.stderr
    assert "--resume goes on" in done.stderr
    assert no_children(arm)
    assert len(rows_of(arm / "out")) == len(published(arm / "out")) < 4
    assert nursery.call(arm, "sweep", "arm.yaml", *FOUR, "-o", "out", "--resume").code == 0
    assert len(published(arm / "out")) == 4
    assert not left_over(arm / "out")


@pytest.mark.slow
def test_two_sweeps_in_one_folder_do_every_point_once(nursery, arm):
    grid = (*FOUR, "--over", "parameters.load=9,10,11")
    both = [slow_sweep(nursery, arm, (*grid, "--resume", "-v"), "0.3") for _ in range(2)]
    done = [one.wait() for one in both]
    assert [one.code for one in done] == [0, 0], done
    began = [line for one in done for line in re.findall(r"^done: (.*)$", one.stderr, re.MULTILINE)]
    # the rename decides; looking at who is at what spares nearly all double work
    assert len(set(began)) == 12
    assert len(began) <= 18
    assert len(published(arm / "out")) == len(rows_of(arm / "out")) == 12
    assert not left_over(arm / "out")


@pytest.mark.slow
def test_a_sweep_killed_at_any_moment_is_resumed(nursery, arm):
    grid = ("--over", "parameters.E=1 MPa:9 MPa:9", "--over", "parameters.load=1:9:9", "--resume")
    chance = random.Random(20)
    seen: dict[Path, tuple[int, int]] = {}
    killed_at_work = 0
    for _ in range(20):
        before = left_over(arm / "out")
        process = slow_sweep(nursery, arm, grid, "0.05")
        # from the first point that is begun on, while others are run, published and cleared away
        wait_until(lambda before=before: left_over(arm / "out") - before or len(published(arm / "out")) == 81)
        time.sleep(chance.uniform(0.0, 0.3))
        process.signal(signal.SIGKILL)
        process.wait()
        wait_until(lambda: no_children(arm))
        killed_at_work += bool(left_over(arm / "out"))
        for file in (arm / "out").glob("points/*/result.json"):
            stat = file.stat()
            assert json.loads(file.read_text())["exit_code"] == 0
            assert seen.setdefault(file, (stat.st_ino, stat.st_mtime_ns)) == (stat.st_ino, stat.st_mtime_ns)
    assert killed_at_work >= 5
    assert seen
    done = nursery.start(arm, "sweep", "arm.yaml", *grid, "-o", "out").wait(timeout=400)
    assert done.code == 0, done.stderr
    assert len(published(arm / "out")) == len(rows_of(arm / "out")) == 81
    assert not left_over(arm / "out")
    assert set(seen) <= set((arm / "out").glob("points/*/result.json"))


@pytest.mark.slow
def test_four_children_compile_once(nursery, arm):
    pytest.importorskip("numba")
    cache = arm / "cache"
    cache.mkdir(mode=0o700)
    done = nursery.call(
        arm, "sweep", "arm.yaml", *FOUR, "-o", "out", "-j", 4, "--set", "numerics.kernels=numba",
        DISMECH_CACHE=str(cache),
    )  # fmt: skip
    assert done.code == 0, done.stderr
    assert all(result["cpu"] < 5.0 for result in results_of(arm / "out").values()), "a child compiled"
    # Numba names the next overload of a loop by a number: a second compilation would show
    compiled = sorted(file.name for file in cache.rglob("*.nbc"))
    assert compiled
    assert all(re.search(r"\.1\.nbc$", name) for name in compiled)


def slow_sweep(nursery: Nursery, arm: Path, options: Any, slowly: str = "0.5"):
    path = f"{arm / 'trouble'}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    return nursery.start(
        arm, "sweep", "arm.yaml", "-o", "out", "-j", 2, *options, PYTHONPATH=path, TROUBLE="", SLOWLY=slowly
    )


def no_children(arm: Path) -> bool:
    """Whether no process works for a sweep in the folder."""
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            line = (folder / "cmdline").read_bytes()
            if b"dismech_cli.studies.sweep.child" in line and (folder / "cwd").resolve() == arm.resolve():
                return False
        except OSError:
            continue
    return True
