"""Plan, progress and result of a run, for people and for programs."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from ..compose.structure.plan import Plan
from ..kernels.cache import cache_folder, is_compiled
from ..output.jsonable import dumps
from ..run.progress import Reporter, Silent, make_reporter
from ..session.conduct import Report
from ..session.verdicts import verdict_table
from .console import QUIET, Console, emit


@dataclass(frozen=True, slots=True)
class Presenting:
    """How a run is shown.

    Attributes:
        console: For everything but the result.
        json: Whether the result is JSON.
        progress: ``auto``, ``bar``, ``lines`` or ``none``.
    """

    console: Console
    json: bool
    progress: str

    def reporter(self) -> Reporter:
        """What shows the progress."""
        if self.console.level == QUIET:
            return Silent()
        return make_reporter(self.progress, sys.stderr, os.environ.get("TERM"))

    def planned(self, plan: Plan) -> None:
        """Show the plan, and why nothing happens while kernels are compiled."""
        self.console.say("plan: " + "; ".join(d.what.partition(":")[0] for d in plan.decisions))
        for decision in plan.decisions:
            self.console.detail(f"  {decision.what}: {decision.why}")
        if plan.kernels == "numba" and not is_compiled(cache_folder()):
            self.console.say("compiling kernels, once")

    def result(self, run_dir: Path, report: Report, pictures: Sequence[str]) -> None:
        """Show how it ended on stdout."""
        manifest = report.manifest
        if self.json:
            emit(
                dumps(
                    {
                        "run_dir": str(run_dir),
                        "status": manifest.status,
                        "exit_code": manifest.exit_code,
                        "message": manifest.message,
                        "counters": manifest.counters,
                        "seconds": manifest.seconds,
                        "expectations": [asdict(verdict) for verdict in report.verdicts],
                        "pictures": list(pictures),
                    },
                    indent=2,
                )
            )
            return
        if self.console.level > QUIET:
            emit(_summary(report))
            if report.verdicts:
                emit(verdict_table(report.verdicts))
        emit(str(run_dir))


def _summary(report: Report) -> str:
    manifest = report.manifest
    count = manifest.counters
    parts: list[str] = [manifest.status]
    if count:
        parts += [f"{count['steps']} steps", f"{count['iterations']} Newton iterations"]
        parts += [f"{count['cuts']} steps cut"] if count["cuts"] else []
        parts += [f"{count['frames']} frames", f"{manifest.seconds['total']:.3g} s"]
    return ", ".join(parts)
