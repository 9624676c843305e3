"""A study as JSON, CSV and Markdown."""

from __future__ import annotations

import csv
import io
from math import isfinite

from ...output.jsonable import Json, to_json
from ...output.manifest import installed_versions
from .refine import Found
from .studied import COLUMNS, Row, Studied, cells


def as_json(studied: Studied) -> dict[str, Json]:
    """For programs."""
    return {
        "study_dir": str(studied.folder),
        "name": studied.name,
        "target": studied.target,
        "meets": studied.answer is not None,
        "message": studied.told,
        "set": [] if studied.answer is None else [f"{k}={v}" for k, v in studied.answer.point.settings],
        "quantities": to_json({name: one.model_dump() for name, one in studied.quantities.items()}),
        "runs": len(studied.rows),
        "combinations": studied.count,
        "not_refined": list(studied.missing),
        "reference": studied.reference,
        "points": [_point(row) for row in studied.rows],
        "found": [_found(one) for one in studied.found],
        "load": studied.load,
        "versions": to_json(installed_versions()),
    }


def _point(row: Row) -> Json:
    values = dict(zip(("settings", *COLUMNS[1:]), cells(row), strict=True))
    values["settings"] = dict(row.point.settings)
    return to_json(values | {"message": row.point.message, "doubts": list(row.point.doubts)})


def _found(one: Found) -> Json:
    return to_json(
        {
            "settings": dict(one.point.settings),
            "meets": one.meets,
            "reason": one.reason,
            "time_error": one.time.error,
            "time_order": one.time.order if isfinite(one.time.order) else None,
            "mesh_error": one.mesh.error,
            "mesh_order": one.mesh.order if isfinite(one.mesh.order) else None,
            "cpu": one.point.cpu,
        }
    )


def csv_text(studied: Studied) -> str:
    """The table for a spreadsheet."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(["" if value is None else value for value in cells(row)] for row in studied.rows)
    return text.getvalue()


def markdown(studied: Studied) -> str:
    """The table for a README."""
    lines = [
        f"# What accuracy costs in {studied.name}",
        "",
        studied.told,
        "",
        f"{len(studied.rows)} runs of {studied.count} combinations.",
        "",
        "| " + " | ".join(COLUMNS) + " |",
        "|" + "---|" * len(COLUMNS),
    ]
    for row in studied.rows:
        texts = ["" if v is None else f"{v:.3g}" if isinstance(v, float) else str(v) for v in cells(row)]
        lines.append("| " + " | ".join(texts) + " |")
    return "\n".join(lines) + "\n"
