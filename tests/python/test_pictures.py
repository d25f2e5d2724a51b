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


def points(depth, lens):
    """The places [m] that the pixels show, as the camera sees them."""
    height, width = depth.shape
    half = np.tan(lens.vertical_field_of_view / 2)
    right = (2 * np.arange(width) + 1 - width) / height * half
    up = (height - 2 * np.arange(height) - 1) / height * half
    return np.stack([right * depth, up[:, None] * depth, -depth], axis=-1)


def test_depth_places_every_pixel_on_the_body_that_it_shows(drawn):
    sim, tissue, tool = drawn
    lens, eye = fs.CameraDef(vertical_field_of_view=0.6, near=0.001), (0.02, 0.2, 0)
    seen = sim.render_depth(96, 64, pose=fs.look_at(eye, (0.02, 0, 0), up=(0, 0, -1)), camera=lens)
    assert seen.depth.shape == seen.bodies.shape == (64, 96)
    assert seen.depth.dtype == np.float32 and seen.bodies.dtype == np.uint32
    assert set(np.unique(seen.bodies)) == {0, tissue, tool}
    assert np.array_equal(np.isinf(seen.depth), seen.bodies == 0)
    x, y, z = np.moveaxis(points(np.where(seen.bodies > 0, seen.depth, 1), lens), -1, 0)
    place = np.stack([eye[0] + x, eye[1] + z, -y], axis=-1)  # it looks down, -z is up in the picture
    assert np.allclose(place[seen.bodies == tissue][:, 1], 0.015, atol=1e-5)  # the block's upper face, after one step
    away = np.linalg.norm(place[seen.bodies == tool] - sim.frame[tool].poses[0, :3], axis=1)
    assert len(away) > 50 and away.max() < 0.008 + 1e-6 and away.min() > 0.0075  # a ball of flat triangles
    again = sim.render_depth(96, 64, pose=fs.look_at(eye, (0.02, 0, 0), up=(0, 0, -1)), camera=lens)
    assert all(np.array_equal(a, b) for a, b in zip(seen, again))


def test_depth_and_picture_show_the_same(drawn):
    sim, _, _ = drawn
    usual = sim.render(96, 64)
    outside = sim.render_depth(96, 64).bodies == 0
    assert 100 < outside.sum() < 6000
    assert usual[outside].max() < usual[~outside].mean()  # the background is black, but for the blend at edges
    assert np.array_equal(sim.render(96, 64), usual)


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
        (lambda sim: sim.render_depth(64, 0), "height must be a whole number in [1, 8192] px, got 0"),
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
