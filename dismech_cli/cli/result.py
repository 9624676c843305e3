"""The result of a run on stdout, for people and for programs."""

from __future__ import annotations

from ..output.jsonable import Json, dumps
from ..output.manifest import Manifest
from ..quantities import with_unit
from ..session.conduct import Finished
from ..session.faults import fault
from ..session.verdicts import Verdict
from .console import QUIET, emit
from .tables import table


def show(finished: Finished, json: bool, level: int) -> int:
    """Print how a run ended.

    Args:
        finished: The run.
        json: Whether the result is JSON.
        level: How much to say.

    Returns:
        The exit code.
    """
    record = finished.record
    if json:
        emit(dumps(_as_json(finished), indent=2))
    else:
        if level > QUIET:
            emit(_summary(record.manifest))
            if record.ending.verdicts:
                emit(_verdict_table(record.ending.verdicts))
        emit(str(record.run_dir))
    return record.ending.code


def _as_json(finished: Finished) -> dict[str, object]:
    record, manifest = finished.record, finished.record.manifest
    return {
        "run_dir": str(record.run_dir),
        "status": manifest.status,
        "exit_code": manifest.exit_code,
        "message": manifest.message,
        "counters": manifest.counters,
        "seconds": manifest.seconds,
        "errors": faults_of(record.ending.code, manifest.message),
        "expectations": manifest.expectations,
        "probes": manifest.probes,
        "energy_error": manifest.energy_error,
        "penetration": manifest.penetration or None,
        "overrides": manifest.overrides,
        "parameters": manifest.parameters,
        "versions": manifest.versions,
        "pictures": [str(file) for file in finished.pictures],
    }


def faults_of(code: int, message: str) -> list[dict[str, Json]]:
    """The message of a run that did not end well, as a fault."""
    return [fault(message)] if code else []


def _summary(manifest: Manifest) -> str:
    count = manifest.counters
    parts: list[str] = [manifest.status]
    if count:
        parts += [f"{count['steps']} steps", f"{count['iterations']} Newton iterations"]
        parts += [f"{count['cuts']} steps cut"] if count["cuts"] else []
        parts += [f"{count['frames']} frames", f"{manifest.seconds['total']:.3g} s"]
    return "\n".join([", ".join(parts), *_deepest(manifest)])


def _deepest(manifest: Manifest) -> list[str]:
    """A line on the deepest penetration, if anything touched."""
    if not (found := manifest.penetration):
        return []
    one, other = found["between"]  # type: ignore[misc, str-unpack]
    rebuilds = manifest.counters.get("rebuilds", 0)
    return [
        f"deepest contact: {found['share']:.2%} of the thickness, {one!r} and {other!r} near {found['near']} "
        f"at t = {found['t']:.4g} s; pairs came or went in {rebuilds} steps"
    ]


def _verdict_table(verdicts: tuple[Verdict, ...]) -> str:
    rows = [
        (
            v.name,
            with_unit(f"{v.measured:.6g}", v.unit),
            with_unit(f"{v.expected:.6g}", v.unit),
            v.tolerance,
            "pass" if v.passed else "MISSED",
            v.source,
        )
        for v in verdicts
    ]
    return table(("expectation", "measured", "expected", "tolerance", "", "source"), rows)
