"""``dismech doctor``."""

from __future__ import annotations

from .. import options

SUMMARY = "Say what this machine can do: versions, solvers, kernels, pictures, disk, threads."
EXAMPLES = """
dismech doctor
dismech doctor --json
"""


def doctor(json: options.Json = False) -> int:
    """Entry point of the command."""
    from ...output.jsonable import dumps
    from ...session.machine import diagnose
    from ..console import emit
    from ..tables import table

    facts = diagnose()
    emit(dumps(facts, indent=2) if json else table((), list(facts.items())))
    return 0
