"""Pictures as arrays, drawn off screen."""
import pickle
import struct
import threading
import zlib

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


@pytest.mark.parametrize("seconds", [0.001, 1.0])
def test_the_first_picture_frames_what_is_there_then(seconds):
    """A shell that hangs by two corners was cut off by 30 %, as the picture framed where it had started."""
    sim = fs.Simulation()
    sheet = fs.shapes.sheet(0.1, 0.1, (20, 20))
    shell = fs.ShellMaterial(young_modulus=1e5, thickness=5e-4)
    sim.add(fs.SoftBodyDef(mesh=sheet, material=shell, attachments=[fs.AttachmentDef(nodes=[0, 20])]))
    sim.run(seconds)
    shown = np.isfinite(sim.render_depth(96, 72).depth)
    assert shown.mean() > 0.05
    assert max(each.mean() for each in (shown[0], shown[-1], shown[:, 0], shown[:, -1])) < 0.1


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
            sim.show(tool)  # as what it is, which is how the first picture showed it
        both = sim.render(96, 64)
        sim.set_visible(shown, False)
        hidden = sim.render(96, 64)
        sim.close()
        return both, hidden

    for late, early in zip(picture(True), picture(False)):
        assert np.array_equal(late, early)


def png_chunks(data):
    """(kind, content) of each chunk of a PNG, checked."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at = 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, content = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length]) == (zlib.crc32(kind + content),)
        yield kind, content
        at += 12 + length


def unpacked(data, width, height):
    """The pixels of packed rows whose filter is 2: each is the difference from the row above."""
    rows = np.frombuffer(zlib.decompress(data), np.uint8).reshape(height, 3 * width + 1)
    assert (rows[:, 0] == 2).all()
    return np.add.accumulate(rows[:, 1:], axis=0, dtype=np.uint8).reshape(height, width, 3)


def films(data):
    """The pictures of an animated PNG, and for how long each is shown [s]."""
    found, seconds, place, numbers = [], [], None, []
    for kind, content in png_chunks(data):
        if kind == b"IHDR":
            width, height = struct.unpack(">2I", content[:8])
            canvas = np.zeros((height, width, 3), np.uint8)
        elif kind == b"acTL":
            count, repeats = struct.unpack(">2I", content)
        elif kind == b"fcTL":
            number, wide, high, left, top, delay, per, _, _ = struct.unpack(">5I2H2B", content)
            place, numbers = (left, top, wide, high), [*numbers, number]
            seconds.append(delay / per)
        elif kind in (b"IDAT", b"fdAT"):
            if kind == b"fdAT":
                numbers.append(struct.unpack(">I", content[:4])[0])
            left, top, wide, high = place
            packed = content[4:] if kind == b"fdAT" else content
            canvas[top : top + high, left : left + wide] = unpacked(packed, wide, high)
            found.append(canvas.copy())
    assert len(found) == count and repeats == 0 and numbers == list(range(len(numbers)))
    return found, seconds


def test_a_notebook_shows_a_picture_and_nothing_else_that_is_computed_from_it(drawn, tmp_path):
    sim, _, _ = drawn
    picture = sim.render(96, 64)
    assert isinstance(picture, fs.Picture)
    chunks = dict(png_chunks(picture._repr_png_()))
    assert struct.unpack(">2I5B", chunks[b"IHDR"]) == (96, 64, 8, 2, 0, 0, 0)
    assert np.array_equal(unpacked(chunks[b"IDAT"], 96, 64), picture)
    assert isinstance(pickle.loads(pickle.dumps(picture)), fs.Picture)
    picture.save(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").read_bytes() == picture._repr_png_()
    assert picture[10:20, 5:30]._repr_png_() is not None
    for other in (picture / 255, picture // 2, picture > 5, np.flip(picture) + 1):
        assert type(other) is np.ndarray
    assert type(picture.mean()) is np.float64 and type(picture.max()) is np.uint8
    picture += 1
    assert isinstance(picture, fs.Picture)
    for other in (picture[..., 0], picture[:0]):
        assert other._repr_png_() is None
        with pytest.raises(fs.Error, match=r"picture: it must be \(height, width, 3\), uint8, got"):
            other.save(tmp_path / "no.png")


def test_a_notebook_shows_depth_with_what_is_near_brighter(drawn):
    sim, _, _ = drawn
    seen = sim.render_depth(96, 64)
    grey = unpacked(dict(png_chunks(seen._repr_png_()))[b"IDAT"], 96, 64)[..., 0]
    assert not grey[seen.bodies == 0].any()
    near, far = seen.depth == seen.depth.min(), seen.depth == seen.depth[seen.bodies > 0].max()
    assert (grey[near] == 255).all() and (grey[far] == 55).all()


def test_a_film_is_the_run_that_it_shows(tmp_path):
    sim, tissue, tool = poke(threads=1)
    other, _, _ = poke(threads=1)
    film = sim.film(0.1, fps=50, width=48, height=32)
    other.run(0.1)
    assert sim.steps == other.steps and sim.state_hash == other.state_hash
    assert len(film) == 6 and film[0].shape == (32, 48, 3) and repr(film) == "<Film of 6 pictures of 48 x 32, 0.12 s>"
    assert np.array_equal(film[-1], sim.render(48, 32)) and not np.array_equal(film[0], film[-1])
    pictures, seconds = films(film._repr_png_())
    assert all(np.array_equal(*pair) for pair in zip(pictures, film)) and seconds == [0.02] * 6
    film.save(tmp_path / "film.png")
    assert (tmp_path / "film.png").read_bytes() == film._repr_png_()
    assert film.strip(3).shape == (32, 3 * 48, 3) and np.array_equal(film.strip(3)[:, -48:], film[-1])
    assert len(film[::2]) == 3 and np.array_equal(film[::2][1], film[2])
    sim.close()
    other.close()


def test_a_picture_has_no_name_of_another_format(tmp_path):
    still = np.full((4, 6, 3), 7, np.uint8)
    for what, made in (("picture", still.view(fs.Picture)), ("film", fs.Film([still]))):
        for name in ("a.jpg", "a", "a.gif", "png", b"a.png", "a\0.png"):
            with pytest.raises(fs.Error, match=f"^{what}: file must end in .png, got "):
                made.save(name)
        made.save(tmp_path / "A.PNG")
    assert [each.name for each in tmp_path.iterdir()] == ["A.PNG"]


def test_a_film_of_equal_pictures_is_one():
    still = np.full((4, 6, 3), 7, np.uint8)
    pictures, _ = films(fs.Film([still, still, still], fps=10)._repr_png_())
    assert len(pictures) == 3 and all(np.array_equal(each, still) for each in pictures)


def test_a_wrong_film_is_one_clear_error(drawn):
    sim, _, _ = drawn
    before = sim.steps
    for seconds in (0, -1, float("nan"), float("inf"), 1e-9):
        with pytest.raises(fs.Error, match="film: seconds must be in"):
            sim.film(seconds)
    for fps in (0, 1e6, float("nan")):
        with pytest.raises(fs.Error, match="film: fps must be in"):
            sim.film(0.1, fps=fps)
    assert sim.steps == before
    still = np.zeros((4, 6, 3), np.uint8)
    with pytest.raises(fs.Error, match="film: there must be at least one picture, got 0"):
        fs.Film([])
    with pytest.raises(fs.Error, match=r"of one size, got \(4, 5, 3\), uint8 for picture 1"):
        fs.Film([still, still[:, :5]])
    with pytest.raises(fs.Error, match="film: fps must be in"):
        fs.Film([still], fps=float("inf"))
    with pytest.raises(fs.Error, match="film: count must be a whole number >= 1, got 0"):
        fs.Film([still]).strip(0)


def test_a_large_floor_that_nobody_described_is_lit_and_grey():
    sim = fs.Simulation(threads=1)
    floor = fs.shapes.box((0.6, 0.02, 0.6))
    sim.add(fs.RigidBodyDef(name="floor", elements=[(0, -0.01, 0)], mesh=floor))
    seen = np.asarray(sim.render(160, 120), dtype=float)
    _, bodies = sim.render_depth(160, 120)
    red, green, blue = seen[bodies != 0].mean(axis=0)
    assert red > 60  # of metal, which mirrors dark surroundings, 14
    assert abs(red - blue) < 0.15 * red and abs(red - green) < 0.15 * red
    sim.close()
