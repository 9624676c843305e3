"""What tells two runs apart, on stdout."""

from __future__ import annotations

from ..output.jsonable import dumps
from ..quantities import with_unit
from ..session.faults import fault
from ..studies.compare.compare import Compared
from ..studies.compare.differences import Difference
from .console import Console, emit
from .tables import table


def show(compared: Compared, json: bool, quiet: bool) -> int:
    """Print how far two runs are apart.

    Returns:
        The exit code.
    """
    console = Console()
    for note in compared.notes:
        console.warn(note)
    for told in compared.faults:
        console.error(told)
    if json:
        emit(dumps(_as_json(compared), indent=2))
        return compared.code
    over = [one for one in compared.differences if not one.within]
    if not quiet:
        head = ("quantity", "greatest", "of its size", "rms", "allowed", "", "t", "where")
        emit(table(head, [_row(one) for one in compared.differences]))
    names = ", ".join(one.found.name for one in over)
    emit(
        f"{compared.times} times: "
        + (f"{len(over)} quantities differ too much: {names}" if over else "within tolerance")
    )
    return compared.code


def _row(one: Difference) -> tuple[str, ...]:
    return (
        one.found.name,
        with_unit(f"{one.found.greatest:.4g}", one.found.unit),
        f"{one.relative:.3g}",
        with_unit(f"{one.found.rms:.4g}", one.found.unit),
        one.tolerance.told(one.found.unit),
        "" if one.within else "OVER",
        f"{one.found.t:.6g} s",
        one.found.place,
    )


def _as_json(compared: Compared) -> dict[str, object]:
    return {
        "runs": [str(run) for run in compared.runs],
        "exit_code": int(compared.code),
        "times": compared.times,
        "differences": [
            {
                "name": one.found.name,
                "unit": one.found.unit,
                "greatest": one.found.greatest,
                "rms": one.found.rms,
                "scale": one.found.scale,
                "relative": one.relative,
                "tolerance": one.tolerance.size,
                "tolerance_kind": one.tolerance.kind,
                "within": one.within,
                "t": one.found.t,
                "place": one.found.place,
            }
            for one in compared.differences
        ],
        "notes": compared.notes,
        "errors": [fault(told) for told in compared.faults]
        + [
            fault(
                f"{one.found.name} differs by {with_unit(f'{one.found.greatest:.6g}', one.found.unit)}, "
                f"allowed {one.tolerance.told(one.found.unit)}"
            )
            for one in compared.differences
            if not one.within
        ],
    }
