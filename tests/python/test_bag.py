"""A specimen bag on a body with two arms."""
import filasofia as fs
import numpy as np
import pytest

GRAVITY = 9.81
MOUTH = np.array((0, 0, -65e-3 * np.cos(np.pi / 6) * 2 / 3))  # its middle, from the pivot


def stage(opening=np.pi / 6):
    sim = fs.Simulation(physics=fs.PhysicsDef(rate=1000, gravity=(-GRAVITY, 0, 0)))  # the bag hangs to the -x of its tool
    arms = [fs.JointDef(axis=(side, 0, 0), child=i + 1, lower=0, upper=1, start=opening, command=fs.JointPosition(opening))
            for i, side in enumerate((1, -1))]
    tool = sim.add(fs.RigidBodyDef(name="holder", elements=[(0, 0, 0)], articulation=fs.ArticulationDef(joints=arms)))
    ball = sim.add(fs.RigidBodyDef(name="ball", elements=[MOUTH + (-55e-3, 0, 0)], mesh=fs.shapes.sphere(12e-3, 4), dynamic=True,
                                   mass=fs.TotalMass(0.05), collision=[fs.CollisionDef(proximity=5e-4)]))
    return sim, tool, ball


def test_a_bag_carries_a_ball_is_shut_and_drawn_away_with_it():
    sim, tool, ball = stage()
    bag = fs.SpecimenBag(sim, tool, fs.SpecimenBagDef())
    assert bag.share(ball) == 0  # nothing is known before the first step
    sim.step(600)
    assert bag.share(ball) == 1 and bag.share(tool) == 0
    assert np.allclose(bag.mouth, MOUTH, atol=1e-3)
    assert -bag.load[0] > 0.05 * GRAVITY
    assert sim.definition(bag.body).name == "specimen bag"
    for joint in (0, 1):
        sim.set_joint(tool, joint, fs.JointPosition(0.0))
    sim.step(400)
    rim = sim.frame[bag.body].positions[:24]
    assert np.linalg.norm(rim[8] - rim[16]) < 5e-3  # the tips of the arms
    before = bag.mouth
    for i in range(200):
        sim.step(moves={tool: (0, 0, 2e-4 * (i + 1))})
    assert bag.share(ball) == 1 and np.allclose(bag.mouth - before, (0, 0, 0.04), atol=3e-3)


def test_what_is_wrong_with_a_bag_is_one_line():
    sim, tool, ball = stage(opening=0)
    with pytest.raises(fs.Error, match="specimen bag 'specimen bag': the tool must be open at the start"):
        fs.SpecimenBag(sim, tool, fs.SpecimenBagDef())
    with pytest.raises(fs.Error, match="must be a rigid body with two joints"):
        fs.SpecimenBag(sim, ball, fs.SpecimenBagDef())
    with pytest.raises(TypeError, match="SpecimenBag"):
        fs.SpecimenBag(sim, tool, fs.ClipApplierDef())
