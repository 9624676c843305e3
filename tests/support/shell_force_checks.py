"""Forces on shells: one of each kind that turns, and their derivative check."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from cases import TermCase
from derivatives import assert_derivatives
from shell_cases import Shell, shell
from shell_states import driver_of

from dismech_cli.arrays import FloatArray
from dismech_cli.forces.edge_torque import EdgeTorque
from dismech_cli.forces.follower import Faces, FollowerForce
from dismech_cli.forces.pressure import FollowerPressure
from dismech_cli.kinematics.shell_frames import ShellFrames
from dismech_cli.laws.laws import Constant
from dismech_cli.mesh.generate.rings import hemisphere
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.term import Term

CAP = hemisphere(1.0, 3)


def state(made: Shell, q: FloatArray, v: FloatArray) -> Configuration:
    frames = made.model.frames
    return Configuration(0.0, q, v, frames.transport(frames.rest(made.model.rest), q))


def disturbed(made: Shell, seed: int = 0) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(seed)
    n = made.model.dofs.n
    return made.model.rest + 0.2 * made.model.length * rng.uniform(-1, 1, n), rng.normal(size=n)


def check(term: Term, made: Shell, driver: str = "numpy") -> None:
    """Residual against both tangents (and energy, where there is one) at a disturbed state."""
    q, v = disturbed(made)
    scale = np.full(len(q), 0.2 * made.model.length)
    model = replace(made.model, driver=driver_of(driver))
    assert_derivatives(
        term, lambda x, u: state(made, x, u), q, v, model, driver=model.driver, scale=scale, seed=1
    )


def shell_load_cases() -> dict[str, TermCase]:
    """One tiny instance of every load that turns with a shell."""
    made = shell(CAP, "midedge")
    model, law = made.model, Constant(1.4)
    dofs, frames = model.dofs, model.frames
    assert isinstance(frames, ShellFrames)
    some, edges = CAP.triangles[[0, 3, 7]], np.array([0, 4, 9])
    ends = made.topology.edges[edges]
    force = np.array([0.3, -0.8, 0.5])
    shares = np.array([[0.5, 1.0, 0.0], [0.0, 0.7, 0.1], [0.3, 0.2, 0.9]])
    loads = (
        FollowerForce.of("follower_faces", Faces.of(dofs, some, CAP.nodes), shares, force, law),
        EdgeTorque(
            "edge_torque",
            dofs.of_nodes(ends[:, 0]),
            dofs.of_nodes(ends[:, 1]),
            dofs.of_normals(edges),
            frames.edge_places(edges)[:, :3],
            np.array([[0.3, -0.8, 0.5], [-0.2, 0.6, 0.9], [1.1, 0.1, -0.4]]),
            law,
        ),
        FollowerPressure("pressure", dofs.of_nodes(CAP.triangles).reshape(-1, 9), law),
    )
    return {load.name: TermCase(load, model) for load in loads}
