"""Hands that tie knots."""
import math

import filasofia as fs
import pytest
from filasofia import shapes


def thread_below_bars(first, last, straight=True):
    """Two bars, and a thread below both whose ends stand up."""
    sim = fs.Simulation(rate=1000, threads=1)
    for x in (-4e-3, 4e-3):
        sim.add(fs.RigidBodyDef(mesh=shapes.cylinder(2e-3, 40e-3, 16), elements=[fs.Pose((x, -2e-3, 0), fs.axis_angle((1, 0, 0), math.pi / 2))],
                                collision=[fs.CollisionDef(proximity=1e-4)], friction=0.05))
    points = [first, (-6.4e-3, -2e-3, 0), (-5.8e-3, -3.8e-3, 0), (-4e-3, -4.5e-3, 0), (4e-3, -4.5e-3, 0),
              (5.8e-3, -3.8e-3, 0), (6.4e-3, -2e-3, 0), last]
    thread = sim.add(fs.RodBodyDef(points=points, straight=straight, spacing=0.4e-3, radius=0.15e-3, young_modulus=50e6, gravity=False,
                                   yield_strain=0.1, rayleigh=fs.Rayleigh(mass=20), friction=0.3, collision=fs.RodCollision(),
                                   attachments=[fs.AttachmentDef(ball=fs.Ball((0, -4.5e-3, 0), 0.3e-3))]))
    return sim, thread


def bars(**fields):
    """Two bars, a thread below both whose ends stand up, and hands for a single throw."""
    sim, thread = thread_below_bars((-21.4e-3, 50e-3, 0), (15.4e-3, 30e-3, 0))
    knot = fs.KnotDef(thread=thread, place=(0, 0.5e-3, 0), turns=[1], force=0.6, holding=0.15, speed=0.3)
    return sim, thread, fs.KnotHands(sim, knot.replace(**fields))


def test_hands_tie_a_throw_and_let_go_with_the_same_bits_after_a_state():
    sim, thread, hands = bars()
    sim.step(10)
    assert (hands.tied, hands.done) == (0, False) and len(hands.hands) == 2
    hands.begin()
    sim.step(300)
    state = sim.save_state()
    sim.step(100)
    expected = sim.state_hash
    sim.restore(state)
    sim.step(100)
    assert sim.state_hash == expected
    for _ in range(60):
        if hands.done:
            break
        sim.step(100)
    assert hands.done and hands.tied == 1
    assert 0.5 < hands.largest_force < 1.0
    held = len(sim.frame.attachments)
    hands.release()
    sim.step(2)
    assert len(sim.frame.attachments) == held - 2


def test_wrong_knots_are_errors():
    sim, thread, _ = bars()
    bar = sim.bodies[0]
    for fields, says in [({"thread": bar}, "knot 'knot': thread must be a rod"), ({"nodes": [0]}, "nodes must be two or none, got 1"),
                         ({"turns": []}, "turns must have at least one entry"), ({"height": 1e-3}, "height must be > loop")]:
        with pytest.raises(fs.Error, match=says):
            fs.KnotHands(sim, fs.KnotDef(thread=thread).replace(**fields))
    with pytest.raises(fs.Error, match="KnotDef: force must be > 0 N"):
        fs.KnotDef(force=0)


def test_a_needle_driver_comes_and_lets_go_with_the_same_bits_after_a_state():
    sim, thread = thread_below_bars((-34.9e-3, 85.4e-3, 23.75e-3), (37.7e-3, 30.2e-3, 0), straight=False)
    tie = fs.InstrumentTie(sim, fs.InstrumentTieDef(thread=thread, nodes=[0, 382], place=(0, 0.5e-3, 0), turns=[1]))
    sim.step(10)
    assert (tie.tied, tie.done, tie.failed, tie.largest_force) == (0, False, False, 0)
    assert tie.hand in sim.bodies and tie.driver in sim.bodies
    tie.begin()
    sim.step(300)
    state = sim.save_state()
    sim.step(200)
    expected = sim.state_hash
    sim.restore(state)
    sim.step(200)
    assert sim.state_hash == expected
    assert 0.01 < tie.largest_force < 1.0
    held = len(sim.frame.attachments)
    tie.release()
    sim.step(2)
    assert len(sim.frame.attachments) == held - 3  # the hand, and two fingers of an assistant


def test_wrong_ties_are_errors():
    sim, thread, _ = bars()
    for fields, says in [({"turns": []}, "turns must have"), ({"nodes": [0]}, "nodes must be two or none, got 1"),
                         ({"driver": fs.ArticulatedInstrumentDef(grasps=False)}, "driver.grasps must be true")]:
        with pytest.raises(fs.Error, match=says):
            fs.InstrumentTie(sim, fs.InstrumentTieDef(thread=thread).replace(**fields))
    with pytest.raises(fs.Error, match="InstrumentTieDef: force must be > 0 N"):
        fs.InstrumentTieDef(force=0)
