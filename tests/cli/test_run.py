from __future__ import annotations

import json
import os
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from cli_call import call
from cli_process import environment, swing
from numpy.testing import assert_allclose

from dismech_cli.output.read import read
from dismech_cli.scenario.load import load

__all__ = ["call", "swing"]

SHORT = ("--set", "numerics.t_end=0.02")
PERIOD = tuple(f"--set=expect.tip.{pair}" for pair in ("reduce=period", "value=1 s", "tolerance=1 s"))


def test_results_of_a_run(call, swing):
    done = call("run", "swing.yaml", *SHORT)
    assert done.code == 0, done.stderr
    run_dir = swing / done.stdout.splitlines()[-1]
    assert run_dir.parent == swing / "results" / "swing"
    names = {path.name for path in run_dir.iterdir()} - {".lock"}
    assert names == {
        "manifest.json",
        "scenario.resolved.yaml",
        "run.vtkhdf",
        "scalars.csv",
        "events.jsonl",
        "log.txt",
        "checkpoints",
    }
    manifest = json.loads((run_dir / "manifest.json").read_text())
    assert (manifest["status"], manifest["exit_code"], manifest["name"]) == ("done", 0, "swing")
    assert manifest["counters"]["steps"] == 10
    assert manifest["counters"]["frames"] == 11
    assert "planar" in manifest["plan"]
    assert manifest["hashes"][str(swing / "swing.yaml")] == load(run_dir / "scenario.resolved.yaml").text_hash
    assert {"load", "build", "solve", "observe", "write", "total"} <= manifest["seconds"].keys()
    with read(run_dir) as run:
        assert_allclose(run.t, np.arange(11) * 0.002, rtol=1e-12)
        # Free fall: z = -g t^2 / 2 before the clamp is felt, to a few percent of it.
        assert_allclose(run.scalars["tip"][5], -9.81 * 0.01**2 / 2, rtol=0.05)


def test_json_is_all_of_stdout(call, swing):
    done = call("run", "swing.yaml", *SHORT, "--json", "-o", "out")
    result = json.loads(done.stdout)
    assert result["exit_code"] == done.code == 0
    assert result["run_dir"] == "out"
    (verdict,) = result["expectations"]
    assert verdict["name"] == "tip"
    assert verdict["passed"] is True
    assert verdict["unit"] == "m"
    assert verdict["measured"] == pytest.approx(-9.81 * 0.02**2 / 2, rel=0.2)


def test_quiet_prints_the_run_directory_alone(call, swing):
    done = call("run", "swing.yaml", *SHORT, "-q")
    assert done.stderr == ""
    assert (swing / done.stdout.rstrip("\n")).is_dir()


def test_verbose_gives_reasons(call, swing):
    done = call("run", "swing.yaml", *SHORT, "-v")
    assert "no force depends on velocity" in done.stderr
    assert "linear solver" in done.stderr
    assert "linear solver" in (swing / done.stdout.splitlines()[-1] / "log.txt").read_text()


def test_missed_expectation_ends_with_4(call, swing):
    done = call("run", "swing.yaml", *SHORT, "--set", "expect.tip.tolerance=1 %", "-o", "out")
    assert done.code == 4
    assert "MISSED" in done.stdout
    assert "expectation missed: tip" in done.stderr
    manifest = json.loads((swing / "out" / "manifest.json").read_text())
    assert (manifest["status"], manifest["exit_code"]) == ("done", 4)
    assert call("resume", "out").code == 4


def test_an_expectation_without_a_number_is_missed(call, swing):
    done = call("run", "swing.yaml", *SHORT, *PERIOD, "--json")
    assert done.code == 4
    assert json.loads(done.stdout)["expectations"][0]["measured"] == "nan"


def test_output_directory_is_never_overwritten_unless_asked(call, swing):
    assert call("run", "swing.yaml", *SHORT, "-o", "out").code == 0
    before = (swing / "out" / "manifest.json").read_bytes()
    done = call("run", "swing.yaml", *SHORT, "-o", "out")
    assert done.code == 5
    assert "not empty" in done.stderr
    assert (swing / "out" / "manifest.json").read_bytes() == before
    assert call("run", "swing.yaml", *SHORT, "-o", "out", "--overwrite").code == 0
    (swing / "mine").mkdir()
    (swing / "mine" / "thesis.tex").write_text("years of work")
    done = call("run", "swing.yaml", *SHORT, "-o", "mine", "--overwrite")
    assert done.code == 5
    assert (swing / "mine" / "thesis.tex").read_text() == "years of work"


def test_a_folder_that_cannot_be_made_ends_with_5(call, swing):
    (swing / "file").write_text("")
    done = call("run", "swing.yaml", *SHORT, "-o", "file/out")
    assert done.code == 5
    assert "not a folder" in done.stderr


def test_set_and_profile_reach_the_run(call, swing):
    call("run", "swing.yaml", *SHORT, "--profile", "draft", "--set", "numerics.dt=1 ms", "-o", "out")
    resolved = load(swing / "out" / "scenario.resolved.yaml").scenario
    assert resolved.numerics.dt == 0.001
    assert resolved.numerics.newton.tolerance == 1e-5


def test_files_of_the_scenario_travel_with_the_run(call, swing):
    for name, last in (("a", 0), ("b", 5)):
        (swing / name).mkdir()
        (swing / name / "g.csv").write_text(f"t,g\n0,0\n1,{-last}\n")
    law = "{{table: {{file: {}/g.csv}}}}"
    text = (swing / "swing.yaml").read_text()
    text = text.replace("[0, 0, -9.81]", f"[{law.format('a')}, 0, {law.format('b')}]")
    (swing / "swing.yaml").write_text(text)
    done = call("run", "swing.yaml", "--until", "0.1", "-o", "out")
    assert done.code == 0, done.stderr
    assert sorted(path.name for path in (swing / "out" / "inputs").iterdir()) == ["1-g.csv", "g.csv"]
    for name in ("a", "b"):
        (swing / name / "g.csv").unlink()
    assert call("check", "out/scenario.resolved.yaml").code == 0
    assert call("resume", "out", "--until", "0.15").code == 0
    (swing / "out" / "inputs" / "1-g.csv").write_text("t,g\n0,0\n1,-6\n")
    done = call("resume", "out")
    assert done.code == 2
    assert "inputs/1-g.csv changed" in done.stderr


def test_a_bug_ends_with_1_and_asks_for_a_report(call, swing, monkeypatch):
    import dismech_cli.session.conduct

    def break_down(*arguments, **options):
        raise ZeroDivisionError("a bug")

    monkeypatch.setattr(dismech_cli.session.conduct, "run", break_down)
    done = call("run", "swing.yaml", "-o", "out")
    assert done.code == 1
    assert "ZeroDivisionError: a bug" in done.stderr
    assert "please report" in done.stderr
    manifest = json.loads((swing / "out" / "manifest.json").read_text())
    assert (manifest["status"], manifest["exit_code"]) == ("failed", 1)


@pytest.mark.parametrize("option", [("--until", "3 m"), ("--until", "-1"), ("--wall-limit", "3 parsecs")])
def test_wrong_times_end_with_2(call, swing, option):
    done = call("run", "swing.yaml", *option)
    assert done.code == 2
    assert not (swing / "results").exists()


@pytest.mark.parametrize(
    ("options", "given", "expected"),
    [
        ((), {}, ("1", None)),
        ((), {"OMP_NUM_THREADS": "2"}, ("2", None)),
        (("--threads", "2", "--deterministic"), {"OMP_NUM_THREADS": "1"}, ("2", "AUTO")),
    ],
)
def test_threads_are_set_before_numpy_is_loaded(swing, options, given, expected):
    code = (
        "import os, sys, importlib.abc\n"
        "class Watch(importlib.abc.MetaPathFinder):\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name == 'numpy':\n"
        "            print(os.environ['OMP_NUM_THREADS'], os.environ.get('MKL_CBWR'))\n"
        "            sys.stdout.flush(); os._exit(0)\n"
        "sys.meta_path.insert(0, Watch())\n"
        "from dismech_cli.cli.app import main\n"
        f"main(['run', 'swing.yaml', *{options!r}])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=swing,
        env=environment(**given),
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == [str(value) for value in expected], done.stderr


def test_resume_takes_the_thread_settings_of_the_run(call, swing, monkeypatch):
    call("run", "swing.yaml", "--until", "0.01", "-o", "out", "--deterministic")
    assert json.loads((swing / "out" / "manifest.json").read_text())["threads"]["MKL_CBWR"] == "AUTO"
    monkeypatch.delenv("MKL_CBWR")
    call("resume", "out", "--until", "0.02")
    assert os.environ["MKL_CBWR"] == "AUTO"
    monkeypatch.delenv("MKL_CBWR")


BLOCK = """
import importlib.machinery, sys
class Block:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("numba", "pypardiso", "mkl"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, Block())
import importlib.util
found = importlib.util.find_spec
def find_spec(name, package=None):
    try:
        return found(name, package)
    except ModuleNotFoundError:
        return None
importlib.util.find_spec = find_spec
"""


def test_without_numba_and_mkl_it_still_runs(swing):
    code = BLOCK + (
        "from dismech_cli.cli.exits import exit_code\n"
        "from dismech_cli.cli.app import app\n"
        "for option in ('kernels=auto', 'kernels=numba', 'linear_solver=pardiso'):\n"
        "    arguments = ['run', 'swing.yaml', '-v', '--set', 'numerics.t_end=0.01']\n"
        "    print(exit_code(app, [*arguments, '--set', f'numerics.{option}']), 'is the code', flush=True)\n"
    )
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=swing, env=environment(), capture_output=True, text=True, check=True)
    codes = [line.split()[0] for line in done.stdout.splitlines() if line.endswith("is the code")]
    assert codes == ["0", "2", "2"], done.stderr
    assert "numerics.kernels: numba is not installed" in done.stderr
    assert "numerics.linear_solver: pypardiso with its MKL library is not installed" in done.stderr


def test_compilation_is_announced_once(call, swing, monkeypatch, tmp_path):
    pytest.importorskip("numba")
    monkeypatch.setenv("DISMECH_CACHE", str(tmp_path / "cache"))
    from dismech_cli.cli.console import Console
    from dismech_cli.compose.structure.plan import Decision
    from dismech_cli.session.composing import tell_plan

    decisions = (Decision("kernels by numba", "asked for"),)
    lines: list[str] = []
    monkeypatch.setattr(Console, "say", lambda self, text: lines.append(text))
    for compiling in (3, 0):
        tell_plan(SimpleNamespace(compiling=compiling, decisions=decisions), Console())
    assert lines == ["plan: kernels by numba", "compiling 3 kernels, once", "plan: kernels by numba"]


def test_resume_keeps_the_kernels_of_the_run(call, swing, monkeypatch):
    from dismech_cli.session import composing

    call("run", "swing.yaml", "--until", "0.01", "-o", "out")
    original, kept = composing.compose, []

    def spy(loaded, kernels=None, **options):
        kept.append(kernels)
        return original(loaded, kernels, **options)

    monkeypatch.setattr(composing, "compose", spy)
    assert call("resume", "out", "--until", "0.02").code == 0
    assert kept == ["numpy"]
    manifest = json.loads((swing / "out" / "manifest.json").read_text())
    assert manifest["status"] == "interrupted"
    assert manifest["seconds"]["total"] > 0.0
