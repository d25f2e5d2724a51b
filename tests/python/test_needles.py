"""Needles in Python: the Defs, a tube, and the channels of a frame."""

import filasofia as fs
import numpy as np
import pytest


def test_a_needle_pierces_a_block_and_the_frame_tells():
    sim = fs.Simulation()
    tissue = sim.add(
        fs.SoftBodyDef(
            mesh=fs.shapes.block((0.03, 0.02, 0.03), (4, 4, 4)),
            material=fs.FemMaterial(young_modulus=30e3),
            gravity=False,
            attachments=[fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, -0.0099, 1)))],
            collision=[fs.CollisionDef(proximity=0.3e-3)],
            puncture=fs.PunctureDef(force=0.3, cutting=0.1, friction=10.0),
        )
    )
    line = [(0.0, 0.0, 0.0), (0.0, 0.03, 0.0)]
    needle = sim.add(
        fs.RigidBodyDef(
            elements=[fs.Pose((0.001, 0.011, 0.002))],
            mesh=fs.shapes.tube(line, 0.4e-3, 8, True),
            collision=[fs.CollisionDef(proximity=0.3e-3)],
            needle=fs.NeedleDef(line=line, radius=0.4e-3),
        )
    )
    for i in range(600):
        sim.set_pose(needle, fs.Pose((0.001, 0.011 - 0.03e-3 * i, 0.002)))
        sim.step()
    channels = sim.frame.channels
    assert len(channels) == 1
    channel = channels[0]
    assert channel["tissue"] == tissue and channel["needle"] == needle
    assert not channel["through"]
    assert channel["tip"] == pytest.approx(0.1, rel=1e-3)
    assert channel["friction"] == pytest.approx(10.0 * channel["length"], rel=0.03)
    assert np.linalg.norm(channel["end"] - channel["entry"]) == pytest.approx(channel["length"], rel=0.2)
    assert sim.frame.channels.base is not None  # a view


def test_wrong_needles_are_refused_in_one_line():
    with pytest.raises(fs.Error, match="tube: radius must be > 0 m, got 0"):
        fs.shapes.tube([(0, 0, 0), (1, 0, 0)], 0.0)
    with pytest.raises(fs.Error, match="needle.line must have at least 2 points, got 0"):
        fs.Simulation().add(fs.RigidBodyDef(name="n", needle=fs.NeedleDef()))
