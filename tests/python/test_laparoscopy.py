"""What goes through a trocar: instruments and a scope."""
import math
import time

import numpy as np
import pytest

import filasofia as fs
from scenes import ball, block
from virtual_display import press, virtual_display

INSIDE, LENGTH = 0.12, 0.36  # [m]
NO_PULL = (0, 0, 0)


def level(sim, **fields):
    """A shaft along -z through the origin, level, with 120 of 360 mm inside."""
    given = dict(trocar=fs.TrocarDef(wall_stiffness=math.inf, friction=0), hand=fs.TrocarHandleDef(length=LENGTH),
                 start=fs.TrocarPose(insertion=INSIDE))
    return fs.LaparoscopicInstrument(sim, fs.LaparoscopicInstrumentDef(**{**given, **fields}))


def scope(sim, **fields):
    """It looks at the origin from 10 cm above."""
    trocar = fs.TrocarDef(fulcrum=(0, 0.2, 0), axis=(0, -1, 0), up=(0, 0, -1))
    given = dict(inclination=0, trocar=trocar, start=fs.TrocarPose(insertion=0.1))
    return fs.Laparoscope(sim, fs.LaparoscopeDef(**{**given, **fields}))


def test_the_hand_feels_a_force_on_the_tip_by_the_law_of_the_lever():
    sim = fs.Simulation(rate=1000)
    tool = level(sim, tool=fs.ArticulatedInstrumentDef(kind="laparoscopicGrasper", groups=[]))
    weight = fs.GivenInertia(mass=0.1, moments=(1e-5, 1e-5, 1e-5))
    sim.add(fs.RigidBodyDef(name="weight", elements=[tool.report.pivot], dynamic=True, mass=weight,
                            attachments=[fs.RigidAttachmentDef(to=tool.body)]))
    sim.step(2000)
    felt = tool.report
    assert felt.force[1] == pytest.approx(0.1 * 9.81 * INSIDE / (LENGTH - INSIDE), rel=0.02)
    assert felt.wall[1] == pytest.approx(0.1 * 9.81 * LENGTH / (LENGTH - INSIDE), rel=0.02)
    assert "force=array" in repr(felt)


def test_a_shaft_goes_to_a_target_within_its_limits_and_again_with_the_same_bits():
    sim = fs.Simulation(rate=500, gravity=NO_PULL)
    tool = level(sim)
    assert tool.definition.start == fs.TrocarPose(insertion=INSIDE) and tool.body in sim.bodies
    sim.step()
    state, target = sim.save_state(), np.array((0.02, 0.03, -0.1))
    pose = tool.pose_at(target, roll=0.3)
    assert (pose.insertion, pose.roll) == (pytest.approx(np.linalg.norm(target)), 0.3)
    tool.move(pose)
    sim.step(3)
    moved = sim.state_hash
    assert np.allclose(tool.report.pivot.position, target, atol=1e-9) and tool.report.pose == pose
    assert np.linalg.norm(np.cross(tool.report.handle, target)) < 1e-9  # through the fulcrum
    sim.restore(state)
    tool.move(pose)
    sim.step(3)
    assert sim.state_hash == moved
    assert tool.pose_at((0, 0, -1)).insertion == tool.definition.trocar.most_insertion
    assert tool.pose_at((0, 0, -0.1), point=(0, 0, -0.02)).insertion == pytest.approx(0.08)


def test_its_jaws_open_and_close_and_bear_what_is_mounted_on_an_instrument():
    sim = fs.Simulation(rate=500, gravity=NO_PULL)
    tool = level(sim, tool=fs.ArticulatedInstrumentDef(kind="suctionIrrigator"))
    tube = fs.SuctionIrrigator(sim, tool.tool)
    tool.tool.close()
    sim.step(2)
    assert tube.sucks
    assert tool.tool.kind == "suctionIrrigator" and tool.tool.body == tool.body
    other = fs.Simulation(rate=500, gravity=NO_PULL)
    jaws = level(other)
    jaws.tool.open(0.5)
    other.step(300)
    assert jaws.tool.kind == "laparoscopicGrasper" and jaws.tool.opening == pytest.approx(0.5, abs=0.02)


def test_pictures_show_what_a_laparoscope_sees():
    sim = fs.Simulation(rate=500, gravity=NO_PULL)
    tissue = sim.add(block())
    seen = scope(sim)
    sim.step()
    labels = sim.render_depth(96, 72).bodies
    assert tissue in labels and labels[36, 48] == tissue
    wide, view = (labels == tissue).mean(), seen.field_of_view
    picture = sim.render(96, 72)
    assert picture.std() > 5
    seen.zoom(2)
    sim.step(2)
    sim.render(96, 72)  # which turns the lens
    near = (sim.render_depth(96, 72).bodies == tissue).mean()
    assert near > 1.5 * wide
    assert seen.field_of_view == pytest.approx(2 * math.atan(math.tan(view / 2) / 2))
    aside = dict(pose=fs.look_at((0, 0.3, 0.3), (0, 0, 0)), camera=fs.CameraDef(vertical_field_of_view=0.6))
    other = (sim.render_depth(96, 72, **aside).bodies == tissue).mean()
    assert 0 < other < 0.5 * near and sim.render(96, 72, **aside).shape == (72, 96, 3)
    assert (sim.render_depth(96, 72, **aside).bodies == tissue).mean() == other
    assert (sim.render_depth(96, 72).bodies == tissue).mean() == near  # the scope sees what it saw
    seen.zoom(1)
    seen.soil(mist=1)
    sim.step(2)
    assert seen.lens.mist == 1 and sim.render(96, 72).std() < picture.std()
    seen.soil()
    seen.horizon(False)
    seen.move(fs.TrocarPose(insertion=0.12, roll=0.5))
    sim.step(2)
    assert seen.lens.mist == 0 and seen.camera.position[1] == pytest.approx(0.08, abs=0.01)


def test_a_refused_laparoscope_leaves_pictures_as_they_were():
    sim = fs.Simulation(rate=500)
    tissue = sim.add(block())
    with pytest.raises(fs.Error, match="insertion"):
        scope(sim, start=fs.TrocarPose(insertion=0.9))
    sim.step()
    assert tissue in sim.render_depth(96, 72).bodies


def test_wrong_laparoscopy_is_one_line():
    sim = fs.Simulation(rate=500)
    tool, seen = level(sim), scope(sim)
    sim.add(ball())
    for act, says in [
        (lambda: tool.move(fs.TrocarPose(insertion=0.4)), "insertion"),
        (lambda: tool.move(fs.TrocarPose(yaw=1.2, insertion=0.1)), "tilt"),
        (lambda: tool.move((0, 0, 0)), "move: pose must be a TrocarPose, got"),
        (lambda: tool.pose_at(None), "pose_at: target must be 3 numbers, got None"),
        (lambda: tool.pose_at((0, 0, 0)), "fulcrum"),
        (lambda: fs.TrocarPose(yaw=math.nan), "TrocarPose: yaw must be finite"),
        (lambda: fs.TrocarDef(most_tilt=2), r"most_tilt must be in \(0, 1.5\] rad, got 2"),
        (lambda: fs.LaparoscopicInstrument(sim, fs.LaparoscopeDef()), "definition must be a LaparoscopicInstrumentDef, got LaparoscopeDef"),
        (lambda: fs.Laparoscope(sim, fs.LaparoscopicInstrumentDef()), "definition must be a LaparoscopeDef, got LaparoscopicInstrumentDef"),
        (lambda: fs.SuctionIrrigator(sim, tool), "tool must be an ArticulatedInstrument, got"),
        (lambda: seen.zoom(5), r"zoom: times must be in \[1, 4\], got 5"),
        (lambda: seen.soil(mist=-1), r"soil: mist must be in \[0, 1\], got -1"),
        (lambda: seen.horizon(1), "horizon: keep must be True or False, got 1"),
    ]:
        with pytest.raises((fs.Error, TypeError), match=says):
            act()
    sim.step()
    bodies = sim.bodies
    with pytest.raises(fs.Error, match="Laparoscope: the run has begun"):
        fs.Laparoscope(sim)
    assert sim.bodies == bodies
    sim.close()
    with pytest.raises(fs.Error, match="closed"):
        tool.move(fs.TrocarPose(insertion=0.1))


def test_pictures_show_what_an_endoscope_sees():
    sim = fs.Simulation(rate=500, gravity=NO_PULL)
    tissue = sim.add(block())
    start = fs.look_at((0, 0.08, 0), (0, 0, 0), (0, 0, -1))
    seen = fs.Endoscope(sim, fs.EndoscopeDef(pose=start, inclination=0.4, groups=[]))
    sim.step()
    assert seen.tip == start and seen.body in sim.bodies
    labels = sim.render_depth(96, 72).bodies
    straight = np.argwhere(labels == tissue).mean(axis=0)
    before = seen.camera
    seen.roll(math.pi)  # an inclined view goes over to the other side, and the picture turns
    seen.camera_roll(math.pi)
    sim.step(2)
    assert np.allclose(seen.camera.position, (-before.position[0], before.position[1], -before.position[2]), atol=1e-9)
    rolled = np.argwhere(sim.render_depth(96, 72).bodies == tissue).mean(axis=0)
    assert abs(rolled[0] - (71 - straight[0])) < 3 < abs(rolled[0] - straight[0])
    seen.move(fs.Pose((0, 0.06, 0), start.orientation))
    seen.soil(smear=0.3)
    sim.step(2)
    assert seen.tip.position[1] == pytest.approx(0.06) and seen.lens.smear == 0.3
    assert np.linalg.norm(np.subtract(seen.channel.position, seen.tip.position)) == pytest.approx(math.hypot(1.5e-3, 2.3e-3))
    assert sim.render(96, 72).std() > 5


def test_a_person_at_the_viewer_moves_what_goes_through_trocars(monkeypatch):
    sim = fs.Simulation(rate=500, gravity=NO_PULL)
    sim.add(block())
    left, right, seen = level(sim), level(sim, name="right"), scope(sim)
    hands = fs.TrocarHands(sim, left, right, seen, fs.TrocarHandsDef(gain=0.01))
    for act, says in [
        (lambda: fs.TrocarHands(sim, left, left, seen), "left and right must be two instruments"),
        (lambda: fs.TrocarHandsDef(gain=1), r"gain must be in \(0, 0.1\] rad, got 1"),
        (lambda: fs.TrocarHands(fs.Simulation(), left, right, seen), "of another simulation"),
    ]:
        with pytest.raises(fs.Error, match=says):
            act()
    sim.step()
    with pytest.raises(fs.Error, match="TrocarHands: the run has begun"):
        fs.TrocarHands(sim, left, right, seen)
    with pytest.raises(fs.Error, match="hands hold instruments, and do not go back"):
        sim.restore(sim.save_state())
    assert hands.wanted == (left.definition.start, right.definition.start, seen.definition.start)
    left.move(fs.TrocarPose(insertion=0.2))  # does not last
    sim.step(5)
    assert left.report.pose == left.definition.start
    with virtual_display() as name:
        monkeypatch.setenv("DISPLAY", name)
        with fs.viewer.launch_passive(sim) as viewer:
            for _ in range(60):  # nobody tells when the window listens
                press(name, ord("1"), ord("w"), ord("3"), ord("s"))
                viewer.sync()
                sim.step(50)
                if hands.wanted[0].insertion > INSIDE and hands.wanted[2].insertion < 0.1:
                    break
                time.sleep(0.2)
    assert hands.wanted[0].insertion > INSIDE and hands.wanted[1] == right.definition.start and hands.wanted[2].insertion < 0.1
    sim.step(500)
    assert left.report.pose.insertion == pytest.approx(hands.wanted[0].insertion, abs=1e-6)
