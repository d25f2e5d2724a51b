"""Instruments with jaws, what is mounted on them, and a wire loop."""
import gc
import math

import numpy as np
import pytest

import filasofia as fs
from scenes import ball, block

DOWN = fs.axis_angle((1, 0, 0), -math.pi / 2)  # its tip looks along -y
NO_PULL = (0, 0, 0)


def band(sim, **fields):
    """A band across the jaws of an instrument at the origin, held at both ends."""
    ends = [fs.AttachmentDef(box=fs.Box((-1, -1, -1), (-14.9e-3, 1, 1))), fs.AttachmentDef(box=fs.Box((14.9e-3, -1, -1), (1, 1, 1)))]
    given = dict(name="band", mesh=fs.shapes.block((30e-3, 1.4e-3, 5e-3), (30, 2, 5)), pose=(0, 0, -8e-3), attachments=ends,
                 material=fs.FemMaterial(young_modulus=30e3, poisson_ratio=0.45), dynamic_topology=True,
                 collision=[fs.CollisionDef(proximity=1e-4, self_once_cut=False)])
    return sim.add(fs.SoftBodyDef(**{**given, **fields}))


def grasper(sim, **fields):
    given = dict(name="grasper", kind="laparoscopicGrasper", opening=1)
    return fs.ArticulatedInstrument(sim, fs.ArticulatedInstrumentDef(**{**given, **fields}))


def test_an_instrument_grasps_moves_and_lets_go_with_the_same_bits_after_a_state():
    sim = fs.Simulation(rate=500, gravity=NO_PULL)
    tissue, tool = band(sim), grasper(sim)
    assert tool.kind == "laparoscopicGrasper" and sim.definition(tool.body).name == "grasper"
    sim.step()
    assert tool.holding is None and tool.opening == pytest.approx(1) and tool.pull == 0
    assert not sim.frame.connected(tool.body, tissue)
    tool.close(0.02)
    sim.step(500)
    assert tool.holding == tissue and tool.opening < 0.5
    assert sim.frame.connected(tool.body, tissue) and sim.frame.connected(tissue, tool.body)
    assert np.linalg.norm(tool.grip - (0, 0, -8e-3)) < 5e-3
    state = sim.save_state()
    tool.move((0, 3e-3, 0))
    assert tool.pose.position == (0, 3e-3, 0)
    sim.step(50)
    lifted, pull = sim.state_hash, tool.pull
    assert pull > 1e-3 and sim.frame[tool.body].poses[tool.SHAFT][1] == pytest.approx(3e-3)
    sim.restore(state)
    assert tool.pose.position == (0, 0, 0)
    tool.move((0, 3e-3, 0))
    sim.step(50)
    assert sim.state_hash == lifted
    tool.open()
    sim.step(300)
    assert tool.holding is None and tool.opening == pytest.approx(1) and not sim.frame.connected(tissue, tool.body)


def test_connected_bodies_hang_together_through_others():
    sim = fs.Simulation(rate=1000, gravity=NO_PULL)
    first, second, last = (sim.add(ball(name=name, dynamic=True, elements=[(x, 0, 0)])) for name, x in (("a", 0), ("b", 0.1), ("c", 0.2)))
    tissue = sim.add(block(pose=(0, -0.2, 0)))
    ties = [sim.attach(one, fs.RigidAttachmentDef(to=other)) for one, other in ((first, second), (last, second))]
    sim.step()
    frame = sim.frame
    assert frame.connected(first, last) and frame.connected(last, first) and frame.connected(first, first)
    assert not frame.connected(first, tissue)  # that is attached to space
    rows = frame.attachments
    assert list(rows["body"][rows["to"] == second]) == [first, last]
    sim.release(ties[1])
    sim.step()
    assert not sim.frame.connected(first, last) and sim.frame.connected(first, second)
    assert frame.connected(first, last)  # the older state
    assert first in frame and fs.BodyId(99) not in frame
    for wrong, says in ((99, "connected: other must be a body of the frame of step 1, got 99"), (None, "connected: other must be a BodyId, got None"),
                        ("a", "connected: other must be a whole number, got 'a'"), (-1, "connected: other must be a whole number in")):
        with pytest.raises((fs.Error, TypeError), match=says):
            frame.connected(first, wrong)


def bed(**fields):
    """Tissue that bleeds, and a tube whose mouth is 1 mm above it."""
    sim = fs.Simulation(rate=250, threads=1)
    everywhere = fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, 1, 1)))
    tissue = sim.add(block(mesh=fs.shapes.block((0.04, 0.01, 0.02), (20, 3, 10)), attachments=[everywhere], collision=[]))
    tube = grasper(sim, name="tube", kind="suctionIrrigator", pose=fs.Pose((0, 0.036, 0), DOWN), groups=[])
    sim.bleed(tissue, fs.BleedingDef(flux=5e-4, clotting_time=100))
    sim.treat(tissue, fs.Injure(place=(0, 0.005, 0), radius=0.006))
    return sim, tissue, tube, fs.SuctionIrrigator(sim, tube, fs.SuctionIrrigatorDef(**fields))


def test_a_suction_irrigator_sucks_while_its_tool_is_closed_and_rinses():
    sim, tissue, tube, suction = bed(reach=0.03, irrigation=2e-9)
    sim.run(1)
    assert not suction.sucks and sim.blood(tissue).sucked == 0
    tube.close()
    sim.run(1)
    assert suction.sucks and tube.opening == 0 and sim.blood(tissue).sucked > 0
    tube.open()
    suction.rinse(True)
    sim.run(1)
    assert suction.rinses and not suction.sucks
    assert suction.irrigated == pytest.approx(2e-9, rel=0.02) and sim.blood(tissue).rinsed > 0
    state, flowed = sim.save_state(), suction.irrigated
    suction.rinse(False)
    sim.run(0.1)
    assert not suction.rinses
    sim.restore(state)
    assert suction.rinses and suction.irrigated == flowed


def test_what_is_mounted_on_an_instrument_needs_no_name_for_it():
    sim, tissue, tube, suction = bed(reach=0.03)
    tube.close()
    del tube
    gc.collect()
    sim.run(1)
    assert suction.sucks and sim.blood(tissue).sucked > 0


def test_ultrasonic_shears_seal_a_band_and_part_it():
    sim = fs.Simulation(rate=500, gravity=NO_PULL)
    tissue = band(sim, pose=(0, 0.8e-3, -8e-3))
    tool = fs.ArticulatedInstrument(sim, fs.ArticulatedInstrumentDef(name="shears", kind="ultrasonicShears", opening=1))
    shears = fs.UltrasonicShears(sim, tool, fs.UltrasonicShearsDef(parting=0.5))
    sim.burn(tissue, fs.BurningDef(depth=0.7e-3))
    cuts = []
    sim.on(fs.CutEvent, cuts.append)
    tool.close()
    sim.run(1)
    assert (shears.sealed, shears.parts, shears.parted) == (0, False, 0)
    shears.press(True)
    for _ in range(60):
        sim.run(0.1)
        if shears.parted:
            break
    assert shears.parted == 1 and shears.sealed >= 0.95 and cuts
    assert sim.energy(tool.body, shears.PEDAL).active > 0.5
    shears.press(False)
    tool.open()
    sim.run(1)
    assert not shears.parts and shears.parted == 1


def test_a_wire_loop_shaves_a_chip_off():
    sim = fs.Simulation(rate=500, gravity=NO_PULL)
    tissue = sim.add(block(mesh=fs.shapes.block((0.014, 0.006, 0.012), (14, 6, 12)), dynamic_topology=True,
                           attachments=[fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, -2.9e-3, 1)))],
                           collision=[fs.CollisionDef(proximity=1e-4, self_once_cut=False)]))
    loop = fs.WireLoop(sim, fs.WireLoopDef(pose=(0, 0.02, -0.01)))
    sim.burn(tissue, fs.BurningDef(rate=50))
    assert loop.line.shape == (15, 3) and loop.line[:, 1].min() == pytest.approx(-loop.definition.depth)
    sim.step()
    pieces = []
    sim.on(fs.CutEvent, lambda cut: pieces.extend(cut.rupture.detached))
    sim.every_step(lambda time: loop.move((0, 0.6e-3 + loop.definition.depth, min(-0.008 + 0.02 * time, 0.01))))
    loop.cut(True)
    sim.step(450)
    assert [each.held for each in pieces] == [False] and pieces[0].mass > 5e-5
    assert loop.pose.position == pytest.approx((0, 4.6e-3, 0.01)) and sim.frame[loop.body].poses[0, :3] == pytest.approx(loop.pose.position)
    assert sim.energy(loop.body, loop.CUTS).delivered > 10 and sim.energy(loop.body, loop.DRIES).active == 0
    loop.cut(False)
    loop.dry(True)
    sim.step(50)
    assert sim.energy(loop.body, loop.DRIES).active == pytest.approx(0.1, abs=0.005)


def test_clips_and_bags_take_instruments():
    sim = fs.Simulation(rate=500, gravity=NO_PULL)
    path = [(x * 1e-3 - 15e-3, 0, -9e-3) for x in range(31)]
    vessel = band(sim, name="vessel", mesh=fs.shapes.vessel(path, 0.6e-3, 0.4e-3, (8, 1)), pose=(0, 0, 0), dynamic_topology=False)
    jaws = grasper(sim, name="applier", kind="clipApplier", groups=[])
    clips = fs.ClipApplier(sim, jaws, fs.ClipApplierDef(targets=[vessel], clips=2))
    arms = grasper(sim, name="arms", kind="specimenBag", groups=[], pose=(0.2, 0, 0))
    bag = fs.SpecimenBag(sim, arms, fs.SpecimenBagDef())
    sim.step(10)
    jaws.close()
    sim.step(300)
    assert (clips.left, clips.applied, clips.missed) == (1, 1, 0)
    assert np.isfinite(bag.mouth).all() and bag.share(vessel) == 0


def test_instruments_are_drawn_beside_all_other_bodies():
    sim = fs.Simulation(rate=500, gravity=NO_PULL)
    tissue, tool = band(sim), grasper(sim)
    loop = fs.WireLoop(sim, fs.WireLoopDef(pose=(0.02, 0, -8e-3)))
    sim.step()
    seen = set(np.unique(sim.render_depth(160, 120, pose=fs.look_at((0.01, 0.08, 0.0), (0.01, 0, -8e-3))).bodies))
    assert seen >= {tissue, tool.body, loop.body}


def test_wrong_instruments_are_one_line():
    sim, other = fs.Simulation(rate=500), fs.Simulation(rate=500)
    tool, tube, far = grasper(sim), grasper(sim, kind="suctionIrrigator"), grasper(other)
    for act, says in [
        (lambda: fs.SuctionIrrigator(sim, tool.body), "SuctionIrrigator: tool must be an ArticulatedInstrument, got BodyId"),
        (lambda: fs.UltrasonicShears(sim, None), "UltrasonicShears: tool must be an ArticulatedInstrument, got None"),
        (lambda: fs.SuctionIrrigator(sim, far), "SuctionIrrigator: the tool must be an instrument of the same simulation"),
        (lambda: fs.ClipApplier(sim, far, fs.ClipApplierDef()), "ClipApplier: the tool must be an instrument of the same simulation"),
        (lambda: fs.SpecimenBag(sim, None, fs.SpecimenBagDef()), "SpecimenBag: tool must be a BodyId, got None"),
        (lambda: fs.SuctionIrrigator(sim, tube, fs.WireLoopDef()), "SuctionIrrigator: definition must be a SuctionIrrigatorDef, got WireLoopDef"),
        (lambda: fs.ArticulatedInstrument(sim, "grasper"), "ArticulatedInstrument: definition must be an ArticulatedInstrumentDef, got 'grasper'"),
        (lambda: fs.ArticulatedInstrument(3), r"ArticulatedInstrument: takes \(sim: Simulation, definition"),
        (lambda: fs.UltrasonicShears(sim, tool), "must have one jaw that moves, got 2"),
        (lambda: fs.UltrasonicShears(sim, tube), "must have one jaw that moves, got 0"),
        (lambda: fs.SuctionIrrigatorDef(reach=0), "SuctionIrrigatorDef: reach must be > 0 m, got 0"),
        (lambda: fs.WireLoop(sim, fs.WireLoopDef(name="hook", width=0.01)), r"wire loop 'hook': depth must be >= width / 2"),
        (lambda: fs.WireLoop(sim, tool), "WireLoop: definition must be a WireLoopDef, got <filasofia"),
        (lambda: grasper(sim, kind="hok"), "kind must be .*got 'hok' .did you mean 'hook'"),
        (lambda: tool.move((0, math.nan, 0)), r"move: pose\[1\] must be finite, got nan"),
        (lambda: tool.move(None), "move: pose must be a Pose, got None"),
        (lambda: tool.open(2), r"open: opening must be in \[0, 1\], got 2"),
        (lambda: tool.close(0), "close: torque must be > 0, got 0"),
        (lambda: tool.close(True), "close: torque must be a number, got True"),
        (lambda: tool.carries(1), "carries: at must be 3 numbers, got 1"),
        (lambda: fs.SuctionIrrigator(sim, tube).rinse(1), "rinse: on must be True or False, got 1"),
        (lambda: fs.WireLoop(sim).cut(None), "cut: on must be True or False, got None"),
    ]:
        with pytest.raises((fs.Error, TypeError), match=says) as caught:
            act()
        assert "\n" not in str(caught.value) and "nb" not in str(caught.value)
    loop = fs.WireLoop(sim)
    sim.step()
    sim.close()
    for act, what in [(lambda: tool.pose, "pose"), (lambda: tool.close(), "close"), (lambda: loop.cut(True), "cut"), (lambda: loop.line, "line")]:
        with pytest.raises(fs.Error, match=f"^{what}: the simulation is closed$"):
            act()
    assert repr(tool).startswith("<filasofia")
    with pytest.raises(fs.Error, match="ArticulatedInstrument: the simulation is closed"):
        grasper(sim)
