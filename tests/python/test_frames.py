"""Frames: NumPy views of the engine's own memory."""
import gc
import weakref

import numpy as np
import pytest

import filasofia as fs
from scenes import ball, block, poke


def address(array):
    return array.__array_interface__["data"][0]


def test_views_are_the_engines_own_memory_and_cannot_be_written():
    sim, tissue, tool = poke()
    sim.step()
    frame = sim.frame
    first, second = frame[tissue].positions, sim.frame[tissue].positions
    assert address(first) == address(second)  # two views, one memory
    assert not first.flags.owndata and not first.flags.writeable and first.flags.c_contiguous
    assert first.dtype == np.float64 and first.shape == (6 * 4 * 6, 3)
    assert address(frame.copy()[tissue].positions) != address(first)
    views = [frame[tissue].velocities, frame[tool].poses, frame[tool].velocities, frame[tool].angular_velocities]
    views += [frame.contacts, frame.attachments, frame[tool].joints]
    for view in views:
        assert not view.flags.writeable and not view.flags.owndata
        with pytest.raises(ValueError):
            view.flags.writeable = True


def test_a_frame_does_not_change_when_the_simulation_goes_on():
    sim, tissue, _ = poke()
    sim.step()
    frame = sim.frame
    held = frame[tissue].positions
    before = held.copy()
    sim.step(20)
    assert np.array_equal(held, before)
    assert not np.array_equal(sim.frame[tissue].positions, before)
    assert (frame.step, sim.frame.step) == (1, 21)


def test_columns_have_the_numbers_of_the_engine():
    sim, tissue, tool = poke()
    sim.attach(tissue, fs.AttachmentDef(nodes=[140], to=tool, stiffness=50))
    sim.every_step(lambda t: sim.set_pose(tool, (0, 0.025 - 0.1 * t, 0)))
    sim.step(50)
    frame = sim.frame
    contacts = frame.contacts
    assert len(contacts) > 0
    assert set(contacts["first"]) | set(contacts["second"]) == {tissue, tool}
    assert np.allclose(np.linalg.norm(contacts["normal"], axis=1), 1)
    assert np.abs(contacts["point"]).max() < 0.05
    assert contacts["normal_force"].min() >= 0 and contacts["normal_force"].max() > 0
    assert np.isfinite(contacts["friction"]).all() and contacts["gap"].max() < 2e-3
    attachments = frame.attachments
    assert list(attachments["body"]) == [tissue, tissue]
    assert list(attachments["to"]) == [0, tool]
    assert list(attachments["points"]) == [36, 1]
    assert not attachments["broken"].any()
    assert list(attachments["id"])[:1] == sim.attachments(tissue)
    assert frame[tool].poses == pytest.approx(np.array([[0, 0.02, 0, 1, 0, 0, 0]]))
    assert frame[tissue].revision == 0 and frame[tissue].boundary is None
    assert [body.id for body in frame.soft_bodies] == [tissue]
    assert [body.id for body in frame.rigid_bodies] == [tool]


def test_empty_columns_are_empty_arrays():
    sim = fs.Simulation(threads=1)
    tool = sim.add(fs.RigidBodyDef())
    sim.step()
    frame = sim.frame
    assert frame.contacts.shape == frame.attachments.shape == frame[tool].joints.shape == (0,)
    assert frame.contacts["normal"].shape == (0, 3)
    assert frame.soft_bodies == []
    assert not frame.contacts.flags.writeable and not frame[tool].joints.flags.writeable


def test_views_outlive_frame_and_simulation():
    sim, tissue, _ = poke()
    sim.step(3)
    gone = weakref.ref(sim)
    frame = sim.frame
    positions, contacts = frame[tissue].positions, frame.contacts
    expected = positions.copy()
    del sim, frame
    gc.collect()
    assert gone() is None
    junk = [np.zeros((6 * 4 * 6, 3)) for _ in range(100)]  # what would be written over freed memory
    assert np.array_equal(positions, expected) and contacts.shape[0] >= 0 and junk


def test_too_many_held_frames_are_an_error_and_no_stale_state():
    sim, tissue, _ = poke()
    held = []
    with pytest.raises(fs.Error, match="was not captured, because too many frames"):
        for _ in range(20):
            sim.step()
            held.append(sim.frame[tissue].positions)
    assert 5 <= len(held) < 10
    held.clear()
    with pytest.raises(fs.Error, match="was not captured"):
        sim.frame  # it is still the old one
    sim.step()
    assert sim.frame.step == sim.steps
    copies = []
    for _ in range(20):
        sim.step()
        copies.append(sim.frame.copy())
    assert [frame.step for frame in copies] == list(range(sim.steps - 19, sim.steps + 1))


def test_no_frame_before_the_first_step_and_none_of_other_bodies():
    sim, tissue, _ = poke()
    with pytest.raises(fs.Error, match="frame: no step was made yet"):
        sim.frame
    sim.step()
    with pytest.raises(fs.Error, match="frame of step 1: there is no body 9"):
        sim.frame[9]
    with pytest.raises(TypeError, match="frame: body must be a whole number, got 'tissue'"):
        sim.frame["tissue"]
    late = sim.add(ball(name="late", elements=[(0, 1, 0)]))
    with pytest.raises(fs.Error):
        sim.frame[late]
    sim.step()
    assert sim.frame[late].poses[0, 1] == 1.0


def test_a_callback_gets_no_old_frame_either():
    sim, tissue, _ = poke()
    held, seen, refused = [], [], []

    def look(event):
        try:
            held.append(sim.frame)
            seen.append(held[-1].step == event.step)
        except fs.Error as problem:
            refused.append(str(problem))

    sim.on(fs.PhysicsUpdateEvent, look)
    sim.step(20)
    assert all(seen) and len(seen) + len(refused) == 20
    assert refused and all("was not captured" in each for each in refused)


def test_what_lets_go_is_an_event_a_report_and_a_line() -> None:
    sim = fs.Simulation(gravity=(0, 0, 0), threads=1)
    tool = sim.add(fs.RigidBodyDef(name="tool", mesh=fs.shapes.box((0.01, 0.01, 0.01)), elements=[(0, 0.04, 0)]))
    held = fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, -0.0099, 1)))
    torn = fs.AttachmentDef(box=fs.Box((-1, 0.0099, -1), (1, 1, 1)), to=tool, break_force=0.05)
    block = sim.add(fs.SoftBodyDef(name="block", mesh=fs.shapes.block((0.02, 0.02, 0.02), (2, 2, 2)), attachments=[held, torn]))
    told: list[fs.BreakEvent] = []
    sim.on(fs.BreakEvent, told.append)
    breaks: list[fs.AttachmentBreak] = []
    for i in range(100):
        sim.set_pose(tool, (0, 0.04 + 1e-4 * i, 0))
        breaks += sim.step().breaks
    assert len(breaks) == len(told) == 1
    one = breaks[0]
    assert (one.body, one.to, one.grasp, one.broken, one.points) == (block, tool, False, True, 9)
    assert one.id == sim.attachments(block)[1] and one.force > 0.05
    assert told[0].attachment.force == one.force
