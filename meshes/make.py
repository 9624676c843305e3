"""Write the meshes of this folder: python meshes/make.py."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from dismech_cli.mesh.generate.rings import disc, hemisphere
from dismech_cli.mesh.generate.sheets import Pattern, sheet
from dismech_cli.mesh.mesh import Mesh
from dismech_cli.mesh.topology.shells import shell_edges
from dismech_cli.mesh.validate import validate

HERE = Path(__file__).parent
DIGITS = ".12g"  # A micrometre in a megametre, and no rounding noise in the files.


def bell() -> Mesh:
    """Jellyfish bell: unit hemisphere with rings of nodes every 15 degrees."""
    return hemisphere(1.0, 6, counts=(8, 13, 20, 27, 34, 41))


def jellyfish() -> Mesh:
    """The bell with seven tentacles of five 0.1 m edges that hang from every sixth rim node."""
    top = bell()
    roots = top.node_groups["rim"][:37:6]
    nodes, edges = [top.nodes], []
    count = len(top.nodes)
    for root in roots:
        drop = np.column_stack([np.zeros((5, 2)), -0.1 * np.arange(1, 6)])
        nodes.append(top.nodes[root] + drop)
        path = np.concatenate([[root], np.arange(count, count + 5)])
        edges.append(np.stack([path[:-1], path[1:]], axis=1))
        count += 5
    mesh = Mesh(nodes=np.concatenate(nodes), edges=np.concatenate(edges), triangles=top.triangles)
    return validate(mesh, "jellyfish")


def parachute() -> Mesh:
    """Flat hexagonal canopy of side 1 m, six ropes of eleven edges, payload node 0.2 m below."""
    rings = 6
    angle = np.pi / 3 * np.arange(7)
    corner = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(7)])
    canopy = [np.zeros((1, 3))]
    for ring in range(1, rings + 1):
        side, step = np.divmod(np.arange(6 * ring), ring)
        t = (step / ring)[:, None]
        canopy.append(ring / rings * ((1 - t) * corner[side] + t * corner[side + 1]))
    surface = np.concatenate(canopy)
    payload = len(surface)
    nodes, edges = [surface, [[0.0, 0.0, -0.2]]], []
    count = payload + 1
    for k in range(6):
        t = np.arange(1, 11)[:, None] / 11
        nodes.append((1 - t) * np.array([0.0, 0.0, -0.2]) + t * corner[k])
        at_corner = payload - 6 * rings + k * rings
        path = np.concatenate([[payload], np.arange(count, count + 10), [at_corner]])
        edges.append(np.stack([path[:-1], path[1:]], axis=1))
        count += 10
    triangles = disc(1.0, rings).triangles
    mesh = Mesh(nodes=np.concatenate(nodes), edges=np.concatenate(edges), triangles=triangles)
    return validate(mesh, "parachute")


def write_text(mesh: Mesh, path: Path, title: str) -> None:
    """Write the DiSMech text format."""
    lines = [f"# {title}", "*Nodes"]
    lines += [", ".join(format(x, DIGITS) for x in node) for node in mesh.nodes]
    for name, rows in (("*Edges", mesh.edges), ("*Triangles", mesh.triangles)):
        if len(rows):
            lines += [name, *(", ".join(str(i + 1) for i in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n")


def write_obj(mesh: Mesh, path: Path, title: str) -> None:
    """Write Wavefront OBJ, with the node groups as points."""
    lines = [f"# {title}", *("v " + " ".join(format(x, DIGITS) for x in node) for node in mesh.nodes)]
    lines += [f"o {path.stem}", *("f " + " ".join(str(i + 1) for i in row) for row in mesh.triangles)]
    for name, group in mesh.node_groups.items():
        lines += ["o", f"g {name}", "p " + " ".join(str(i + 1) for i in group)]
    path.write_text("\n".join(lines) + "\n")


def write_gmsh(mesh: Mesh, path: Path, clamped: str) -> None:
    """Write gmsh 2.2 with the surface and one of its sides as physical groups."""
    shell = shell_edges(mesh.triangles)
    side = np.isin(shell.edges, mesh.node_groups[clamped]).all(axis=1) & (shell.edge_faces[:, 1] < 0)
    tags = [np.full(int(side.sum()), 1), np.full(len(mesh.triangles), 2)]
    meshio.write(
        path,
        meshio.Mesh(
            mesh.nodes,
            [("line", shell.edges[side]), ("triangle", mesh.triangles)],
            cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
            field_data={clamped: np.array([1, 1]), "plate": np.array([2, 2])},
        ),
        file_format="gmsh22",
        binary=False,
        float_fmt=DIGITS,
    )


def main() -> None:
    """Write all meshes."""
    write_obj(bell(), HERE / "bell.obj", "jellyfish bell: hemisphere of radius 1 m, 144 nodes, 245 triangles")
    write_text(jellyfish(), HERE / "jellyfish.txt", "bell with seven tentacles of 0.5 m")
    write_text(
        parachute(), HERE / "parachute.txt", "hexagonal canopy of side 1 m, six ropes, payload node 128"
    )
    plate = sheet(0.1, 0.1, 12, Pattern.UNSTRUCTURED)
    write_gmsh(plate, HERE / "plate.msh", "left")


if __name__ == "__main__":
    main()
