"""Rods: threads, catheters, guide wires."""
import numpy as np
import pytest

import filasofia as fs


def thread(**fields):
    return fs.RodBodyDef(
        **{
            "name": "silk",
            "points": [(0, 0.05, 0), (0.1, 0.05, 0)],
            "spacing": 2e-3,
            "radius": 0.3e-3,
            "young_modulus": 2e7,
            "attachments": [fs.AttachmentDef(nodes=[0, 1])],
            **fields,
        }
    )


def test_a_clamped_thread_sags_and_keeps_its_length():
    sim = fs.Simulation()
    rod = sim.add(thread())
    for _ in range(200):
        sim.step()
    body = sim.frame[rod]
    assert body.positions.shape == (51, 3)
    assert body.directors.shape == (50, 3)
    edges = np.diff(body.positions, axis=0)
    assert np.allclose(np.linalg.norm(edges, axis=1), 2e-3, rtol=1e-3)
    assert np.allclose(np.einsum("ij,ij->i", edges, body.directors), 0, atol=1e-9)
    assert body.positions[-1, 1] < 0.049
    assert tuple(body.positions[0]) == (0, 0.05, 0)
    assert sim.definition(rod).spacing == 2e-3


def test_a_thread_falls_on_a_table_and_is_the_same_again_after_a_restore():
    sim = fs.Simulation()
    table = fs.RigidBodyDef(
        name="table", mesh=fs.shapes.box((0.4, 0.01, 0.4)), elements=[fs.Pose((0, 0.04, 0))], collision=[fs.CollisionDef()]
    )
    sim.add(table)
    rod = sim.add(thread(attachments=[], collision=fs.RodCollision()))
    for _ in range(100):
        sim.step()
    saved = sim.save_state()
    for _ in range(20):
        sim.step()
    after = sim.state_hash
    sim.restore(saved)
    for _ in range(20):
        sim.step()
    assert sim.state_hash == after
    assert sim.frame[rod].positions[:, 1].min() > 0.045


def test_a_hand_that_turns_a_thread_feels_its_moment():
    sim = fs.Simulation()
    hand = sim.add(fs.RigidBodyDef(name="hand", elements=[fs.Pose((0, 0.05, 0))]))
    ends = [fs.AttachmentDef(nodes=[49, 50]), fs.AttachmentDef(nodes=[0, 1], to=hand)]
    rod = sim.add(thread(gravity=False, attachments=ends))
    for i in range(300):
        half = 0.5 * min(2.0, 0.02 * i)
        sim.set_pose(hand, fs.Pose((0, 0.05, 0), (np.cos(half), np.sin(half), 0, 0)))
        sim.step()
    held = sim.frame.attachments
    held = held[held["to"] != 0][0]
    radius, length = 0.3e-3, 0.1 - 2 * 2e-3  # what is clamped does not twist
    torsion = 2e7 / (2 * 1.4) * np.pi * radius**4 / 2
    assert held["torque"] == pytest.approx([torsion * 2.0 / length, 0, 0], rel=1e-2, abs=1e-9)
    assert sim.frame[rod].directors.shape == (50, 3)


def test_a_ring_has_as_many_edges_as_nodes_and_keeps_its_twist():
    sim = fs.Simulation()
    angle = 2 * np.pi * np.arange(40) / 40
    points = np.stack([0.02 * np.cos(angle), 0.02 * np.sin(angle), 0 * angle], axis=1)
    ring = sim.add(
        fs.RodBodyDef(name="ring", points=points, closed=True, straight=False, twist=1.0, radius=5e-4, gravity=False)
    )
    for _ in range(20):
        sim.step()
    body = sim.frame[ring]
    assert body.positions.shape == body.directors.shape == (40, 3)
    assert np.allclose(np.linalg.norm(body.positions - np.roll(body.positions, 1, axis=0), axis=1), 0.003138, atol=1e-5)


def test_a_tip_bends_as_commanded_and_a_wire_stays_bent():
    sim = fs.Simulation()
    rod = sim.add(thread(gravity=False, rayleigh=fs.Rayleigh(mass=20)))
    sim.set_curvature(rod, [fs.RodSection(begin=0.05, curvature=(0, 20))])
    for _ in range(600):
        sim.step()
    assert sim.frame[rod].positions[-1, 2] > 0.01
    sim.apply(fs.SetCurvature(id=rod))
    for _ in range(2500):  # the heavily damped tip comes back slowly
        sim.step()
    assert np.allclose(sim.frame[rod].positions[-1], (0.1, 0.05, 0), atol=1e-4)
    with pytest.raises(fs.Error, match="rod 'silk': sections\\[0\\].end must be at most 0.1 m"):
        sim.set_curvature(rod, [fs.RodSection(end=1.0)])

    wire = sim.add(thread(name="wire", yield_strain=1e-3))
    for _ in range(100):
        sim.step()
    assert sim.definition(wire).yield_strain == 1e-3


def test_a_thread_that_tears_says_where():
    sim = fs.Simulation()
    rod = sim.add(thread(dynamic_topology=True, break_force=1e-4, forces=[fs.NodalForce(node=50, force=(1e-3, 0, 0))]))
    for _ in range(50):
        sim.step()
    assert len(sim.frame[rod].cut_edges) >= 1
    assert sim.frame[rod].cut_edges.dtype == np.int32


def test_errors_name_the_rod():
    sim = fs.Simulation()
    with pytest.raises(fs.Error, match="rod 'silk': points must have at least 2 entries"):
        sim.add(thread(points=[]))
    with pytest.raises(fs.Error, match="radius must be > 0 m, got 0"):
        sim.add(thread(radius=0.0))
