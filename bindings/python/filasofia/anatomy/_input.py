"""Any file of a patient becomes an anatomy: label maps, surfaces, tetrahedra."""

from __future__ import annotations

import os as _os
import typing as _typing

import numpy as np

import filasofia as _fs

from . import _shapes
from ._anatomy import Anatomy, mesh_labels
from ._labels import LabelMap
from ._needs import need
from ._read import read_bytes, read_labels
from ._solids import mesh_surfaces
from ._types import Array, Tell, silent

SURFACES = (".stl", ".ply", ".obj", ".gltf", ".glb", ".off", ".vtp")
TETRAHEDRA = (".msh", ".vtu", ".node", ".ele", ".inp", ".xdmf", ".med", ".mesh")
_OURS = (".msh", ".mesh", ".vtk", ".vtu", ".node", ".ele")


def _ending(file: str) -> str:
    return _os.path.splitext(file.lower())[1]


def is_surface(file: str) -> bool:
    return _ending(file) in SURFACES or (_ending(file) == ".vtk" and b"POLYDATA" in read_bytes(file)[:4096].upper())


def is_tetrahedra(file: str) -> bool:
    return _ending(file) in TETRAHEDRA or (_ending(file) == ".vtk" and not is_surface(file))


def read_surface(file: str) -> tuple[Array, Array]:
    """Vertices and triangles in the file's own unit."""
    read_bytes(file)  # says what is wrong with the file, before others do
    mesh = _fs.load_triangle_mesh(file)
    return mesh.vertices, mesh.triangles


def read_tetrahedra(file: str, scale: _typing.Optional[float] = None) -> Anatomy:
    """Tetrahedra as they are, with their labels and names."""
    if _ending(file) in _OURS:
        mesh = _fs.load_tet_mesh(file)
        nodes, tetrahedra = np.array(mesh.nodes), np.array(mesh.tetrahedra, np.int64)
        labels, names = np.array(mesh.labels, np.int64), {label: name for name, label in mesh.label_names.items()}
    else:
        nodes, tetrahedra, labels, names = _with_meshio(file)
    if not len(labels):
        labels = np.ones(len(tetrahedra), np.int64)
    notes = []
    room = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    if scale is None and room > 3.0:
        notes.append(f"{file}: it is {room:.4g} large, so its unit is taken for millimetres (--scale 1 says metres)")
        scale = 1e-3
    nodes = nodes * (scale or 1.0)
    turned = _shapes.volumes(nodes, tetrahedra) < 0.0
    if turned.any():
        tetrahedra[turned] = tetrahedra[turned][:, [0, 2, 1, 3]]
        notes.append(f"{file}: {int(turned.sum())} tetrahedra were inside out and were turned")
    nodes, tetrahedra, _ = _shapes.compact(nodes, tetrahedra)
    stem = _os.path.splitext(_os.path.basename(file))[0]
    present = [int(label) for label in np.unique(labels)]
    known = {label: names.get(label, stem if len(present) == 1 else f"label_{label}") for label in present}
    size = float((12.0 * np.abs(_shapes.volumes(nodes, tetrahedra)).mean()) ** (1 / 3))
    out = Anatomy(nodes, tetrahedra, labels, known, None, size)
    out.notes = notes
    out.mesh()  # refused here if the engine refuses it
    return out


def _with_meshio(file: str) -> tuple[Array, Array, Array, dict[int, str]]:
    meshio = need("meshio", "meshio", f"{file}: this kind of mesh")
    read_bytes(file)  # says what is wrong with the file, before others do
    try:
        mesh = meshio.read(file)
        blocks = [i for i, block in enumerate(mesh.cells) if block.type == "tetra"]
        if not blocks:
            raise _fs.Error(f"{file}: has no tetrahedra of four nodes; it has {', '.join(sorted({b.type for b in mesh.cells})) or 'nothing'}")
        tetrahedra = np.concatenate([np.asarray(mesh.cells[i].data, np.int64) for i in blocks])
        labels = next((np.concatenate([np.asarray(data[i]) for i in blocks]) for data in mesh.cell_data.values()
                       if all(np.asarray(data[i]).dtype.kind in "iu" and np.asarray(data[i]).ndim == 1 for i in blocks)), np.zeros(0, np.int64))  # fmt: skip
        labels, names = _sets_of(mesh, blocks, len(tetrahedra)) if not len(labels) and mesh.cell_sets else (labels, {})
        return np.asarray(mesh.points, float)[:, :3], tetrahedra, labels.astype(np.int64), names
    except _fs.Error:
        raise
    except (Exception, SystemExit) as problem:  # meshio raises many kinds for damaged files, and ends the program for some
        raise _fs.Error(f"{file}: meshio cannot read it: {str(problem).strip()[:200] or type(problem).__name__}") from None


def _sets_of(mesh: _typing.Any, blocks: list[int], count: int) -> tuple[Array, dict[int, str]]:
    """Named sets of elements (Abaqus, MED) as labels; the first set that has an element counts."""
    labels, names = np.zeros(count, np.int64), {}
    start = np.concatenate([[0], np.cumsum([len(mesh.cells[i].data) for i in blocks])])
    for number, (name, lists) in enumerate(mesh.cell_sets.items(), 1):
        parts = [start[k] + np.asarray(lists[i], np.int64) for k, i in enumerate(blocks) if lists[i] is not None]
        mine = np.concatenate(parts) if parts else np.zeros(0, np.int64)
        mine = mine[labels[mine] == 0]
        labels[mine] = number
        if len(mine):
            names[number] = str(name)
    if (labels == 0).any() and names:
        labels[labels == 0] = len(mesh.cell_sets) + 1
        names[len(mesh.cell_sets) + 1] = "rest"
    return labels, names


def anatomy_of(
    files: _typing.Sequence[str],
    tetrahedra: _typing.Optional[int] = None,
    *,
    size: _typing.Optional[float] = None,
    scale: _typing.Optional[float] = None,
    names: _typing.Optional[_typing.Mapping[int, str]] = None,
    labels: _typing.Optional[_typing.Sequence[str]] = None,
    smoothing: float = 0.8,
    tell: Tell = silent,
) -> tuple[Anatomy, _typing.Optional[LabelMap]]:
    """One label map, one mesh of tetrahedra, or one surface for each organ. `labels` chooses some, by number or name."""
    if not files:
        raise _fs.Error("mesh: there must be an input file, got none")
    surfaces = [is_surface(file) for file in files]
    if len(files) > 1 and not all(surfaces):
        raise _fs.Error(f"mesh: several files must all be surfaces, got {files[surfaces.index(False)]}")
    if all(surfaces):
        given = {_os.path.splitext(_os.path.basename(file))[0]: read_surface(file) for file in files}
        if len(given) < len(files):
            raise _fs.Error("mesh: files of surfaces must have different names: they name the organs")
        return mesh_surfaces(given, tetrahedra, size=size, scale=scale, tell=tell), None
    if is_tetrahedra(files[0]):
        out = read_tetrahedra(files[0], scale)
        if tetrahedra is None and size is None:
            return out, None
        again = mesh_surfaces({name: out.collision(name) for name in out.names.values()}, tetrahedra, size=size, scale=1.0, tell=tell)
        again.notes = out.notes + again.notes
        return again, None
    map_ = read_labels(files[0], names)
    tell(f"{files[0]}: {' x '.join(map(str, map_.array.shape))} voxels, {len(map_.labels)} labels")
    if labels:
        map_ = map_.only(_chosen(map_, labels))
    return mesh_labels(map_, tetrahedra, size=size, smoothing=smoothing, tell=tell), map_


def _chosen(map_: LabelMap, words: _typing.Sequence[str]) -> list[int]:
    by_name = {name: label for label, name in map_.names.items()}
    out = []
    for word in words:
        if word in by_name:
            out.append(by_name[word])
        elif word.isascii() and word.isdigit() and len(word) < 10:
            out.append(int(word))
        else:
            raise _fs.Error(f"{map_.source}: has no label '{word}'; it has {', '.join(by_name)}")
    return out
