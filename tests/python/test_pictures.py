"""Pictures as arrays, drawn off screen."""
import threading

import numpy as np
import pytest

import filasofia as fs
from scenes import ball, block, poke


@pytest.fixture(scope="module")
def drawn():
    sim, tissue, tool = poke()
    sim.step()
    yield sim, tissue, tool
    sim.close()


def test_a_picture_is_an_array_of_bytes_and_shows_something(drawn):
    sim, _, _ = drawn
    picture = sim.render(96, 64)
    assert picture.shape == (64, 96, 3) and picture.dtype == np.uint8
    assert picture.std() > 5  # not one colour
    assert np.array_equal(picture, sim.render(96, 64))
    picture[:] = 0  # it is the caller's
    assert sim.render(96, 64).any()


def test_the_camera_may_be_anywhere(drawn):
    sim, _, _ = drawn
    usual = sim.render(96, 64)
    above = fs.look_at((0, 0.2, 0), (0, 0, 0), up=(0, 0, 1))
    assert not np.array_equal(sim.render(96, 64, pose=above), usual)
    wide = sim.render(96, 64, camera=fs.CameraDef(vertical_field_of_view=2.5))
    assert not np.array_equal(wide, usual)
    assert np.array_equal(sim.render(96, 64), usual)


def test_pictures_come_from_any_thread_and_show_the_present_state(drawn):
    sim, _, tool = drawn
    before, pictures = sim.render(96, 64), []
    sim.set_pose(tool, (0, 0.05, 0))
    sim.step()
    thread = threading.Thread(target=lambda: pictures.append(sim.render(96, 64)))
    thread.start()
    thread.join()
    assert not np.array_equal(pictures[0], before)


def test_show_chooses_what_is_drawn():
    sim, tissue, _ = poke()
    shown = sim.show(tissue, material=fs.MetalMaterial(), subdivision=1)
    sim.step()
    visible = sim.render(64, 48)
    assert sim.paint(tissue, fs.PaintDef(place=(0, 0.015, 0), radius=0.02, state=fs.SurfaceState(blood=1))) > 0
    sim.set_visible(shown, False)
    assert not np.array_equal(sim.render(64, 48), visible)
    sim.unshow(shown)
    sim.render(64, 48)


@pytest.mark.parametrize(
    "act, says",
    [
        (lambda sim: sim.render(0, 64), "width must be a whole number in [1, 8192] px, got 0"),
        (lambda sim: sim.render(64, 10**6), "height must be a whole number in [1, 8192] px"),
        (lambda sim: sim.render(64, 48, camera=fs.CameraDef(near=0.0)), "near must be > 0 m, got 0.0"),
        (lambda sim: sim.render(64, 48, pose=fs.Pose((0, 0, 0), (0, 0, 0, 0))), "orientation"),
        (lambda sim: sim.show(99), "99"),
        (lambda sim: sim.show(sim.bodies[0], surface="no.obj"), "no.obj"),
        (lambda sim: fs.look_at((0, 0, 0), (0, 0, 0)), "eye"),
    ],
)
def test_wrong_pictures_are_refused(drawn, act, says):
    with pytest.raises(fs.Error) as caught:
        act(drawn[0])
    assert says in str(caught.value)


def test_an_empty_simulation_has_nothing_to_draw():
    with pytest.raises(fs.Error, match="nothing is shown"):
        fs.Simulation(threads=1).render(64, 48)


def test_what_the_user_shows_of_a_body_replaces_what_the_first_picture_showed():
    def picture(first):
        sim, tissue, tool = poke()
        sim.step()
        if first:
            sim.render(96, 64)
        shown = sim.show(tissue, material=fs.MetalMaterial())
        if not first:
            sim.show(tool, material=fs.MetalMaterial())
        both = sim.render(96, 64)
        sim.set_visible(shown, False)
        hidden = sim.render(96, 64)
        sim.close()
        return both, hidden

    for late, early in zip(picture(True), picture(False)):
        assert np.array_equal(late, early)
