"""A gradient for people and for programs."""

from __future__ import annotations

from ...output.jsonable import Json, to_json
from ...quantities import with_unit
from .gradient import Gradient, Method
from .setting import Setting


def as_json(found: Gradient) -> dict[str, Json]:
    """For programs."""
    check = found.check
    return {
        "of": found.of,
        "value": to_json(found.value),
        "unit": found.unit,
        "method": found.method.value,
        "why": found.why or None,
        "gradient": [
            {
                "by": setting.path,
                "value": to_json(setting.value),
                "unit": setting.unit,
                "derivative": to_json(float(slope)),
                "derivative_unit": per(found.unit, setting.unit),
            }
            for setting, slope in zip(found.settings, found.slopes, strict=True)
        ],
        "check": None
        if check is None
        else {
            "gradient": to_json(check.gradient),
            "difference": to_json(check.difference),
            "uncertainty": to_json(check.uncertainty),
            "agrees": check.agrees,
        },
        "seconds": {"run": found.seconds[0], "gradient": found.seconds[1]},
    }


def as_text(found: Gradient) -> str:
    """For people."""
    lines = [f"{found.of} = {with_unit(f'{found.value:.9g}', found.unit)}"]
    head = ("by", "value", "derivative", "times value")
    rows = [
        _row(found, setting, float(slope))
        for setting, slope in zip(found.settings, found.slopes, strict=True)
    ]
    widths = [max(len(row[k]) for row in (head, *rows)) for k in range(4)]
    for row in (head, *rows):
        lines.append("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    lines.append(f"method: {_HOW[found.method]}" + (f": {found.why}" if found.why else ""))
    run, slopes = found.seconds
    lines.append(f"run {run:.3g} s, derivatives {slopes:.3g} s")
    if found.check is not None:
        lines.append(_checked(found))
    return "\n".join(lines)


_HOW = {
    Method.FORWARD: "forward sensitivities, exact",
    Method.ADJOINT: "adjoint, exact",
    Method.DIFFERENCES: "differences of runs",
}


def per(unit: str, by: str) -> str:
    """The unit of a derivative."""
    plain = by in ("", "1")
    if plain:
        return unit
    below = by if by.isalpha() else f"({by})"
    return f"{unit or '1'}/{below}"


def _row(found: Gradient, setting: Setting, slope: float) -> tuple[str, str, str, str]:
    return (
        setting.path,
        with_unit(f"{setting.value:.9g}", setting.unit),
        with_unit(f"{slope:.9g}", per(found.unit, setting.unit)),
        with_unit(f"{slope * setting.value:.6g}", found.unit),
    )


def _checked(found: Gradient) -> str:
    assert found.check is not None
    check = found.check
    words = "agrees" if check.agrees else "DISAGREES"
    apart = abs(check.gradient - check.difference) / (abs(check.difference) or 1.0)
    return (
        f"check: along all values at once {check.gradient:.9g}, by differences of runs "
        f"{check.difference:.9g} +- {check.uncertainty:.1g}: {words}, {apart:.1e} apart"
    )
