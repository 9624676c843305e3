"""What is told to a child, and what it tells of a point: plain data that travels as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any, Literal, Self

from ...errors import OutputError
from ...frozen import frozen
from ...output.durable import output_errors, write_bytes
from ...output.jsonable import Json, dumps
from .points import Base, Point
from .publish import RESULT_FILE

Status = Literal["done", "failed", "timeout", "broken"]


@frozen(kw_only=True)
class Task:
    """A point to be run.

    Attributes:
        id: Its name.
        base: The scenario that it changes.
        overrides: How.
        settings: The same, for the record.
        units: Units of its probes.
        points: Where results go.
        limit: Wall time of the point [s], or None.
        light: Whether the result alone is kept.
    """

    id: str
    base: Base
    overrides: tuple[str, ...]
    settings: tuple[Mapping[str, Json], ...]
    units: Mapping[str, str]
    points: Path
    limit: float | None
    light: bool

    @classmethod
    def of(cls, point: Point, base: Base, points: Path, limit: float | None, light: bool) -> Self:
        """The task of a point."""
        return cls(
            id=point.id,
            # a child may stand in another folder
            base=replace(
                base,
                path=base.path.resolve(),
                plugins=tuple(one.resolve() for one in base.plugins),
            ),
            overrides=point.overrides,
            settings=tuple(asdict(one) for one in point.settings),
            units=point.units,
            points=points,
            limit=limit,
            light=light,
        )

    def as_json(self) -> dict[str, Json]:
        """For the way to a child."""
        base = {
            **asdict(self.base),
            "path": str(self.base.path),
            "plugins": [str(one) for one in self.base.plugins],
        }
        mine = {
            one.name: getattr(self, one.name) for one in fields(self) if one.name not in ("base", "points")
        }
        return {**mine, "base": base, "points": str(self.points)}

    @classmethod
    def of_json(cls, data: Mapping[str, Any]) -> Self:
        """The task that :meth:`as_json` gave."""
        base = data["base"]
        return cls(
            id=data["id"],
            base=Base(
                path=Path(base["path"]),
                overrides=tuple(base["overrides"]),
                profile=base["profile"],
                allow_outside=base["allow_outside"],
                plugins=tuple(map(Path, base["plugins"])),
            ),
            overrides=tuple(data["overrides"]),
            settings=tuple(data["settings"]),
            units=data["units"],
            points=Path(data["points"]),
            limit=data["limit"],
            light=data["light"],
        )


@frozen(kw_only=True)
class Result:
    """How a point ended: what tables and reports are made of.

    Attributes:
        id: Its name.
        settings: What it sets.
        status: ``timeout`` is over its limit of wall time, ``broken`` killed its process again and again.
        exit_code: As a run of it would end.
        message: Empty if all is well.
        expectations: As in the manifest of a run.
        probes: Each of ``output.probes`` in the last frame.
        units: Their units.
        energy_error: Of the last frame [J].
        penetration: The deepest, as a share of the thickness; None where nothing touched.
        counters: Steps, iterations and more.
        cpu: CPU time [s].
        wall: Wall time [s].
        light: Whether nothing else was kept.
    """

    id: str
    settings: tuple[Mapping[str, Json], ...]
    status: Status
    exit_code: int
    message: str
    expectations: tuple[Mapping[str, Json], ...] = ()
    probes: Mapping[str, Json]
    units: Mapping[str, str]
    energy_error: Json = None
    penetration: Json = None
    counters: Mapping[str, int]
    cpu: float
    wall: float
    light: bool

    @property
    def label(self) -> str:
        """What the point sets, on one line."""
        return ", ".join(f"{one['key']}={one['text']}" for one in self.settings)

    def save(self, folder: Path) -> None:
        """Write it into the folder of the point.

        Raises:
            OutputError: If it cannot be written.
        """
        write_bytes(folder / RESULT_FILE, (dumps(asdict(self), indent=1) + "\n").encode())

    @classmethod
    def read(cls, folder: Path) -> Self:
        """The result of a published point.

        Raises:
            OutputError: It cannot be read or is damaged.
        """
        file = folder / RESULT_FILE
        with output_errors(file, "read"):
            data = file.read_bytes()
        try:
            content = json.loads(data)
            for name in ("settings", "expectations"):
                content[name] = tuple(content[name])
            result = cls(**content)
        except (ValueError, TypeError, LookupError) as error:
            raise OutputError(f"cannot read {file}: it is damaged ({error})") from error
        if type(result.exit_code) is not int or result.id != folder.name:
            raise OutputError(f"cannot read {file}: it is damaged (of another point)")
        return result
