"""The topology inside a run file, under ``/dismech/topology``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..frame import FieldSpec, Location, Topology

GROUP = "dismech/topology"

_ARRAYS = {
    "rest_positions": ("m", "rest positions of the nodes"),
    "edges": ("1", "node indices of the rod edges"),
    "triangles": ("1", "node indices of the shell triangles"),
    "edge_radius": ("m", "drawing radius of the rod edges"),
    "triangle_thickness": ("m", "thickness of the shell triangles"),
    "edge_body": ("1", "body of each rod edge"),
    "triangle_body": ("1", "body of each shell triangle"),
}


def write_topology(file: Any, topology: Topology) -> None:
    """Store ``topology`` once; fields, state and scalars describe themselves where they lie."""
    group = file.create_group(GROUP)
    for name, (unit, long_name) in _ARRAYS.items():
        dataset = group.create_dataset(name, data=getattr(topology, name))
        dataset.attrs["units"] = unit
        dataset.attrs["long_name"] = long_name
    group.attrs["bodies"] = list(topology.bodies) if topology.bodies else np.empty(0, dtype="S1")
    group.attrs["fields"] = [field.name for field in topology.fields] or np.empty(0, dtype="S1")


def read_topology(file: Any) -> Topology:
    """Load the topology with the descriptions of all fields, state arrays and scalars.

    Raises:
        KeyError: If the file is not a run file.
    """
    group = file[GROUP]
    arrays = {name: np.asarray(group[name][()]) for name in _ARRAYS}
    return Topology(
        **arrays,
        bodies=tuple(str(body) for body in group.attrs["bodies"]),
        fields=tuple(_read_field(file, str(name)) for name in group.attrs["fields"]),
        state={
            str(name): (tuple(int(size) for size in dataset.shape[1:]), str(dataset.attrs["units"]))
            for name, dataset in sorted(file["dismech/state"].items(), key=_order)
        },
        scalars={
            str(name): str(dataset.attrs["units"])
            for name, dataset in sorted(file["dismech/scalars"].items(), key=_order)
        },
    )


def _order(item: tuple[str, Any]) -> int:
    # HDF5 lists names alphabetically; the columns have an order of their own.
    return int(item[1].attrs["order"])


def _read_field(file: Any, name: str) -> FieldSpec:
    location: Location = "node" if _named(file["VTKHDF"], "PointData", name) else "cell"
    dataset = _named(file["VTKHDF"], "PointData" if location == "node" else "CellData", name)
    return FieldSpec(
        name=name,
        unit=str(dataset.attrs["units"]),
        long_name=str(dataset.attrs["long_name"]),
        location=location,
        components=int(dataset.shape[1]) if dataset.ndim > 1 else 1,
    )


def _named(root: Any, group: str, name: str) -> Any:
    """The array of that name, whatever unit stands behind it, or None."""
    arrays = root.get(group, {})
    return next((arrays[key] for key in arrays if key.partition(" [")[0] == name), None)
