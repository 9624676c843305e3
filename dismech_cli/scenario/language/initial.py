"""The state that a run starts from, where it is not the rest shape."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import ConfigDict, Field, Strict, Tag, model_validator

from ..values.law import PlaceLaws
from ..values.quantity import Column, FileName, FileReference, Index, Time
from ..values.selection import SelectedNodes
from ..values.spec import Spec, problem, tag, told_by_key

RunName: TypeAlias = Annotated[str, FileReference(folder=True), Field(min_length=1, max_length=1000)]


class FromRun(Spec):
    """Starts from a state of another run of the same bodies; their rest shape is still that of this scenario.

    The clock starts at 0, and loads and motions go by the laws of this scenario.
    """

    model_config = ConfigDict(json_schema_extra={"allOf": [{"not": {"required": ["at", "frame"]}}]})

    run: RunName = Field(
        description="Folder of the run, relative to this file, or a checkpoint of it or the copy that a run "
        "keeps of the state it started from."
    )
    at: Literal["last"] | Time = Field(
        default="last", description="`last`, when the run is done, or the time of one of its frames."
    )
    frame: Index | None = Field(default=None, description="Number of a frame, in place of `at`.")
    at_rest: bool = Field(
        default=False, description="Whether the bodies start at rest; else they move on as they did."
    )

    @model_validator(mode="after")
    def _once(self) -> FromRun:
        if self.frame is not None and self.at != "last":
            raise problem("give 'at' or 'frame', not both")
        return self


class PositionFile(Spec):
    """One displacement per selected node from a CSV file [m]."""

    file: FileName = Field(description="CSV file; its first line may name the columns.")
    columns: Annotated[tuple[Column, ...], Len(3, 3), Strict(False)] = Field(
        default=(0, 1, 2), description="Columns of the components, by name or number from 0."
    )


class Displaced(Spec):
    """Displacements of some nodes at the start."""

    where: SelectedNodes = Field(description="Nodes that are displaced.")
    displacement: Annotated[
        Annotated[PlaceLaws, Tag("<laws>")] | Annotated[PositionFile, Tag("<file>")],
        told_by_key("file", scalar="<laws>"),
    ] = Field(
        description="From the rest position: numbers or expressions of x, y, z of each node at rest [m] and "
        "of s, 0 to 1 along its rod; or one each from a file."
    )


class FromDisplacements(Spec):
    """Starts displaced from the rest shape, which stays what it is: sections turn no more than they must."""

    displacements: Annotated[tuple[Displaced, ...], Len(1, 10_000), Strict(False)] = Field(
        description="Displacements by place; everything else starts where it rests."
    )


Initial: TypeAlias = Annotated[
    Annotated[FromRun, Tag(tag("run"))] | Annotated[FromDisplacements, Tag(tag("displacements"))],
    told_by_key("run", "displacements"),
]
