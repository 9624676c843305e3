"""Three rods and more that are welded are the frame of beams that they are: second order."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beams import Beam, frame_displacements
from decks import Deck, given_section, rod_deck, scalar, solve
from numpy.testing import assert_allclose
from scipy.linalg import expm
from scipy.optimize import brentq

from dismech_cli import load
from dismech_cli.arrays import FloatArray
from dismech_cli.compose.compose import compose
from dismech_cli.compose.structure import skeleton

T = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
NET = np.array([[1.0, 0.2, 0.1], [-0.3, 0.9, 0.4], [-0.6, -0.5, 0.7], [0.1, -0.4, -1.0]])
NET *= (np.array([1.0, 0.8, 1.2, 0.9]) / np.linalg.norm(NET, axis=1))[:, None]
DIRECTOR = [0.3, 0.5, 0.8]


def star(arms: FloatArray, edges: int, bending: tuple[float, float], **keys: Any) -> Deck:
    """Rods from the origin, welded there; all but the last are clamped at their ends."""
    section = given_section(axial=1e5, bending_1=bending[0], bending_2=bending[1], torsion=0.8)
    bodies = [
        {
            "type": "rod",
            "name": f"arm{k}",
            "material": "m",
            "section": section,
            "director": DIRECTOR,
            "generate": {"shape": "line", "from": [0.0, 0.0, 0.0], "to": arm.tolist(), "nodes": edges + 1},
        }
        for k, arm in enumerate(arms)
    ]
    deck = rod_deck(
        {},
        geometry=bodies,
        joints=[{"type": "rigid", "nodes": ["arm0.start", f"arm{k}.start"]} for k in range(1, len(arms))],
        motions=[{"type": "clamp", "where": f"arm{k}.end"} for k in range(len(arms) - 1)],
        numerics={"integrator": {"type": "static", "load_steps": 1}, "newton": {"tolerance": 1e-12}},
        dimension=3,
    )
    return deck | keys


def loaded(arms: FloatArray, load: Any) -> list[Deck]:
    return [{"type": "point", "where": f"arm{len(arms) - 1}.end", "force": np.asarray(load).tolist()}]


def exact_work(arms: FloatArray, load: FloatArray, bending: tuple[float, float]) -> float:
    joints = np.vstack((np.zeros(3), arms))
    last = len(arms)
    beams = [Beam((0, k), DIRECTOR, bending) for k in range(1, last + 1)]
    moved = frame_displacements(joints, beams, range(1, last), {last: load})
    return float(load @ moved[last, :3])


def work(folder: Path, arms: FloatArray, edges: int, load: FloatArray, bending: tuple[float, float]) -> float:
    tiny = 1e-6
    frames = solve(folder, star(arms, edges, bending, forces=loaded(arms, tiny * load))).frames
    return float(load @ (frames[-1].positions[-1] - frames[0].positions[-1])) / tiny


LARGE: Deck = {"integrator": {"type": "static", "load_steps": 4}, "newton": {"tolerance": 1e-11}}
EQUAL, UNEQUAL = (1.0, 1.0), (1.0, 2.5)
# arms, load, stiffness, exact work where known, error of the work at 16 edges per rod
CASES = {
    "t": (T, np.array([1.0, 0.0, 0.0]), EQUAL, 0.458338, 3.02e-3),
    "t-out": (T, np.array([0.0, 0.0, 1.0]), EQUAL, 1.0, 9.77e-4),
    "net": (NET, np.array([1.0, 2.0, -1.0]), EQUAL, 1.988985, 2.84e-3),
    "net-unequal": (NET, np.array([1.0, 2.0, -1.0]), UNEQUAL, None, 2.82e-3),
}


@pytest.mark.parametrize("name", CASES)
def test_work_converges_to_that_of_beams(tmp_path: Path, name: str) -> None:
    arms, load, bending, known, at_16 = CASES[name]
    exact = exact_work(arms, load, bending)
    if known is not None:
        assert_allclose(exact, known, rtol=1e-6)
    errors = [work(tmp_path, arms, n, load, bending) / exact - 1.0 for n in (8, 16, 32)]
    assert_allclose(errors[1], at_16, rtol=1e-2)
    assert (np.log2(np.array(errors[:2]) / errors[1:]) > 1.9).all()


def test_loops_are_frames_too(tmp_path: Path) -> None:
    """A square out of plane with a brace across it: two corners and two hubs, in one loop."""
    joints = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.3], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    sides = [(4, 0), (0, 1), (1, 2), (3, 2), (0, 3), (0, 2)]
    load = np.array([0.4, 0.3, 1.0])
    beams = [Beam(ends, DIRECTOR, UNEQUAL) for ends in sides]
    exact = load @ frame_displacements(joints, beams, [4], {2: load})[2, :3]
    errors = []
    for edges in (8, 16, 32):
        deck = star(joints[[1]], edges, UNEQUAL)
        body = deck["geometry"][0]
        deck["geometry"], deck["joints"] = [], []
        first: dict[int, str] = {}
        for k, ends in enumerate(sides):
            start, end = (joints[j].tolist() for j in ends)
            shape = {"shape": "line", "from": start, "to": end, "nodes": edges + 1}
            deck["geometry"].append(body | {"name": f"r{k}", "generate": shape})
            for joint, place in zip(ends, (f"r{k}.start", f"r{k}.end"), strict=True):
                if joint in first:
                    deck["joints"].append({"type": "rigid", "nodes": [first[joint], place]})
                first.setdefault(joint, place)
        deck["motions"] = [{"type": "clamp", "where": "r0.start"}]
        deck["forces"] = [{"type": "point", "where": "r2.end", "force": (1e-6 * load).tolist()}]
        frames = solve(tmp_path, deck).frames
        at = int(np.argmin(np.linalg.norm(frames[0].positions - joints[2], axis=1)))
        moved = frames[-1].positions[at] - frames[0].positions[at]
        errors.append(float(load @ moved) / 1e-6 / exact - 1.0)
    assert 0.0 < errors[1] < 5e-3
    assert (np.log2(np.array(errors[:2]) / errors[1:]) > 1.9).all()


@pytest.mark.parametrize("load", [[1.5, 0.7, 0.0], [0.0, 3.0, 0.0]], ids=["across", "along"])
def test_a_plane_gives_what_space_gives(tmp_path: Path, load: list[float]) -> None:
    output = {"fields": ["curvature", "bending_moment"], "probes": {"stored": {"energy": "elastic"}}}
    space, plane = (
        solve(tmp_path, star(T, 8, EQUAL, forces=loaded(T, load), numerics=LARGE, output=output) | keys)
        for keys in ({"dimension": 3}, {"dimension": 2, "plane": "xy"})
    )
    assert_allclose(plane.frames[-1].positions, space.frames[-1].positions, atol=1e-9)
    assert_allclose(scalar(plane, "stored"), scalar(space, "stored"), rtol=1e-8, atol=1e-14)
    for field in ("curvature", "bending_moment"):
        assert_allclose(plane.frames[-1].fields[field], space.frames[-1].fields[field], rtol=1e-6, atol=1e-8)


def far(folder: Path, edges: int) -> FloatArray:
    """The tip of the net under a load that moves it by half its length."""
    deck = star(NET, edges, EQUAL, forces=loaded(NET, [1.0, 2.0, -1.0]), numerics=LARGE)
    return solve(folder, deck).frames[-1].positions[-1]


def test_large_rotations_converge(tmp_path: Path) -> None:
    coarse, middle, fine = (far(tmp_path, edges) for edges in (8, 16, 32))
    assert_allclose(np.linalg.norm(fine - NET[-1]), 0.546, rtol=1e-2)
    assert np.linalg.norm(coarse - middle) < 4e-3
    assert np.log2(np.linalg.norm(coarse - middle) / np.linalg.norm(middle - fine)) > 1.9


@pytest.mark.parametrize("length", [0.1, 2.0])
def test_the_stub_may_have_any_length(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, length: float) -> None:
    usual = far(tmp_path, 8)
    monkeypatch.setattr(skeleton, "_STUB", length)
    assert_allclose(far(tmp_path, 8), usual, atol=1e-8)


GROWN = [
    {"curvature_1": 0.6, "curvature_2": -0.5, "twist": 0.7},
    {"curvature_1": -0.4, "curvature_2": 0.8, "twist": 0.5},
    {"curvature_1": 0.3, "curvature_2": 0.6, "twist": -0.4},
]


def grown_end(arms: FloatArray, inward: tuple[bool, ...]) -> FloatArray:
    """Tip of the last arm, grown as all are, with the first one clamped at its far end.

    Frames (t, m1, m2) by rows turn by (twist, -curvature_2, curvature_1) along themselves.
    """
    at_hub = []
    for arm, into in zip(arms, inward, strict=True):
        t = (-arm if into else arm) / np.linalg.norm(arm)
        m1 = np.asarray(DIRECTOR) - t * (t @ DIRECTOR)
        m1 /= np.linalg.norm(m1)
        at_hub.append(np.stack((t, m1, np.cross(t, m1))))
    place, frame = arms[0], at_hub[0]
    last = len(arms) - 1
    for k, towards_hub in ((0, True), (last, False)):
        k1, k2, tau = (GROWN[k][name] for name in ("curvature_1", "curvature_2", "twist"))
        turning = np.array([[0.0, k1, k2], [-k1, 0.0, tau], [-k2, -tau, 0.0]])
        walk = np.linalg.norm(arms[k]) * (1.0 if inward[k] is towards_hub else -1.0)
        moved = expm(walk * np.block([[np.zeros((1, 1)), np.eye(1, 3)], [np.zeros((3, 1)), turning]]))
        place, frame = place + moved[0, 1:] @ frame, moved[1:, 1:] @ frame
        frame = at_hub[last] @ at_hub[0].T @ frame
    return place


@pytest.mark.parametrize("inward", [(False, False, False), (True, False, False), (False, True, True)])
def test_rods_grow_at_a_hub(tmp_path: Path, inward: tuple[bool, ...]) -> None:
    """Each by its own natural strains, whichever way it is drawn; nothing is stressed."""
    arms, errors = NET[:3], []
    for edges in (4, 8, 16):
        deck = star(arms, edges, (1.0, 1.7), output={"probes": {"stored": {"energy": "elastic"}}})
        ends = [("end", "start") if into else ("start", "end") for into in inward]
        deck["joints"] = [
            {"type": "rigid", "nodes": [f"arm0.{ends[0][0]}", f"arm{k}.{ends[k][0]}"]} for k in (1, 2)
        ]
        deck["motions"] = [{"type": "clamp", "where": f"arm0.{ends[0][1]}"}]
        deck["numerics"]["integrator"]["load_steps"] = 5
        for body, into in zip(deck["geometry"], inward, strict=True):
            line = body["generate"]
            if into:
                line["from"], line["to"] = line["to"], line["from"]
        deck["actuation"] = [
            {"type": name, "rod": f"arm{k}", "value": {"table": [[0.0, 0.0], [1.0, value]]}}
            for k, natural in enumerate(GROWN)
            for name, value in natural.items()
        ]
        result = solve(tmp_path, deck)
        assert scalar(result, "stored")[-1] < 1e-18
        rest = result.frames[0].positions
        at = int(np.argmin(np.linalg.norm(rest - arms[-1], axis=1)))
        errors.append(float(np.linalg.norm(result.frames[-1].positions[at] - grown_end(arms, inward))))
    assert errors[2] < 2e-3
    assert (np.log2(np.array(errors[:2]) / errors[1:]) > 1.9).all()


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_hub_is_clamped_at_its_node(tmp_path: Path, dimension: int) -> None:
    """Then every arm is a cantilever."""
    errors = []
    for edges in (8, 16):
        deck = star(T, edges, EQUAL, forces=loaded(T, [1e-6, 0.0, 0.0]))
        deck["motions"] = [{"type": "clamp", "where": "arm0.start"}]
        if dimension == 2:
            deck |= {"dimension": 2, "plane": "xy"}
        moved = solve(tmp_path, deck).frames[-1].positions
        assert_allclose(
            moved[: edges + 1], solve(tmp_path, deck).frames[0].positions[: edges + 1], atol=1e-12
        )
        errors.append(float(moved[-1, 0]) / 1e-6 * 3.0 - 1.0)
    assert 0.0 < errors[1] < 2e-3
    assert np.log2(errors[0] / errors[1]) > 1.9


def test_a_hub_turns_with_the_arm_that_is_held(tmp_path: Path) -> None:
    """A clamp of the hub and the next node of one arm; the displacement moves them all."""
    deck = star(T, 8, EQUAL)
    deck["motions"] = [
        {
            "type": "clamp",
            "where": {"nodes": {"of": "arm0", "range": [0, 1]}},
            "displacement": [{"table": [[0.0, 0.0], [1.0, 0.2]]}, 0.0, 0.0],
        }
    ]
    deck["forces"] = loaded(T, [1e-6, 0.0, 0.0])
    frames = solve(tmp_path, deck).frames
    moved = frames[-1].positions - frames[0].positions - [0.2, 0.0, 0.0]
    assert_allclose(moved[-1, 0], 1e-6 / 3.0, rtol=1e-2)
    assert np.abs(moved[:17]).max() < 1e-12


def dynamic(operator: list[tuple[float, int]], values: list[float], beta: float) -> FloatArray:
    """Coefficients of cos, sin, cosh, sinh(beta s) with given derivatives at given places."""

    def row(s: float, order: int) -> list[float]:
        x = beta * s
        cycle = [np.cos(x), -np.sin(x), -np.cos(x), np.sin(x)]
        hyper = [np.cosh(x), np.sinh(x)]
        scale = beta**order
        return [
            scale * cycle[order % 4],
            scale * cycle[(order - 1) % 4],
            scale * hyper[order % 2],
            scale * hyper[(order + 1) % 2],
        ]

    out: FloatArray = np.linalg.solve([row(*place) for place in operator], values)
    return out


def shape(coefficients: FloatArray, s: FloatArray, beta: float) -> FloatArray:
    x = beta * s
    return np.stack((np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)), axis=1) @ coefficients


# deflection and slope at the hub; moment and shear at the free end, or deflection and slope at the clamp
STEM, ARM = [(0.0, 0), (0.0, 1), (1.0, 2), (1.0, 3)], [(0.0, 0), (0.0, 1), (1.0, 0), (1.0, 1)]
UNIT = [0.0, 1.0, 0.0, 0.0]


def swaying(beta: float) -> float:
    """Moment about the hub of a T of unit beams that sways in its plane, per unit rotation."""

    def moment(beam: list[tuple[float, int]]) -> float:
        cos, _, cosh, _ = dynamic(beam, UNIT, beta)
        return float(beta**2 * (cos - cosh))

    return 2.0 * moment(ARM) + moment(STEM)


def period_ratio(folder: Path, edges: int, beta: float) -> float:
    """Measured over exact angular frequency of the T."""
    omega, s = beta**2, np.linspace(0.0, 1.0, edges + 1)
    arm = 1e-4 * omega * shape(dynamic(ARM, UNIT, beta), s, beta)
    stem = 1e-4 * omega * shape(dynamic(STEM, UNIT, beta), s, beta)
    nothing = np.zeros_like(s)
    # rotation by one about -z: the stem moves along x, the arms along -y and y
    speeds = [(nothing, arm, nothing), (nothing, -arm, nothing), (stem, nothing, nothing)]
    for k, speed in enumerate(speeds):
        np.savetxt(folder / f"v{k}.csv", np.stack(speed, 1), delimiter=",", header="x,y,z", comments="")
    dt, periods = 2.0 * np.pi / omega / 80, 3
    deck = star(T, edges, EQUAL)
    deck["numerics"] = {"integrator": {"type": "newmark"}, "dt": dt, "t_end": (periods + 0.2) * 80 * dt}
    deck["initial_velocity"] = [
        {"where": {"nodes": {"of": f"arm{k}", "range": [1, edges]}}, "velocity": {"file": f"v{k}.csv"}}
        for k in range(3)
    ]
    for k in range(3):
        rows = (folder / f"v{k}.csv").read_text().splitlines()
        (folder / f"v{k}.csv").write_text("\n".join([rows[0], *rows[2:]]) + "\n")
    deck["output"] = {"every": dt, "probes": {"u": {"displacement": "arm2.end", "component": "x"}}}
    result = solve(folder, deck)
    u, t = scalar(result, "u"), np.array([frame.t for frame in result.frames])
    up = np.flatnonzero((u[:-1] < 0.0) & (u[1:] >= 0.0))
    crossings = t[up] - u[up] * (t[up + 1] - t[up]) / (u[up + 1] - u[up])
    measured = 2.0 * np.pi * (len(crossings) - 1) / (crossings[-1] - crossings[0])
    # Newmark's period is longer by (omega dt)^2 / 12
    return float(measured / omega * (1.0 + (omega * dt) ** 2 / 12.0))


def test_frequency_of_a_frame(tmp_path: Path) -> None:
    beta = brentq(swaying, 0.5, 1.8, xtol=1e-13)
    coarse, fine = (period_ratio(tmp_path, edges, beta) - 1.0 for edges in (4, 8))
    # of second order, about a third of (beta h)^2
    assert abs(fine) < (beta / 8.0) ** 2 / 3.0
    assert np.log2(coarse / fine) > 1.9


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_frame_keeps_its_energy(tmp_path: Path, dimension: int) -> None:
    """Flung hard and left alone, by the midpoint rule; the account knows of no other mass than the rods'."""
    deck = star(T, 6, EQUAL)
    deck["motions"] = [{"type": "clamp", "where": "arm0.end"}]
    deck["initial_velocity"] = [{"where": "arm2", "velocity": [1.0, 0.5, 0.7 if dimension == 3 else 0.0]}]
    deck["output"] = {"every": 0.01, "probes": {"e": {"energy": "elastic"}}}
    if dimension == 2:
        deck |= {"dimension": 2, "plane": "xy"}
    drift = []
    for dt in (0.005, 0.0025):
        newton = {"tolerance": 1e-11}
        deck["numerics"] = {
            "integrator": {"type": "implicit_midpoint"},
            "dt": dt,
            "t_end": 0.5,
            "newton": newton,
        }
        result = solve(tmp_path, deck)
        stored = scalar(result, "kinetic") + scalar(result, "elastic")
        assert_allclose(stored - stored[0], scalar(result, "error"), atol=1e-10)
        drift.append(float(np.abs(stored / stored[0] - 1.0).max()))
    parts = [name for name in result.frames[0].scalars if name.startswith("elastic_")]
    assert_allclose(sum(scalar(result, name) for name in parts), scalar(result, "elastic"), rtol=1e-12)
    # the midpoint rule ripples, and gains or loses nothing
    assert drift[0] < 1e-2
    assert drift[1] < 0.6 * drift[0]


def test_nobody_sees_the_frame_of_a_hub(tmp_path: Path) -> None:
    """It has no node in frames, no mass, no weight and no drag."""
    deck = star(T, 6, EQUAL)
    deck["numerics"] = {"integrator": {"type": "implicit_midpoint"}, "dt": 1e-3, "t_end": 2e-3}
    deck["motions"] = []
    deck["forces"] = [
        {"type": "gravity", "acceleration": [0.0, 0.0, -10.0]},
        {"type": "viscous", "coefficient": 0.3},
    ]
    file = tmp_path / "seen.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    made = compose(load(file))
    simulation, geometry = made.simulation, made.geometry
    dofs, n = simulation.model.dofs, 3 * 6 + 1
    assert (dofs.n_nodes, dofs.visible) == (n + 1, n)
    assert len(geometry.nodes) == len(simulation.topology.rest_positions) == n
    mass = simulation.model.mass
    assert_allclose(mass[: dofs.n_positions].sum() / 3.0, 3.0)
    ghost = np.concatenate((dofs.of_nodes(np.array([n])).reshape(-1), dofs.of_angles(np.array([18]))))
    assert_allclose(mass[ghost], 0.0, atol=0.0)
    report = solve(tmp_path, deck)
    assert len(report.frames[-1].positions) == n
    # in free fall it follows: nothing is stressed, and the whole falls as one
    fallen = report.frames[-1].positions - report.frames[0].positions
    assert np.ptp(fallen[:, 2]) < 1e-6 * np.abs(fallen[:, 2]).max()


def test_a_plane_grows_as_space_does(tmp_path: Path) -> None:
    """Driven in its plane, with an arm drawn towards the hub; the planar hub has signs of its own."""
    grown = []
    for keys in ({"dimension": 3}, {"dimension": 2, "plane": "xy"}):
        deck = star(T, 6, EQUAL, numerics=LARGE, **keys)
        for body in deck["geometry"]:
            body["director"] = [0.0, 0.0, 1.0]
        line = deck["geometry"][1]["generate"]
        line["from"], line["to"] = line["to"], line["from"]
        deck["joints"][0]["nodes"][1] = "arm1.end"
        deck["motions"] = deck["motions"][:1]
        deck["actuation"] = [
            {"type": "curvature_2", "rod": f"arm{k}", "value": {"table": [[0.0, 0.0], [1.0, value]]}}
            for k, value in enumerate((0.9, -0.6, 1.2))
        ]
        grown.append(solve(tmp_path, deck).frames[-1].positions)
    space, plane = grown
    assert np.linalg.norm(space[-1] - T[-1]) > 0.2
    assert_allclose(plane, space, atol=1e-9)


def test_a_net_of_one_rod_is_that_of_four(tmp_path: Path) -> None:
    """From a file whose edges branch."""
    edges = 8
    nodes, pairs = ["0, 0, 0"], []
    for k, arm in enumerate(NET):
        for j in range(1, edges + 1):
            nodes.append(", ".join(repr(float(x)) for x in arm * j / edges))
            here = k * edges + j + 1
            # every other arm is drawn towards the hub
            before = 1 if j == 1 else here - 1
            pairs.append((before, here) if k % 2 else (here, before))
    text = "\n".join(["*Nodes", *nodes, "*Edges", *(f"{a}, {b}" for a, b in pairs)])
    (tmp_path / "net.txt").write_text(text + "\n", encoding="utf-8")
    four = star(NET, edges, EQUAL, forces=loaded(NET, [1.0, 2.0, -1.0]), numerics=LARGE)
    body = {key: value for key, value in four["geometry"][0].items() if key not in ("generate", "director")}
    ends = [{"nodes": {"of": "arm0", "indices": [edges * k]}} for k in (1, 2, 3, 4)]
    one = four | {
        "geometry": [body | {"mesh": {"file": "net.txt"}}],
        "joints": [],
        "motions": [{"type": "clamp", "where": where} for where in ends[:3]],
        "forces": [{"type": "point", "where": ends[3], "force": [1.0, 2.0, -1.0]}],
    }
    assert_allclose(
        solve(tmp_path, one).frames[-1].positions, solve(tmp_path, four).frames[-1].positions, atol=1e-8
    )
