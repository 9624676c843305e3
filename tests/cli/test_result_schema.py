"""JSON on every exit, held to its schema; the number of errors goes with the exit code."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from cli_call import call
from cli_process import Done, Nursery, nursery, swing, wait_until
from pydantic import TypeAdapter

from dismech_cli.cli.result_schema import CHECK, RUN, Checked, Failure, Refused, Run

__all__ = ["call", "nursery", "swing"]

SHORT = ("--set", "numerics.t_end=0.01")
ENDLESS = ("--set", "numerics.t_end=1e4", "--set", "output.every=0.1", "--progress", "none")
MISSED = (
    "--set",
    "expect={tip: {probe: {displacement: beam.end, component: z}, value: 1, tolerance: 1 %, source: x}}",
)
BLOWN_UP = ("--set", "numerics.newton.max_iterations=1", "--set", "numerics.step.max_cuts=0")


def held(schema: TypeAdapter[Any], done: Done, code: int) -> Any:
    """The result as the schema has it."""
    result = schema.validate_python(json.loads(done.stdout))
    assert done.code == code, done.stderr
    if isinstance(result, Run | Failure):
        assert result.exit_code == code
        assert bool(result.errors) == (code != 0)
    return result


@pytest.mark.parametrize(
    ("options", "code", "status"),
    [
        (SHORT, 0, "done"),
        (BLOWN_UP, 3, "failed"),
        ((*SHORT, *MISSED), 4, "done"),
        (("--wall-limit", "0.001s", *ENDLESS), 130, "interrupted"),
        (("--until", "0.01 s"), 0, "interrupted"),
    ],
)
def test_a_run_that_began(
    call: Callable[..., Done], swing: Path, options: Any, code: int, status: str
) -> None:
    done = held(RUN, call("run", "swing.yaml", *options, "-o", "out", "--json"), code)
    assert isinstance(done, Run)
    assert done.status == status
    if status == "done":
        again = held(RUN, call("resume", "out", "--json"), code)
        assert again == done


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("run", "nowhere.yaml"), 2),
        (("run", "swing.yaml", "--set", "numerics.dt=1 mm"), 2),
        (("run", "swing.yaml", "--wall-limit", "never"), 2),
        (("run", "swing.yaml", "-o", "full"), 5),
        (("resume", "full"), 2),
        (("resume", "nowhere"), 2),
        (("check",), 2),
        (("render", "full"), 5),
    ],
)
def test_what_ends_before_a_run_begins(
    call: Callable[..., Done], swing: Path, arguments: Any, code: int
) -> None:
    (swing / "full").mkdir()
    (swing / "full" / "thing").write_text("")
    assert isinstance(held(RUN, call(*arguments, "--json"), code), Failure)


def test_a_bug_and_a_machine_that_cannot_draw(
    call: Callable[..., Done], swing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from dismech_cli.errors import RenderError
    from dismech_cli.session import drawing, start

    assert call("run", "swing.yaml", *SHORT, "-o", "out").code == 0

    def fails(error: Exception) -> Callable[..., Any]:
        def fail(*arguments: Any, **options: Any) -> Any:
            raise error

        return fail

    monkeypatch.setattr(start, "load", fails(ZeroDivisionError("a bug")))
    bug = held(RUN, call("run", "swing.yaml", "--json"), 1)
    assert "a bug" in bug.errors[0].message
    monkeypatch.setattr(drawing, "render", fails(RenderError("cannot draw")))
    assert held(RUN, call("render", "out", "--json"), 6).errors[0].message == "cannot draw"


def test_a_check_of_good_and_bad(call: Callable[..., Done], swing: Path) -> None:
    (good,) = held(CHECK, call("check", "swing.yaml", "--json"), 0)
    assert isinstance(good, Checked)
    (swing / "bad.yaml").write_text((swing / "swing.yaml").read_text().replace("2 MPa", "2 mm"))
    done = held(CHECK, call("check", "swing.yaml", "bad.yaml", "nowhere.yaml", "--json"), 2)
    assert [type(entry) for entry in done] == [Checked, Refused, Refused]
    assert done[1].errors[0].key == "materials.silicone.youngs_modulus"


@pytest.mark.parametrize(
    ("number", "times", "code"),
    [(signal.SIGINT, 1, 130), (signal.SIGINT, 2, 130), (signal.SIGTERM, 1, 143), (signal.SIGHUP, 1, 129)],
)
def test_a_run_that_a_signal_stops(nursery: Nursery, swing: Path, number: int, times: int, code: int) -> None:
    process = nursery.start(swing, "run", "swing.yaml", "-o", "out", "--json", *ENDLESS)
    file = swing / "out" / "scalars.csv"
    wait_until(lambda: file.exists() and file.read_bytes().count(b"\n") > 2)
    for _ in range(times):
        process.signal(number)
    done = held(RUN, process.wait(), code)
    assert done.status == "interrupted"
    assert list(done.probes) == ["tip"]
    assert held(RUN, nursery.call(swing, "resume", "out", "--json", "--wall-limit", "0.001s"), 130).probes


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)]
)
def test_a_signal_before_the_run_begins(
    call: Callable[..., Done], swing: Path, monkeypatch: pytest.MonkeyPatch, number: int, code: int
) -> None:
    from dismech_cli.session import start

    handler = signal.getsignal(number)
    # which tests under nohup would ignore
    monkeypatch.setattr(signal, "getsignal", lambda _: handler if number == signal.SIGINT else signal.SIG_DFL)
    monkeypatch.setattr(start, "load", lambda *_, **__: os.kill(os.getpid(), number))
    done = held(RUN, call("run", "swing.yaml", "--json"), code)
    assert isinstance(done, Failure)
    assert done.status == "interrupted"
    assert not (swing / "results").exists()


def test_a_disk_that_fills_during_a_run(nursery: Nursery, swing: Path) -> None:
    process = nursery.start(swing, "run", "swing.yaml", "-o", "out", "--json", *ENDLESS, file_limit=100_000)
    done = held(RUN, process.wait(), 5)
    assert "size limit" in done.errors[0].message


def test_the_schemas_are_printed(call: Callable[..., Done]) -> None:
    printed = json.loads(call("schema", "--results").stdout)
    assert list(printed) == ["run", "resume", "check", "sweep", "compare", "gradient", "calibrate"]
    assert printed["run"]["$defs"]["Fault"]["required"] == ["file", "line", "column", "key", "message"]
