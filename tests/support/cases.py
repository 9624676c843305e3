"""Tiny instances of every mechanical term and of whole rod models, made without any scenario."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.energies.bend_isotropic import BEND_ISOTROPIC
from dismech_cli.energies.bend_planar import BEND_PLANAR, CORNER_PLANAR
from dismech_cli.energies.bend_twist import BEND_TWIST
from dismech_cli.energies.rigid_joint import COSINES, RIGID_JOINT, STIFFNESS
from dismech_cli.energies.stretch import STRETCH, STRETCH_PLANAR
from dismech_cli.forces.follower import Carrier, FollowerForce, FramedEdges, PlanarEdges
from dismech_cli.forces.gravity import weight
from dismech_cli.forces.load import DeadLoad
from dismech_cli.forces.moment import EdgeMoment
from dismech_cli.forces.resistive import resistive_force
from dismech_cli.forces.viscous import ViscousDamping
from dismech_cli.kernels.driver import Driver
from dismech_cli.kernels.numpy_driver import NumpyDriver
from dismech_cli.kinematics.directors import space_parallel
from dismech_cli.kinematics.dofs import DofMap
from dismech_cli.kinematics.motion import Motion
from dismech_cli.kinematics.rod_frames import Frames, FrameState, NoFrames, RodFrames
from dismech_cli.laws.field import Spatial
from dismech_cli.laws.laws import Constant, Law
from dismech_cli.mesh.topology.rods import rod_stencils
from dismech_cli.model.configuration import Configuration
from dismech_cli.model.flow import DragInFlow
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy
from dismech_cli.model.term import Term
from dismech_cli.sections.mass import rod_mass
from dismech_cli.sections.rods import RodProperties, rod_properties, round_section

NUMPY = NumpyDriver()

SILICONE = rod_properties(round_section(1e-3), youngs_modulus=2e6, poisson_ratio=0.5, density=1200.0)
"""A round silicone rod of 1 mm radius."""

UNEQUAL = RodProperties(
    axial=3.0,
    bending_1=0.7,
    bending_2=1.9,
    torsional=0.4,
    mass_per_length=1.3,
    polar_per_length=0.02,
    area=1.0,
    radius=0.1,
)
"""Numbers of order one, all different: no symmetry of the section hides a mistake."""


def properties(axial: float, bending: float, torsional: float, mass_per_length: float) -> RodProperties:
    """A round rod given by its stiffnesses."""
    return RodProperties(
        axial=axial,
        bending_1=bending,
        bending_2=bending,
        torsional=torsional,
        mass_per_length=mass_per_length,
        polar_per_length=0.01 * mass_per_length,
        area=1.0,
        radius=0.1,
    )


# ---------------------------------------------------------------- shapes


def chain(nodes: int) -> IntArray:
    """Edges of an open chain."""
    first = np.arange(nodes - 1)
    return np.stack((first, first + 1), axis=1)


def straight(nodes: int, length: float = 0.1) -> tuple[FloatArray, IntArray]:
    """A rod along x."""
    x = np.zeros((nodes, 3))
    x[:, 0] = np.linspace(0.0, length, nodes)
    return x, chain(nodes)


def helix(nodes: int) -> tuple[FloatArray, IntArray]:
    """A rod curved and twisted in space, with edges of unequal length."""
    s = np.linspace(0.0, 2.0, nodes) ** 1.1
    return np.stack((np.cos(s), np.sin(s), 0.4 * s), axis=1), chain(nodes)


def ring(nodes: int) -> tuple[FloatArray, IntArray]:
    """A closed circle of radius 1 in the xz plane."""
    s = 2.0 * np.pi * np.arange(nodes) / nodes
    first = np.arange(nodes)
    edges = np.stack((first, (first + 1) % nodes), axis=1)
    return np.stack((np.cos(s), np.zeros(nodes), np.sin(s)), axis=1), edges


def y_network() -> tuple[FloatArray, IntArray]:
    """Three arms at a joint; edges point into it and out of it, so both signs occur."""
    x = np.array(
        [
            [0.0, 0.0, 0.0],
            [1.0, 0.1, 0.0],
            [1.9, 0.0, 0.3],
            [-0.6, 0.9, 0.1],
            [-1.1, 1.6, -0.2],
            [-0.5, -0.8, 0.2],
            [-0.9, -1.9, 0.1],
        ]
    )
    return x, np.array([[0, 1], [2, 1], [3, 0], [4, 3], [5, 0], [5, 6]])


# ---------------------------------------------------------------- models


def _lengths(nodes: FloatArray, edges: IntArray) -> FloatArray:
    return np.linalg.norm(nodes[edges[:, 1]] - nodes[edges[:, 0]], axis=1)


def _assemble(
    dofs: DofMap,
    nodes: FloatArray,
    edges: IntArray,
    rod: RodProperties,
    terms: tuple[Term, ...],
    frames: Frames,
    driver: Driver,
) -> Model:
    lengths = _lengths(nodes, edges)
    rest = np.zeros(dofs.n)
    rest[: dofs.n_positions] = dofs.project(nodes).reshape(-1)
    count = len(edges)
    mass = rod_mass(
        dofs, edges, lengths, np.full(count, rod.mass_per_length), np.full(count, rod.polar_per_length)
    )
    return Model(dofs, rest, mass, terms, (), frames, driver, float(lengths.mean()))


def planar_curvature(e: FloatArray, f: FloatArray) -> FloatArray:
    """2 tan(phi/2) of edge vectors (S, 2), by the turning angle itself."""
    phi = np.arctan2(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0], (e * f).sum(axis=1))
    return 2.0 * np.tan(0.5 * phi)


def planar_rod(
    nodes: FloatArray, edges: IntArray, rod: RodProperties = SILICONE, *, driver: Driver = NUMPY
) -> Model:
    """Model of a rod in the xz plane, at rest in the given shape."""
    dofs = DofMap(len(nodes), 0, (0, 2), len(nodes))
    lengths, flat = _lengths(nodes, edges), dofs.project(nodes)
    triples, pairs, _ = rod_stencils(len(nodes), edges)
    voronoi = lengths[pairs].mean(axis=1)
    curvature = planar_curvature(
        flat[triples[:, 1]] - flat[triples[:, 0]], flat[triples[:, 2]] - flat[triples[:, 1]]
    )
    terms: tuple[Term, ...] = (
        StencilEnergy.of(
            "stretch",
            STRETCH_PLANAR,
            dofs.of_nodes(edges).reshape(len(edges), -1),
            {"eps": 0.0, "EA": rod.axial, "length": lengths},
        ),
        StencilEnergy.of(
            "bend",
            BEND_PLANAR,
            dofs.of_nodes(triples).reshape(len(triples), 3 * dofs.dimension),
            {"kappa": curvature, "EI": rod.bending_1, "voronoi": voronoi},
        ),
    )
    return _assemble(dofs, nodes, edges, rod, terms, NoFrames(), driver)


def isotropic_rod(
    nodes: FloatArray, edges: IntArray, rod: RodProperties = SILICONE, *, driver: Driver = NUMPY
) -> Model:
    """Model of a naturally straight rod without frames."""
    dofs = DofMap(len(nodes), 0, (0, 1, 2), len(nodes))
    lengths = _lengths(nodes, edges)
    triples, pairs, _ = rod_stencils(len(nodes), edges)
    terms: tuple[Term, ...] = (
        StencilEnergy.of(
            "stretch",
            STRETCH,
            dofs.of_nodes(edges).reshape(len(edges), -1),
            {"eps": 0.0, "EA": rod.axial, "length": lengths},
        ),
        StencilEnergy.of(
            "bend",
            BEND_ISOTROPIC,
            dofs.of_nodes(triples).reshape(len(triples), 3 * dofs.dimension),
            {"EI": rod.bending_1, "voronoi": lengths[pairs].mean(axis=1)},
        ),
    )
    return _assemble(dofs, nodes, edges, rod, terms, NoFrames(), driver)


def framed_rod(
    nodes: FloatArray,
    edges: IntArray,
    rod: RodProperties = SILICONE,
    *,
    driver: Driver = NUMPY,
    directors: FloatArray | None = None,
) -> Model:
    """Model of a discrete elastic rod or network, stress-free in the given shape."""
    n_edges = len(edges)
    dofs = DofMap(len(nodes), n_edges, (0, 1, 2), len(nodes))
    lengths = _lengths(nodes, edges)
    triples, pairs, signs = rod_stencils(len(nodes), edges)
    count = len(triples)
    tangents = ((nodes[edges[:, 1]] - nodes[edges[:, 0]]) / lengths[:, None]).T
    frames = RodFrames(
        np.ascontiguousarray(dofs.of_nodes(edges[:, 0]).T),
        np.ascontiguousarray(dofs.of_nodes(edges[:, 1]).T),
        dofs.of_angles(np.arange(n_edges)),
        pairs,
        signs.astype(np.float64),
        space_parallel(tangents, np.full((3, n_edges), np.nan) if directors is None else directors.T),
        driver,
    )
    rest = np.concatenate((nodes.reshape(-1), np.zeros(n_edges)))
    stored = frames.rest(rest)
    auxiliary = frames.transport(stored, rest).auxiliary
    places = frames.director_places(pairs)
    m1, m2 = np.moveaxis(auxiliary[places].reshape(count, 2, 2, 3), 2, 0)
    kappa = material_curvatures(nodes[triples], m1, signs[:, :, None] * m2, stored.reference_twist)
    voronoi = lengths[pairs].mean(axis=1)
    joint_dofs = np.concatenate((dofs.of_nodes(triples).reshape(count, 9), dofs.of_angles(pairs)), axis=1)
    terms: tuple[Term, ...] = (
        StencilEnergy.of(
            "stretch",
            STRETCH,
            dofs.of_nodes(edges).reshape(n_edges, -1),
            {"eps": 0.0, "EA": rod.axial, "length": lengths},
        ),
        StencilEnergy.of(
            "bend_twist",
            BEND_TWIST,
            joint_dofs,
            {
                "kappa_1": kappa[0],
                "kappa_2": kappa[1],
                "twist": stored.reference_twist,
                "EI_1": rod.bending_1,
                "EI_2": rod.bending_2,
                "GJ": rod.torsional,
                "voronoi": voronoi,
                "sign_e": signs[:, 0],
                "sign_f": signs[:, 1],
                "cos_psi": 1.0,
                "sin_psi": 0.0,
                "psi": 0.0,
            },
            np.column_stack((places.reshape(count, 12), frames.twist_places(np.arange(count)))),
        ),
    )
    return _assemble(dofs, nodes, edges, rod, terms, frames, driver)


def material_curvatures(
    triples: FloatArray, m1: FloatArray, m2: FloatArray, twist: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Both material curvatures by Bergou's formula, the mean director stretched to unit length.

    Args:
        triples: Node positions of each stencil, shape (S, 3, 3).
        m1: First directors of both edges, shape (S, 2, 3).
        m2: Second directors, with the sign of the edge, shape (S, 2, 3).
        twist: Of the directors of the second edge against those of the first [rad], shape (S,).
    """
    e, f = triples[:, 1] - triples[:, 0], triples[:, 2] - triples[:, 1]
    te, tf = (x / np.linalg.norm(x, axis=1)[:, None] for x in (e, f))
    binormal = 2.0 * np.cross(te, tf) / (1.0 + (te * tf).sum(axis=1))[:, None]
    half = 0.5 / np.cos(0.5 * twist)
    return half * (binormal * m2.sum(axis=1)).sum(axis=1), -half * (binormal * m1.sum(axis=1)).sum(axis=1)


def only_bending(term: StencilEnergy) -> StencilEnergy:
    """A framed joint without resistance to twist."""
    return term.having({"GJ": 0.0})


def only_twist(term: StencilEnergy) -> StencilEnergy:
    """A framed joint without resistance to bending."""
    return term.having({"EI_1": 0.0, "EI_2": 0.0})


FULL_STIFFNESS = np.array([[1.7, 0.3, -0.5], [0.3, 0.7, 0.1], [-0.5, 0.1, 1.4]])
"""Positive, and no component vanishes."""


def rigid_joints(model: Model, stiffness: FloatArray = FULL_STIFFNESS) -> StencilEnergy:
    """The joints of a framed model as rigid joints, stress-free in its rest shape.

    Args:
        model: The rod or network.
        stiffness: Of every joint [N m], shape (3, 3).
    """
    plain = energy_of(model, "bend_twist")
    places = plain.auxiliaries[:, :12]
    signs = np.stack((plain.parameter("sign_e"), plain.parameter("sign_f")))
    a = model.frames.transport(model.frames.rest(model.rest), model.rest).auxiliary[places]
    x = model.rest[plain.dofs[:, :9]].reshape(-1, 3, 3)
    e, f = (
        np.stack((walked / np.linalg.norm(walked, axis=1)[:, None], m1, sign[:, None] * m2), axis=1)
        for walked, m1, m2, sign in (
            (x[:, 1] - x[:, 0], a[:, 0:3], a[:, 3:6], signs[0]),
            (x[:, 2] - x[:, 1], a[:, 6:9], a[:, 9:12], signs[1]),
        )
    )
    cosines = np.einsum("sic,sjc->ijs", e, f).reshape(9, -1)
    parameters = {
        **dict.fromkeys(RIGID_JOINT.naturals, 0.0),
        **dict(zip(STIFFNESS, stiffness[np.triu_indices(3)], strict=True)),
        **dict(zip(COSINES, cosines, strict=True)),
        "sign_e": signs[0],
        "sign_f": signs[1],
        "twist_e": 0.2,
        "twist_f": 0.1,
    }
    return StencilEnergy.of("joint", RIGID_JOINT, plain.dofs, parameters, places)


def planar_corners(model: Model) -> StencilEnergy:
    """The joints of a planar model as corners, bent beyond their angles at rest."""
    plain = energy_of(model, "bend")
    angle = 2.0 * np.arctan(0.5 * plain.parameter("kappa"))
    values = {name: plain.parameter(name) for name in ("EI", "voronoi")}
    parameters = values | {"kappa": 0.3, "cos_phi0": np.cos(angle), "sin_phi0": np.sin(angle)}
    return StencilEnergy.of("corner", CORNER_PLANAR, plain.dofs, parameters)


MODELS: dict[str, Callable[..., Model]] = {
    "planar": planar_rod,
    "isotropic": isotropic_rod,
    "framed": framed_rod,
}


def clamped(model: Model, nodes: tuple[int, ...], edges: tuple[int, ...] = ()) -> Model:
    """Hold nodes, and the angles of edges where there are any, at their rest values."""
    held = model.dofs.of_nodes(np.array(nodes)).reshape(-1)
    if model.dofs.n_angles:
        held = np.concatenate((held, model.dofs.of_angles(np.array(edges, dtype=np.int64))))
    motion = Motion(f"clamp {nodes}", held, model.rest[held], Constant(0.0))
    return replace(model, motions=(*model.motions, motion))


def with_term(model: Model, term: Term) -> Model:
    """Add a term."""
    return replace(model, terms=(*model.terms, term))


def weighted(model: Model, acceleration: tuple[float, float, float], law: Law) -> Model:
    """Add gravity."""
    dofs = model.dofs
    nodal = model.mass[: dofs.n_positions : dofs.dimension]
    return with_term(model, DeadLoad("gravity", weight(dofs, nodal, np.array(acceleration)), law))


def massless(model: Model) -> Model:
    """The static model."""
    return replace(model, mass=np.zeros_like(model.mass))


def cantilever(
    kind: str, nodes: int = 21, length: float = 0.1, rod: RodProperties = SILICONE, driver: Driver = NUMPY
) -> Model:
    """A straight rod along x, clamped at its first edge."""
    x, edges = straight(nodes, length)
    return clamped(MODELS[kind](x, edges, rod, driver=driver), (0, 1), (0,))


def configuration(
    model: Model, q: FloatArray, v: FloatArray, stored: FrameState, t: float = 0.3
) -> Configuration:
    """Trial point at ``q`` with frames transported from the stored ones."""
    return Configuration(t, q, v, model.frames.transport(stored, q))


def adapted(model: Model, q: FloatArray, steps: int = 8) -> FrameState:
    """Frames stored at ``q``, carried there from rest along a straight path in small steps."""
    stored = model.frames.rest(model.rest)
    for s in np.linspace(0.0, 1.0, steps + 1)[1:]:
        stored = model.frames.transport(stored, (1.0 - s) * model.rest + s * q).state
    return stored


def disturbed(model: Model, seed: int, size: float = 0.2) -> FloatArray:
    """A random state near rest: nodes moved by a part of an edge, edges turned by about ``size``."""
    noise = np.random.default_rng(seed).normal(size=model.dofs.n)
    noise[: model.dofs.n_positions] *= model.length
    return model.rest + size * noise


# ---------------------------------------------------------------- one case per term


@dataclass(frozen=True, slots=True)
class TermCase:
    """A term and a small model whose numbering and frames it uses."""

    term: Term
    model: Model


def energy_of(model: Model, name: str) -> StencilEnergy:
    """The named energy of a model."""
    return next(t for t in model.terms if t.name == name and isinstance(t, StencilEnergy))


def _of(model: Model, name: str) -> TermCase:
    return TermCase(energy_of(model, name), model)


def _with(model: Model, build: Callable[[Model], Term]) -> TermCase:
    return TermCase(build(model), model)


def _dead_load(model: Model) -> Term:
    return DeadLoad("load", np.linspace(-1.0, 2.0, model.dofs.n), Constant(0.7))


def _viscous(model: Model) -> Term:
    nodes = np.arange(model.dofs.n_nodes)
    return ViscousDamping("viscous", model.dofs.of_nodes(nodes), np.linspace(0.5, 1.5, len(nodes)))


def _flowing(drag: Callable[[Model], Term], *texts: str) -> Callable[[Model], Term]:
    def build(model: Model) -> Term:
        return DragInFlow(drag(model), [Spatial(text) for text in texts], model.dofs)

    return build


def _resistive(edges: IntArray) -> Callable[[Model], Term]:
    def build(model: Model) -> Term:
        lengths = np.linspace(0.8, 1.2, len(edges))
        return resistive_force("drag", model.dofs, edges, lengths, tangential=0.3, normal=1.1)

    return build


def _moment(edges: IntArray) -> Callable[[Model], Term]:
    def build(model: Model) -> Term:
        dofs, loaded = model.dofs, np.array([0, 2])
        return EdgeMoment(
            "moment",
            dofs.of_nodes(edges[loaded, 0]),
            dofs.of_nodes(edges[loaded, 1]),
            dofs.of_angles(loaded) if dofs.n_angles else np.empty(0, dtype=np.int64),
            dofs.axes,
            np.array([[0.3, -0.8, 0.5], [-0.2, 0.6, 0.9]]),
            Constant(1.4),
        )

    return build


def _follower(edges: IntArray) -> Callable[[Model], Term]:
    def build(model: Model) -> Term:
        dofs, loaded = model.dofs, np.array([0, 2, 3])
        nodes = np.zeros((dofs.n_nodes, 3))
        nodes[:, list(dofs.axes)] = dofs.positions(model.rest)
        if dofs.n_angles:
            assert isinstance(model.frames, RodFrames)
            carrier: Carrier = FramedEdges.of(dofs, model.frames, loaded, model.rest)
        else:
            carrier = PlanarEdges.of(dofs, edges[loaded], nodes)
        shares = np.array([[0.5, 1.0], [0.0, 0.7], [0.3, 0.2]])
        force = dofs.embed(dofs.project(np.array([[0.3, -0.8, 0.5]])))[0]
        return FollowerForce.of("follower", carrier, shares, force, Constant(1.4))

    return build


def term_cases() -> dict[str, TermCase]:
    """One tiny instance of every term; networks where joints need both signs."""
    flat, chain5 = ring(7)[0][:5], chain(5)
    curved = framed_rod(*helix(5), UNEQUAL)
    network = framed_rod(*y_network(), UNEQUAL)
    planar = planar_rod(flat, chain5, UNEQUAL)
    space = isotropic_rod(*helix(5), UNEQUAL)
    edges = y_network()[1]
    return {
        "stretch": _of(network, "stretch"),
        "stretch_planar": _of(planar, "stretch"),
        "bend_planar": _of(planar, "bend"),
        "corner_planar": TermCase(planar_corners(planar), planar),
        "bend_isotropic": _of(space, "bend"),
        "bend_twist": _of(curved, "bend_twist"),
        "bend_twist_network": _of(network, "bend_twist"),
        "bend_framed": TermCase(only_bending(energy_of(curved, "bend_twist")), curved),
        "bend_framed_network": TermCase(only_bending(energy_of(network, "bend_twist")), network),
        "twist": TermCase(only_twist(energy_of(curved, "bend_twist")), curved),
        "twist_network": TermCase(only_twist(energy_of(network, "bend_twist")), network),
        "rigid_joint": TermCase(rigid_joints(curved), curved),
        "rigid_joint_network": TermCase(rigid_joints(network), network),
        "dead_load": _with(planar, _dead_load),
        "viscous": _with(space, _viscous),
        "resistive": _with(space, _resistive(chain5)),
        "resistive_network": _with(network, _resistive(edges)),
        "resistive_planar": _with(planar, _resistive(chain5)),
        "viscous_in_wind": _with(space, _flowing(_viscous, "1 + t", "0.3", "-2*t")),
        "viscous_in_shear": _with(space, _flowing(_viscous, "0.7*z*x", "sin(3*x) - y", "t*x**2")),
        "resistive_in_vortex": _with(network, _flowing(_resistive(edges), "-y*t", "x", "0.2*x*z")),
        "resistive_in_shear": _with(planar, _flowing(_resistive(chain5), "0.4*z**2", "tanh(x)")),
        "follower_framed": _with(network, _follower(edges)),
        "follower_planar": _with(planar, _follower(chain5)),
        "moment": _with(space, _moment(chain5)),
        "moment_framed": _with(network, _moment(edges)),
        "moment_planar": _with(planar, _moment(chain5)),
    }


def rotation(seed: int) -> FloatArray:
    """A proper rotation matrix."""
    r, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return r * np.sign(np.linalg.det(r))
