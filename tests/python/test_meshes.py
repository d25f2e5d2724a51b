"""Meshes from arrays, from files and from shapes."""
import copy
import pickle

import numpy as np
import pytest

import filasofia as fs

NODES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)


def test_a_mesh_from_arrays_has_their_numbers():
    mesh = fs.TetMesh(NODES, [[0, 1, 2, 3]], labels=[7])
    assert np.array_equal(mesh.nodes, NODES)
    assert mesh.tetrahedra.dtype == np.int32 and mesh.tetrahedra.tolist() == [[0, 1, 2, 3]]
    assert mesh.labels.tolist() == [7]
    assert repr(mesh) == "TetMesh(4 nodes, 1 tetrahedra)"
    assert copy.deepcopy(mesh) is mesh
    surface = fs.TriangleMesh(NODES[:3], np.array([[0, 1, 2]], dtype=np.uint8))
    assert surface.triangles.tolist() == [[0, 1, 2]]
    assert surface.uv.shape == (0, 2)


def test_nodes_that_no_tetrahedron_uses_are_dropped_and_told_as_in_files(capfd):
    extra = np.insert(NODES, [1, 4], [[5, 5, 5], [6, 6, 6]], axis=0)
    mesh = fs.TetMesh(extra, [[0, 2, 3, 4]])
    assert np.array_equal(mesh.nodes, NODES) and mesh.tetrahedra.tolist() == [[0, 1, 2, 3]]
    assert "TetMesh: 2 nodes that no tetrahedron uses were dropped" in capfd.readouterr().err
    with pytest.raises(fs.Error, match=r"names node 9; it must be in \[0, 6\)"):
        fs.TetMesh(extra, [[0, 2, 3, 9]])
    fs.TetMesh(NODES, [[0, 1, 2, 3]])
    assert capfd.readouterr().err == ""


def test_a_folder_is_no_mesh_file(tmp_path):
    with pytest.raises(fs.Error, match="must be a file, got a directory"):
        fs.Simulation().add(fs.SoftBodyDef(mesh=str(tmp_path)))


def test_any_layout_of_an_array_is_read():
    wide = np.zeros((4, 6))
    wide[:, ::2] = NODES
    for nodes in (wide[:, ::2], np.asfortranarray(NODES), NODES.astype(np.float32), NODES.astype(int), NODES.tolist()):
        assert np.array_equal(fs.TetMesh(nodes, [[0, 1, 2, 3]]).nodes, NODES)


def test_views_of_a_mesh_cannot_be_written_and_outlive_it():
    mesh = fs.TetMesh(NODES, [[0, 1, 2, 3]])
    nodes = mesh.nodes
    with pytest.raises(ValueError):
        nodes[0, 0] = 1
    del mesh
    assert np.array_equal(nodes, NODES)


@pytest.mark.parametrize(
    "nodes, tetrahedra, error, says",
    [
        (np.full((4, 3), np.nan), [[0, 1, 2, 3]], fs.Error, "finite"),
        (np.where(NODES > 0, np.inf, 0), [[0, 1, 2, 3]], fs.Error, "finite"),
        (NODES, [[0, 1, 2, 4]], fs.Error, "TetMesh"),
        (NODES, [[0, 1, 2, -1]], fs.Error, "TetMesh"),
        (NODES, [[0, 2, 1, 3]], fs.Error, "volume"),
        (NODES, np.zeros((0, 4), dtype=int), fs.Error, "TetMesh"),
        (NODES, [[0, 1, 2]], fs.Error, "TetMesh: tetrahedra must have the shape (n, 4), got (1, 3)"),
        (NODES[:, :2], [[0, 1, 2, 3]], fs.Error, "TetMesh: nodes must have the shape (n, 3), got (4, 2)"),
        (NODES.ravel(), [[0, 1, 2, 3]], fs.Error, "TetMesh: nodes must have the shape (n, 3), got (12,)"),
        (NODES, [[0.0, 1.0, 2.0, 3.0]], TypeError, "TetMesh: tetrahedra must be an array of whole numbers, got an array of float64"),
        (NODES.astype(complex), [[0, 1, 2, 3]], TypeError, "TetMesh: nodes must be an array of real numbers"),
        (NODES.astype(object), [[0, 1, 2, 3]], TypeError, "got an array of object"),
        ("nodes", [[0, 1, 2, 3]], TypeError, "TetMesh: nodes must be an array of real numbers"),
        (None, [[0, 1, 2, 3]], TypeError, "TetMesh: nodes"),
        ([[0, 0, 0], [1]], [[0, 1, 2, 3]], TypeError, "TetMesh: nodes must be an array of numbers"),
        (NODES, [[0, 1, 2, 2**40]], fs.Error, "TetMesh: tetrahedra must have whole numbers below 2^31"),
        (NODES > 0, [[0, 1, 2, 3]], TypeError, "got an array of bool"),
    ],
)
def test_wrong_arrays_are_refused(nodes, tetrahedra, error, says):
    with pytest.raises(error) as caught:
        fs.TetMesh(nodes, tetrahedra)
    assert says in str(caught.value)


def test_shapes_and_files():
    assert len(fs.shapes.block((0.1, 0.1, 0.1), (2, 2, 2)).tetrahedra) == 48
    assert len(fs.shapes.sphere(0.01, quarter=2).triangles) == 32
    assert len(fs.shapes.sheet(0.1, 0.2, (2, 3)).triangles) == 12
    assert fs.shapes.sheet(0.1, 0.2).uv.size == 0
    assert fs.shapes.sheet(0.1, 0.2, (2, 3), printed=True).uv.shape == (12, 2)
    ring = fs.shapes.revolved([(0.02, 0, 0), (0.03, 0, 0), (0.03, 0.01, 0), (0.02, 0.01, 0)], sides=12)
    assert len(ring.vertices) == 48 and len(ring.triangles) == 96
    assert np.hypot(*np.asarray(ring.vertices)[:, [0, 2]].T).max() == pytest.approx(0.03)
    with pytest.raises(fs.Error, match="radius"):
        fs.shapes.sphere(-1)
    with pytest.raises(fs.Error, match=r"revolved: corners\[0\].x must be >= 0 m, got -1"):
        fs.shapes.revolved([(-1, 0, 0), (1, 0, 0), (0, 1, 0)])
    mesh = fs.load_tet_mesh(fs.asset("meshes/bunny_756.msh"))
    assert len(mesh.tetrahedra) == 754
    assert np.allclose(fs.load_tet_mesh(fs.asset("meshes/bunny_756.msh"), scale=2).nodes, 2 * mesh.nodes)
    assert len(fs.load_triangle_mesh(fs.asset("meshes/bunny.obj")).triangles) > 1000
    with pytest.raises(fs.Error, match="nothing.msh"):
        fs.load_tet_mesh("nothing.msh")
    with pytest.raises(fs.Error, match="labels names a list of a .vtk or .vtu file, got 'part'"):
        fs.load_tet_mesh(fs.asset("meshes/bunny_756.msh"), labels="part")
    with pytest.raises(fs.Error, match="nothing.msh"):
        fs.asset("meshes/nothing.msh")


def meshes():
    yield fs.TetMesh(NODES, [[0, 1, 2, 3]], labels=[7], label_names={"cöre": 7})
    yield fs.TriangleMesh(NODES[:3], [[0, 1, 2]], uv=[[0, 0], [1, 0], [0, 1]])
    yield fs.shapes.block((1, 1, 1))
    yield fs.shapes.sphere(0.01)
    yield fs.load_tet_mesh(fs.asset("meshes/bunny_756.msh"))
    yield fs.load_triangle_mesh(fs.asset("meshes/bunny.obj"))


def test_meshes_and_the_defs_that_hold_them_are_pickled_copied_and_compared():
    for mesh in meshes():
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            again = pickle.loads(pickle.dumps(mesh, protocol))
            assert again is not mesh and again == mesh and not again != mesh and hash(again) == hash(mesh)
            assert type(again) is type(mesh) and repr(again) == repr(mesh)
        assert copy.copy(mesh) is mesh
        kind = fs.SoftBodyDef if isinstance(mesh, fs.TetMesh) else fs.RigidBodyDef
        body = kind(mesh=mesh)
        assert pickle.loads(pickle.dumps(body)) == copy.deepcopy(body) == body
    assert next(meshes()).label_names == pickle.loads(pickle.dumps(next(meshes()))).label_names == {"cöre": 7}


def test_different_meshes_are_not_equal():
    mesh = fs.TetMesh(NODES, [[0, 1, 2, 3]])
    assert mesh == fs.TetMesh(-0.0 * NODES + NODES, [[0, 1, 2, 3]])
    assert mesh != fs.TetMesh(2 * NODES, [[0, 1, 2, 3]])
    assert mesh != fs.TetMesh(NODES, [[1, 2, 0, 3]])
    assert mesh != fs.TetMesh(NODES, [[0, 1, 2, 3]], labels=[1])
    assert mesh != fs.TriangleMesh(NODES, [[0, 1, 2]]) and mesh != "mesh" and mesh is not None
    assert fs.SoftBodyDef(mesh=mesh) != fs.SoftBodyDef(mesh=fs.TetMesh(2 * NODES, [[0, 1, 2, 3]]))


def test_names_of_labels_are_checked():
    with pytest.raises(TypeError, match="TetMesh: label_names must be a dict"):
        fs.TetMesh(NODES, [[0, 1, 2, 3]], label_names=["a"])
    with pytest.raises(TypeError, match="TetMesh: label_names: a must be a whole number, got 'b'"):
        fs.TetMesh(NODES, [[0, 1, 2, 3]], labels=[1], label_names={"a": "b"})


@pytest.mark.parametrize("kind", [np.uint8, np.uint32, np.uint64])
def test_unsigned_indices_are_read_and_never_wrap(kind):
    assert fs.TetMesh(NODES, np.array([[0, 1, 2, 3]], dtype=kind)).tetrahedra.tolist() == [[0, 1, 2, 3]]
    assert fs.TetMesh(NODES, [[0, 1, 2, 3]], labels=np.zeros(0, dtype=kind)).labels.shape == (0,)
    if kind is np.uint8:
        return
    largest = np.iinfo(kind).max
    with pytest.raises(fs.Error, match=f"TetMesh: labels must have whole numbers below 2.31, got {largest}"):
        fs.TetMesh(NODES, [[0, 1, 2, 3]], labels=np.array([largest], dtype=kind))
