"""What the scene needs: every decision made once, with its reason. A pure function.

Only exact reductions are taken: each leaves the answer unchanged and has an equivalence test.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum

import numpy as np

from ...arrays import IntArray
from ...frozen import frozen
from ...kinematics.strains import joint_angles
from ...mesh.topology.rods import ChainKind, chains, rod_stencils
from ...run.tolerance import RTOL
from ...scenario.language.actuation import CurvatureActuation, TwistActuation
from ...scenario.language.contact import BarrierLaw, CompatLaw, PenaltyLaw
from ...scenario.language.force import Distributed, Point
from ...scenario.language.motion import Twist
from ...scenario.language.numerics import GeneralizedAlpha, Numerics, Static
from ...scenario.language.probe import TwistProbe
from ...scenario.language.scenario import Scenario
from ...scenario.language.sensor import CurvatureSensor, TwistSensor
from ...scenario.views.walk import probes
from ..bodies.geometry import Geometry
from ..scene import Scene
from ..shells.bending import bending_of
from ..touching import named_pairs
from .clamps import clamp_words
from .doubts import scene_doubts
from .holds import Hold, twists

# A rest shape counts as straight below this angle between edges [rad]; mesh files carry 1e-10.
_STRAIGHT = 1e-9


class Bending(Enum):
    """Bending models of the rods of a scene."""

    NONE = "no rods: no edge angles, no rod frames"
    PLANAR = "planar: signed curvature, 2 DOFs per node"
    ISOTROPIC = "isotropic: curvature binormal, 3 DOFs per node"
    FRAMED = "framed: material curvatures and twist, 3 DOFs per node and 1 per edge"


@frozen
class Decision:
    """One decision and its reason, as ``dismech check`` prints them."""

    what: str
    why: str


@frozen
class Plan:
    """The shape of the model.

    Attributes:
        axes: Space axes that the model carries.
        bending: Bending model.
        static: Whether mass is left out.
        decisions: What was decided and why.
        warnings: What is allowed but doubtful, each with its place.
        kernels: What runs them, ``numpy`` or ``numba``: chosen once it is known what there is to run.
        compiling: How many modules of their loops are compiled first.
        whole: Whether steps are compiled whole.
    """

    axes: tuple[int, ...]
    bending: Bending
    static: bool
    decisions: tuple[Decision, ...]
    warnings: tuple[str, ...]
    kernels: str = "numpy"
    compiling: int = 0
    whole: bool = False

    def __str__(self) -> str:
        return "\n".join(f"{d.what}: {d.why}" for d in self.decisions)


def make_plan(scene: Scene, holds: tuple[Hold, ...]) -> Plan:
    """Decide.

    Args:
        scene: What was said, and its bodies.
        holds: Its motions.

    Raises:
        ScenarioError: The scene contradicts a choice of the user.
    """
    scenario, geometry = scene.scenario, scene.geometry
    decisions: list[Decision] = []
    axes: tuple[int, ...] = (0, 1, 2)
    if scenario.dimension == 2:
        axes = tuple("xyz".index(c) for c in scenario.plane)
        _check_planar(scene, axes)
        bending = Bending.PLANAR
        decisions.append(Decision(bending.value, f"dimension 2, plane {scenario.plane}"))
    elif geometry.rods:
        bending, why = _bending(scene, holds)
        decisions.append(Decision(bending.value, why))
    else:
        bending = Bending.NONE
        decisions.append(Decision(bending.value, "the scene has shells only"))
    decisions += _shells(geometry)
    decisions += [Decision(*words) for words in clamp_words(scene, holds)]
    static = isinstance(scenario.numerics.integrator, Static)
    if static:
        decisions.append(Decision("no inertia", "static: mass enters the weight only"))
    decisions += _contact(scenario)
    rubs = scenario.contact is not None and scenario.contact.friction is not None
    viscous = rubs or any(material.relaxation_time > 0.0 for material in scenario.materials.values())
    if not viscous and not any(force.velocity_dependent for force in scenario.forces):
        decisions.append(Decision("no damping matrix", "no force depends on velocity"))
    decisions += _adaptive(scenario.numerics)
    return Plan(axes, bending, static, tuple(decisions), tuple(scene_doubts(scene, holds)))


def _adaptive(numerics: Numerics) -> Iterator[Decision]:
    if numerics.adapts:
        why = "no dt is given" if numerics.dt is None else "asked for"
        yield Decision(f"adaptive steps: errors below {numerics.step.rtol or RTOL:g} of the motion", why)


def _contact(scenario: Scenario) -> Iterator[Decision]:
    spec = scenario.contact
    if spec is None:
        return
    pairs = named_pairs(scenario)
    obstacles = {one.name for one in scenario.obstacles}
    among = sum(second not in obstacles for _, second in pairs)
    what = f"contact of {len(pairs) - among} pairs with obstacles and {among} of bodies"
    match spec.law:
        case BarrierLaw(stop=stop, gap=gap):
            yield Decision(
                what,
                f"never nearer than {stop:.3g} of the thickness: forces from {stop + gap:.3g} of it on, and "
                "a barrier in the inner half of that gap",
            )
        case CompatLaw(stiffness=given, width=width):
            yield Decision(
                what,
                f"by the family's law of pairs, {given:g} N/m each from {width:g} m before touching on: the "
                "force depends on the mesh",
            )
        case PenaltyLaw(stiffness=float() as given):
            yield Decision(what, f"as stiff as given, {given:g} Pa, however deep bodies then come")
        case PenaltyLaw(allowed=allowed):
            yield Decision(
                what, f"as stiff as weights and impacts ask for, at most {allowed:.3g} of a thickness deep"
            )
    if scenario.numerics.integrator == GeneralizedAlpha(type="generalized_alpha", spectral_radius=0.0):
        yield Decision(
            "generalized_alpha with spectral radius 0",
            "the default with contact: impacts make no energy, and frames show what is in balance",
        )
    if among:
        yield Decision("a matrix whose pattern grows", "bodies that touch couple nodes anywhere")
    rods = {rod.name for rod in scenario.rods.values()}
    if scenario.dimension == 3 and any(mu > 0.0 and rods & {*pair} for pair, mu in pairs.items()):
        yield Decision(
            "friction acts at the axes of rods",
            "it neither rolls nor twists them: what would roll slides or sticks",
        )


def _check_planar(scene: Scene, axes: tuple[int, ...]) -> None:
    (normal,) = {0, 1, 2}.difference(axes)
    nodes = scene.geometry.nodes
    out = nodes[:, normal]
    size = float(np.ptp(nodes, axis=0).max())
    if np.ptp(out) > 1e-9 * size:
        raise scene.error(
            ("dimension",),
            f"the scene is not planar: nodes spread over {np.ptp(out):.3g} m in {'xyz'[normal]}, "
            f"out of plane {scene.scenario.plane}",
        )


def _bending(scene: Scene, holds: tuple[Hold, ...]) -> tuple[Bending, str]:
    obstacle = _needs_frames(scene, holds)
    for index, rod in scene.scenario.rods.items():
        if rod.bending == "framed":
            return Bending.FRAMED, f"asked for by rod '{rod.name}'"
        if rod.bending == "isotropic" and obstacle:
            raise scene.error(
                ("geometry", index, "bending"), f"isotropic bending is not exact here: {obstacle}"
            )
    if obstacle:
        return Bending.FRAMED, obstacle
    return Bending.ISOTROPIC, (
        "equal bending stiffness, straight natural shape, open chains, nothing turns or holds a rod "
        "about its axis at more than one end: no twist can arise"
    )


def _shells(geometry: Geometry) -> Iterator[Decision]:
    for shell in geometry.shells:
        count = len(geometry.triangles_of(shell.name))
        bending = bending_of(shell)
        if bending.has_normals:
            what = f"mid-edge normals on shell '{shell.name}': one angle per edge of {count} triangles"
        else:
            what = f"no mid-edge normals on shell '{shell.name}': no DOFs beside its nodes"
        yield Decision(what, f"bending: {shell.bending}, {bending.plate}")


def _needs_frames(scene: Scene, holds: tuple[Hold, ...]) -> str:
    """Why twist matters, or nothing."""
    scenario, geometry = scene.scenario, scene.geometry
    for rod, properties in zip(geometry.rods, geometry.properties, strict=True):
        if not properties.isotropic:
            return f"the section of rod '{rod.name}' is stiffer in one direction"
        natural = rod.natural
        if any(value is not None for value in (natural.curvature_1, natural.curvature_2, natural.twist)):
            return f"rod '{rod.name}' has natural curvature or twist"
        if scenario.materials[rod.material].relaxation_time > 0.0 and not isinstance(
            scenario.numerics.integrator, Static
        ):
            return f"the material of rod '{rod.name}' damps curvature as the rod itself sees it"
    hung, places = _hung(geometry)
    triples, _, _ = rod_stencils(len(places), hung)
    if len(triples) and joint_angles(geometry.nodes[places], triples).max() > _STRAIGHT:
        return "a rest shape is curved"
    if any(chain.kind is not ChainKind.OPEN for chain in chains(len(places), hung)):
        return "a rod is closed or branches"
    if any(force.turns_rods for force in scenario.forces):
        return "a moment acts"
    if _follows_a_rod(scene):
        return "a load turns with a rod"
    if any(isinstance(motion, Twist) for motion in scenario.motions) or any(twists(hold) for hold in holds):
        return "a motion turns an edge about the rod"
    if any(isinstance(a, CurvatureActuation | TwistActuation) for a in scenario.actuation):
        return "actuation acts on material curvature or twist"
    if geometry.shell_welds:
        return "a rod is welded to a shell"
    if _most_held(geometry, holds) > 1:
        return "a rod is held in rotation at more than one place"
    if "director" in scenario.output.fields or "twist" in scenario.output.fields:
        return "material directors or twist are written"
    if any(isinstance(sensor, CurvatureSensor | TwistSensor) for sensor in scenario.sensors.values()):
        return "a sensor reads material curvature or twist"
    if any(isinstance(probe, TwistProbe) for _, probe in probes(scenario)):
        return "a probe measures twist"
    return ""


def _follows_a_rod(scene: Scene) -> bool:
    """Whether a load turns with an edge of a rod."""
    for index, force in enumerate(scene.scenario.forces):
        if isinstance(force, Distributed) and force.follower:
            return True
        if isinstance(force, Point) and force.follower:
            nodes = scene.places.nodes(("forces", index, "where"))
            if np.isin(nodes, scene.geometry.edges).any():
                return True
    return False


def _most_held(geometry: Geometry, holds: tuple[Hold, ...]) -> int:
    """Largest number of places at which one chain is held in rotation: runs of held edges, walls."""
    held = np.zeros(len(geometry.edges), dtype=bool)
    walls = np.zeros(len(geometry.nodes), dtype=bool)
    for hold in holds:
        held[hold.edges] = True
        walls[hold.walls] = True
    most = 0
    hung, places = _hung(geometry)
    for chain in chains(len(places), hung):
        first, last = places[chain.nodes[[0, -1]]]
        along = np.concatenate(([False, walls[first]], held[chain.edges], [walls[last]]))
        most = max(most, int((along[1:] & ~along[:-1]).sum()))
    return most


def _hung(geometry: Geometry) -> tuple[IntArray, IntArray]:
    """Edges by nodes that they share only where bending or twist passes, (E, 2), and the nodes of these."""
    hung = geometry.turning.hanging()
    places = np.zeros(int(hung.max(initial=-1)) + 1, dtype=np.int64)
    places[hung] = geometry.edges
    return hung, places
