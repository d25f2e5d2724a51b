"""From an image to an organ that moves: filasofia.anatomy."""
import json
import os
import re
import shutil
import subprocess
import sys
import warnings

import numpy as np
import pytest

import filasofia as fs
from filasofia import anatomy
from filasofia.anatomy import _read, _shapes, phantoms
from filasofia.anatomy.__main__ import main

import dicom_seg
import fuzz_labels

ROOT = os.environ["FILASOFIA_ROOT"]


@pytest.fixture(scope="module")
def patient():
    """Liver, gallbladder, vein and vertebra."""
    map_ = phantoms.liver_and_gallbladder(4e-3)
    return map_, anatomy.mesh_labels(map_, 6000)


def test_organs_have_their_volumes_and_no_flat_elements(patient):
    map_, made = patient
    assert abs(len(made.tetrahedra) - 6000) < 600
    for label, name in map_.names.items():
        quality = made.quality(name)
        assert quality.wanted_volume == pytest.approx(map_.volume(label))
        assert abs(quality.volume / quality.wanted_volume - 1) < 0.01
        assert quality.least_angle >= 10 and quality.largest_angle <= 170 and quality.flat == 0
        assert quality.mean_distance < 0.1 * made.size


def test_neighbours_share_nodes_and_the_engine_accepts_every_mesh(patient):
    _, made = patient
    mesh = made.mesh()
    assert mesh.label_names == {"liver": 1, "gallbladder": 2, "hepatic_vein": 3, "vertebra": 4}
    assert ("liver", "gallbladder") in made.neighbours() and ("gallbladder", "vertebra") not in made.neighbours()
    for name in made.names.values():
        assert len(made.mesh(name).tetrahedra) == (made.labels == made.label(name)).sum()
    first, second = made.shared("liver", "gallbladder")
    assert len(first) >= 3
    assert np.array_equal(made.organ("liver").nodes[first], made.organ("gallbladder").nodes[second])
    # The whole is closed: organs leave no gap and do not overlap, so its volume is what its boundary encloses.
    boundary = _shapes.boundary(made.tetrahedra)
    assert _shapes.enclosed(made.nodes, boundary) == pytest.approx(_shapes.volumes(made.nodes, made.tetrahedra).sum(), rel=1e-9)


def test_the_same_input_gives_the_same_bits(patient):
    map_, made = patient
    again = anatomy.mesh_labels(map_, 6000)
    assert np.array_equal(again.nodes, made.nodes) and np.array_equal(again.tetrahedra, made.tetrahedra)


def test_surfaces_of_the_mesh_lie_on_a_known_sphere():
    """Hausdorff and mean distance against the formula, not against the image."""
    radius = 0.03
    map_ = phantoms.label_map({"liver": phantoms.ellipsoid((0, 0, 0), (radius,) * 3)}, (-0.04,) * 3, (0.04,) * 3, 1e-3)
    made = anatomy.mesh_labels(map_, 4000)
    off = np.linalg.norm(made.collision("liver")[0], axis=1) - radius
    assert np.abs(off).max() < 0.2 * made.size and np.abs(off).mean() < 0.05 * made.size
    picture = made.picture("liver")
    off = np.linalg.norm(picture.vertices, axis=1) - radius
    assert np.abs(off).max() < 0.7e-3 and np.abs(off).mean() < 0.2e-3
    assert np.einsum("ij,ij->i", picture.normals, picture.vertices).min() > 0.98 * radius
    assert picture.uv.min() >= 0 and picture.uv.max() <= 1 and len(picture.uv) == len(picture.vertices)
    assert made.quality("liver").hausdorff == pytest.approx(np.abs(off).max(), abs=1.2e-3)


def test_gradients_of_the_energies_are_those_of_their_values():
    from filasofia.anatomy import _fields, _fit

    random = np.random.default_rng(0)
    nodes = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]) + 0.1 * random.normal(size=(4, 3))
    tetrahedra = np.array([[0, 1, 2, 3]])
    fields = _fields.Fields(np.full(3, -2.0), 0.5, random.normal(size=(2, 9, 9, 9)).astype(np.float32), np.arange(2))
    faces = _fit.Interface(np.array([[0, 1, 2]]), np.array([0]), np.array([1]), np.zeros((1, 2), int), np.ones(1))
    for energy, corners in ((lambda x: _fit.shape_energy(x, tetrahedra), 4), (lambda x: _fit.distance_energy(fields, x, faces), 3)):
        slope = energy(nodes)[1][0]
        for i in range(corners):
            for k in range(3):
                step = np.zeros((4, 3))
                step[i, k] = 1e-6
                assert slope[i, k] == pytest.approx((energy(nodes + step)[0][0] - energy(nodes - step)[0][0]) / 2e-6, rel=1e-4, abs=1e-6)


def test_files_are_read_back_exactly(patient, tmp_path):
    _, made = patient
    report = anatomy.write_anatomy(made, str(tmp_path / "a.msh"), str(tmp_path / "parts"))
    back = fs.load_tet_mesh(str(tmp_path / "a.msh"))
    assert back == made.mesh() and back.label_names == made.mesh().label_names
    assert json.loads((tmp_path / "parts/report.json").read_text()) == json.loads(json.dumps(report))
    for name in made.names.values():
        assert fs.load_tet_mesh(str(tmp_path / f"parts/{name}.msh")) == made.mesh(name)
        picture = fs.load_triangle_mesh(str(tmp_path / f"parts/{name}.obj"))
        assert len(picture.triangles) == 16 * len(fs.load_triangle_mesh(str(tmp_path / f"parts/{name}_collision.obj")).triangles)
        assert len(picture.uv) == len(picture.vertices)
    pair = report["attachments"][0]
    assert len(pair["nodes"]) == len(pair["to_nodes"]) > 0
    kept, _ = anatomy.anatomy_of([str(tmp_path / "a.msh")])
    assert np.array_equal(kept.nodes, made.nodes) and kept.names == made.names


@pytest.mark.parametrize("separate", (False, True))
def test_a_scene_of_a_label_map_moves_and_stays_whole(patient, tmp_path, separate):
    _, made = patient
    file = str(tmp_path / "scene.json")
    notes = anatomy.write_scene(made, file, {"gallbladder": "bladder"}, separate=separate)
    assert len(notes) == 1 and "'hepatic_vein' is a hollow organ" in notes[0]
    scene = json.loads((tmp_path / "scene.json").read_text())
    liver = next(body for body in scene["bodies"] if body["name"].startswith("liver"))
    assert liver["material"]["tissue"] == "liver" and liver["attachments"][0]["to"] == "vertebra"
    if not separate:
        stiff = {region["where"]["name"]: region["youngModulus"] for region in liver["material"]["regions"]}
        assert stiff["gallbladder"] == fs.tissue("bladder").material.young_modulus
    with fs.load(file, threads=1) as sim:
        soft = sim.bodies[1]
        sim.step()
        rest = sim.frame[soft].positions.copy()
        sim.step(20)
        assert np.abs(sim.frame[soft].positions - rest).max() < 1e-6  # the image shows them at rest
        top = rest[rest[:, 1].argmax()]
        ball = sim.add(fs.RigidBodyDef(name="ball", elements=[top + [0, 0.009, 0]], mesh=fs.shapes.sphere(0.008), collision=[fs.CollisionDef()]))
        sim.step()
        report = sim.step(80, moves={ball: top + [0, -0.002, 0]})
        moved = np.abs(sim.frame[soft].positions - rest).max()
        assert 0.003 < moved < 0.02 and report.inverted.count == 0


def bunny():
    mesh = fs.load_triangle_mesh(fs.asset("meshes/bunny.obj"))
    return np.array(mesh.vertices), np.array(mesh.triangles)


def test_broken_surfaces_are_told_and_repaired():
    v, f = bunny()
    whole = anatomy.mesh_surfaces({"bunny": (v, f)}, 2000)
    quality = whole.quality("bunny")
    volume = _shapes.enclosed(v, f)
    assert whole.notes == [] and abs(quality.volume / volume - 1) < 0.01 and quality.least_angle >= 10
    mixed = np.where(np.random.default_rng(0).random(len(f))[:, None] < 0.1, f[:, ::-1], f)
    far = np.linalg.norm(v[f].mean(axis=1) - v[f[100]].mean(axis=0), axis=1) > 0.012
    broken = anatomy.mesh_surfaces({"bunny": (1e3 * v, mixed[far])}, 2000)
    assert [re.sub(r"\d[\d.]*", "N", note) for note in broken.notes] == [
        "bunny: it is N large, so its unit is taken for millimetres (--scale N says metres)",
        "bunny: N edges have a triangle on one side only: its holes are closed",
        "bunny: N triangles faced the other way than their neighbours and were turned",
    ]
    assert abs(broken.quality("bunny").volume / volume - 1) < 0.01
    soup = anatomy.mesh_surfaces({"bunny": (v[f].reshape(-1, 3), np.arange(3 * len(f)).reshape(-1, 3)[:, ::-1])}, 2000)
    assert "vertices lay on others" in soup.notes[0] and "faced inwards" in soup.notes[1]
    assert np.array_equal(soup.tetrahedra, whole.tetrahedra)


def test_a_surface_through_itself_is_one_solid():
    ball = fs.shapes.ellipsoid((0.03, 0.02, 0.02))
    v, f = np.array(ball.vertices), np.array(ball.triangles)
    two = anatomy.mesh_surfaces({"two": (np.concatenate([v, v + [0.03, 0, 0]]), np.concatenate([f, f + len(v)]))}, 2000)
    assert any("passes through itself" in note for note in two.notes)
    x = np.linspace(0.015, 0.03, 2001)  # of an ellipsoid that is cut at x = 0.015, the cap that both have twice
    lens = 2 * np.trapezoid(np.pi * 0.02**2 * (1 - (x / 0.03) ** 2), x) if hasattr(np, "trapezoid") else 2 * np.trapz(np.pi * 0.02**2 * (1 - (x / 0.03) ** 2), x)
    assert two.quality("two").volume == pytest.approx(2 * _shapes.enclosed(v, f) - lens, rel=0.02)


@pytest.mark.parametrize(
    "act, says",
    [
        (lambda: anatomy.LabelMap(np.zeros((3, 3, 3), int)), "every voxel is 0"),
        (lambda: anatomy.LabelMap(np.full((3, 3, 3), 0.5)), "labels must be whole numbers"),
        (lambda: anatomy.LabelMap(np.arange(4096).reshape(16, 16, 16)), "may have 256 labels, got 4096"),
        (lambda: anatomy.LabelMap(np.ones((3, 3), int)), "3 dimensions, got 2"),
        (lambda: anatomy.LabelMap(np.ones((3, 3, 3), int), spacing=0.0), "size of a voxel must be in (1e-7, 1) m"),
        (lambda: anatomy.LabelMap(np.ones((3, 3, 3), int), np.eye(4) * 1e-3 + np.eye(4, k=1) * 1e-3), "right angles"),
        (lambda: anatomy.mesh_labels(phantoms.vessel(4e-3), 3), "tetrahedra must be in [20, 5e+06], got 3"),
        (lambda: anatomy.mesh_labels(phantoms.vessel(4e-3), size=0.2), "label 1 is thinner than the elements of 200 mm"),
        (lambda: anatomy.mesh_labels(phantoms.vessel(4e-3), size=1e-5), "too small for this image"),
        (lambda: anatomy.mesh_surfaces({"a": (np.eye(3), [[0, 1, 3]])}), "triangles must name vertices in [0, 3)"),
        (lambda: anatomy.mesh_surfaces({"a": (np.full((3, 3), np.nan), [[0, 1, 2]])}), "vertex 0 must be finite"),
        (lambda: anatomy.mesh_surfaces({"flat": ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [2, 0, 0], [2, 1, 0]], [[0, 1, 2], [1, 3, 2], [1, 4, 3], [4, 5, 3]])}), "encloses no volume"),
        (lambda: anatomy.read_labels("none.nii"), "none.nii: No such file"),
        (lambda: anatomy.anatomy_of(["a.stl", "b.nii"]), "several files must all be surfaces, got b.nii"),
    ],
)  # fmt: skip
def test_what_cannot_be_meshed_is_refused(act, says):
    with pytest.raises(fs.Error, match=re.escape(says)):
        act()


@pytest.mark.parametrize("millimetres", [0.2, 1, 6])
def test_the_probe_of_a_scene_begins_outside_of_organs_of_any_size(millimetres, tmp_path):
    map_ = anatomy.LabelMap(np.pad(np.ones((20, 20, 20), np.uint8), 3), spacing=millimetres * 1e-3, names={1: "kidney"})
    anatomy.write_scene(anatomy.mesh_labels(map_, 800), str(tmp_path / "a.json"))
    with fs.load(str(tmp_path / "a.json"), threads=1) as sim:
        sim.step(20)
        assert sim.report().intersecting == 0 and not sim.report().contacts


@pytest.mark.parametrize("reader", fuzz_labels.READERS)
def test_damaged_label_maps_are_read_or_refused(reader, tmp_path):
    """tests/python/fuzz_labels.py does a million."""
    read, refused = fuzz_labels.run(reader, fuzz_labels.seeds(tmp_path)[reader], 4000, 0)
    assert read > 100 and refused > 1000


def test_ten_gigabytes_in_a_header_are_refused_before_they_are_asked_for(tmp_path):
    file = str(tmp_path / "a.nii.gz")
    anatomy.write_labels(phantoms.vessel(4e-3), file)
    import gzip
    import struct
    import tracemalloc

    head = bytearray(gzip.decompress((tmp_path / "a.nii.gz").read_bytes()))
    for shape, says in (((2200, 2200, 1034), "announces 10009120000 bytes"), ((1000, 1000, 500), "announces 1000000000 bytes of voxels, but the file has")):
        struct.pack_into("<8h", head, 40, 3, *shape, 1, 1, 1, 1)
        for packed in (bytes(head), gzip.compress(bytes(head))):
            tracemalloc.start()
            with pytest.raises(fs.Error, match=says):
                _read.parse_nifti(packed, file)
            peak = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            assert peak < 4 << 20


def test_readers_agree_on_one_patient(tmp_path):
    """One map as NIfTI, NRRD and MetaImage, the latter two with ITK's axes, to the left and to the back."""
    map_ = phantoms.vessel(4e-3)
    anatomy.write_labels(map_, str(tmp_path / "a.nii"))
    raw, sizes = map_.array.astype(np.uint8).tobytes(order="F"), " ".join(map(str, map_.array.shape))
    origin = 1e3 * map_.affine[:3, 3] * [-1, -1, 1]
    (tmp_path / "a.nrrd").write_bytes(
        f"NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: {sizes}\nspace directions: (-4,0,0) (0,-4,0) (0,0,4)\n"
        f"encoding: raw\nspace origin: ({','.join(map(repr, origin.tolist()))})\nSegment0_Name:=portal vein\nSegment0_LabelValue:=1\n\n".encode() + raw
    )
    (tmp_path / "a.mha").write_bytes(
        f"ObjectType = Image\nNDims = 3\nDimSize = {sizes}\nTransformMatrix = -1 0 0 0 -1 0 0 0 1\nOffset = {' '.join(map(repr, origin.tolist()))}\n"
        f"ElementSpacing = 4 4 4\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n".encode() + raw
    )
    for ending in ("nii", "nrrd", "mha"):
        read = anatomy.read_labels(str(tmp_path / f"a.{ending}"))
        assert np.array_equal(read.array, map_.array)
        assert np.allclose(read.affine, map_.affine, atol=1e-7)
    assert anatomy.read_labels(str(tmp_path / "a.nrrd")).names == {1: "portal vein"}
    anatomy.write_labels(map_, str(tmp_path / "b.nrrd"))
    read = anatomy.read_labels(str(tmp_path / "b.nrrd"))
    assert np.array_equal(read.array, map_.array) and np.allclose(read.affine, map_.affine, atol=1e-9) and read.names == map_.names


@pytest.mark.parametrize("kind", ["BINARY", "FRACTIONAL", "LABELMAP"])
def test_a_dicom_segmentation_is_the_map_it_was_written_from(kind, tmp_path):
    map_ = phantoms.liver_and_gallbladder(8e-3)
    dicom_seg.write(map_, tmp_path / "a.dcm", kind)
    read = anatomy.read_labels(tmp_path / "a.dcm")
    assert list(read.names.values()) == list(map_.names.values())
    for label, name in map_.names.items():
        written = map_.world(np.argwhere(map_.array == label))
        mine = read.world(np.argwhere(read.array == next(n for n, own in read.names.items() if own == name)))
        assert np.allclose(np.array(sorted(mine.round(6).tolist())), np.array(sorted(written.round(6).tolist())), atol=2e-6)


def test_dicom_segmentations_that_cannot_be_read_are_refused(tmp_path):
    map_ = phantoms.liver_and_gallbladder(12e-3)
    file = tmp_path / "a.dcm"
    dicom_seg.write(map_, file, "BINARY", overlap=True)
    with pytest.raises(fs.Error, match="a.dcm: its segments overlap; export them as a label map"):
        anatomy.read_labels(file)
    dicom_seg.write(map_, file, "BINARY", names=dict.fromkeys(map_.names, "kidney"))
    assert list(anatomy.read_labels(file).names.values()) == ["kidney_1", "kidney_2", "kidney_3", "kidney_4"]
    whole, chance, refused = file.read_bytes(), np.random.default_rng(0), 0
    for turn in range(40):
        data = bytearray(whole[: chance.integers(140, len(whole))] if turn % 2 else whole)
        data[chance.integers(132, min(6000, len(data)))] = 255
        file.write_bytes(data)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                anatomy.read_labels(file)
        except fs.Error as problem:
            assert "a.dcm" in str(problem)
            refused += 1
    assert refused >= 10


def test_segments_of_3d_slicer_that_overlap_lie_in_layers(tmp_path):
    layers = np.zeros((2, 4, 3, 2), np.uint8)
    layers[0, :3], layers[1, 2:] = 1, 1
    layers[0, 3] = 2
    head = (
        "NRRD0004\ntype: unsigned char\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 4 3 2\nkinds: list domain domain domain\n"
        "space directions: none (4,0,0) (0,4,0) (0,0,4)\nencoding: raw\nspace origin: (0,0,0)\n"
        + "".join(f"Segment{n}_Name:={name}\nSegment{n}_LabelValue:={label}\nSegment{n}_Layer:={layer}\n"
                  for n, (name, label, layer) in enumerate([("liver", 1, 0), ("bone", 2, 0), ("tumour", 1, {})]))
    )  # fmt: skip
    (tmp_path / "a.seg.nrrd").write_bytes((head.format(1) + "\n").encode() + layers.tobytes(order="F"))
    read = anatomy.read_labels(tmp_path / "a.seg.nrrd")
    assert read.names == {1: "liver", 3: "tumour"}  # all of the bone is under the tumour
    assert [np.unique(read.array[i]).tolist() for i in range(4)] == [[1], [1], [3], [3]]
    assert read.spacing.tolist() == pytest.approx([4e-3] * 3)
    (tmp_path / "a.seg.nrrd").write_bytes((head.format(2) + "\n").encode() + layers.tobytes(order="F"))
    with pytest.raises(fs.Error, match="Segment2_Layer must be below 2, got 2"):
        anatomy.read_labels(tmp_path / "a.seg.nrrd")


def test_names_come_from_itk_snap_and_json(tmp_path):
    (tmp_path / "a.txt").write_text('# ITK-SnAP\n    0     0    0    0        0  0  0    "Clear Label"\n    1   255    0    0        1  1  1    "Liver"\n')
    (tmp_path / "a.json").write_text('{"1": "Liver", "2": {"name": "Tumour", "tissue": "fibroid"}}')
    assert anatomy.read_names(str(tmp_path / "a.txt"))[0] == {0: "Clear Label", 1: "Liver"}
    assert anatomy.read_names(str(tmp_path / "a.json")) == ({1: "Liver", 2: "Tumour"}, {"Tumour": "fibroid"})
    (tmp_path / "b.txt").write_text("liver\n")
    with pytest.raises(fs.Error, match="b.txt:1: a line of an ITK-SNAP label file"):
        anatomy.read_names(str(tmp_path / "b.txt"))
    known = {each.name for each in fs.tissues()}
    for name, tissue in {"kidney_left": "kidney", "Liver": "liver", "vertebrae_L1": None, "costal_cartilages": "cartilage", "gluteus_maximus_left": "skeletal_muscle"}.items():
        assert anatomy.kind_of(name).tissue == tissue
    assert anatomy.kind_of("vertebrae_L1").bone and anatomy.kind_of("rib_left_3").bone and not anatomy.kind_of("portal_vein").bone
    from filasofia.anatomy import _names

    assert {kind.tissue for _, kind in _names._KINDS} - {None} <= known


def test_the_commands_of_the_guide_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for page, least in (("slicer", 1), ("patient", 2)):
        with open(os.path.join(ROOT, f"docs/guide/{page}.md")) as file:
            text = file.read()
        blocks = re.findall(r"```python\n(.*?)```", text, flags=re.S)
        assert len(blocks) >= least
        names: dict = {}
        for block in blocks:  # the first one of patient.md writes patient.nii.gz
            exec(compile(block, f"docs/guide/{page}.md", "exec"), names)
        if page == "slicer":
            shutil.rmtree(tmp_path / "patient_files")
            (tmp_path / "patient.json").unlink()
    commands = re.findall(r"^    filasofia ((?:mesh|scene) .*)$", text, flags=re.M)
    assert len(commands) >= 3
    for command in commands:
        if "--picture" in command or "INPUT" in command:
            continue
        words = command.split("#")[0].split()
        assert main([*words, "--tetrahedra", "1500"] if "--size" not in words and "--tetrahedra" not in words else words) == 0, command
    said = capsys.readouterr()
    assert "wrote patient.json" in said.out and "smallest angle" in said.err
    for name in set(re.findall(r"\banatomy\.(\w+)", text)):
        assert hasattr(anatomy, name), name


def test_wrong_words_are_refused_in_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    anatomy.write_labels(phantoms.vessel(4e-3), "a.nii")
    (tmp_path / "b.nii").write_bytes((tmp_path / "a.nii").read_bytes()[:1000])
    for words, says in {
        "mesh": "the following arguments are required",
        "mesh a.nii -o a.txt": "--output must end with .msh, got 'a.txt'",
        "mesh none.nii -o a.msh": "none.nii: No such file or directory",
        "mesh b.nii -o a.msh": "b.nii: the header announces 15686 bytes of voxels, but the file has 648",
        "mesh a.nii -o a.msh --labels 7": "a.nii: has no label 7; it has [1]",
        "mesh a.nii -o a.msh --size 4parsec": "must be a length such as 4mm",
        "mesh a.nii -o none/a.msh": "the folder of 'none/a.msh' must exist",
        "mesh a.nii -o a.msh --tetrahedra 10000000": "tetrahedra must be in [20, 5e+06], got 1e+07",
        "mesh a.nii -o a.msh --bogus": "filasofia: unrecognized arguments: --bogus",
        "scene new a.nii --picture none/a.png": "scene: the folder of 'none/a.png' must exist",
        "scene new a.nii -o a.txt": "a.txt: a scene file must end with .json",
    }.items():  # fmt: skip
        assert main([*words.split(), "--quiet"] if words != "mesh" else ["mesh"]) == 2, words
        error = capsys.readouterr().err
        assert error.startswith("filasofia: ") and error.count("\n") == 1 and says in error, (words, error)


def test_without_scipy_one_line_says_what_to_install(tmp_path):
    program = (
        "import sys\nclass None_:\n def find_spec(self, name, *rest):\n  if name.split('.')[0] == 'scipy': raise ImportError('none')\nsys.meta_path.insert(0, None_())\n"
        "from filasofia.anatomy.__main__ import main\nfrom filasofia.anatomy import phantoms, write_labels\n"
        "write_labels(phantoms.vessel(4e-3), 'a.nii')\nsys.exit(main(['mesh', 'a.nii', '-o', 'a.msh', '--quiet']))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (2, "filasofia: meshing needs the package scipy: pip install scipy (or pip install 'filasofia[anatomy]')\n")


def test_the_program_of_cpp_hands_over(tmp_path):
    program = os.path.join(os.path.dirname(os.environ["FILASOFIA_BUNNY"]), "filasofia")
    if not os.path.exists(program):
        pytest.skip("the program filasofia is not built")
    anatomy.write_labels(phantoms.vessel(4e-3), str(tmp_path / "a.nii"))
    done = subprocess.run([program, "mesh", "a.nii", "-o", "a.msh", "--tetrahedra", "500", "--quiet"], capture_output=True, text=True, cwd=tmp_path,
                          env={**os.environ, "FILASOFIA_PYTHON": sys.executable})  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "") and "wrote a.msh" in done.stdout
    assert len(fs.load_tet_mesh(str(tmp_path / "a.msh")).tetrahedra) > 400


def test_the_centre_line_of_a_tube_is_in_its_middle():
    map_ = phantoms.label_map({"vein": phantoms.tube([(0, 0, -0.05), (0, 0, 0.0), (0.03, 0, 0.03)], 0.006)}, (-0.01, -0.01, -0.06), (0.04, 0.01, 0.04), 1e-3)
    line = anatomy.centre_line(map_, 1)
    off = phantoms.tube([(0, 0, -0.05), (0, 0, 0.0), (0.03, 0, 0.03)], 0.006)(line) + 0.006
    assert off[5:-5].max() < 1.5e-3 and np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(0.05 + 0.03 * 2**0.5 + 0.012, abs=6e-3)
