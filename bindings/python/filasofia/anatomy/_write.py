"""Files of an anatomy: Gmsh for the engine, OBJ for surfaces, JSON for lists."""

from __future__ import annotations

import gzip
import json as _json
import os as _os
import struct
import typing as _typing

import numpy as np

from filasofia import Error

from ._anatomy import Anatomy, Quality
from ._mesh import LEAST_ANGLE
from ._labels import LabelMap
from ._names import plain
from ._picture import Picture
from ._types import Array

_FAR = 0.75  # of the elements' size


def _save(file: str, parts: _typing.Iterable[str]) -> None:
    """Whole or not at all."""
    try:
        with open(file + ".part", "w", encoding="utf-8", newline="\n") as stream:
            stream.writelines(parts)
        _os.replace(file + ".part", file)
    except OSError as problem:
        raise Error(f"{file}: {problem.strerror or problem}") from None


def _rows(form: str, table: Array) -> str:
    return (form * len(table)) % tuple(table.ravel().tolist())


def write_msh(file: str, nodes: Array, tetrahedra: Array, labels: Array, names: _typing.Mapping[int, str]) -> None:
    """Gmsh 2.2: labels are physical groups with names. Coordinates are written so that reading gives the same bits."""
    present = [label for label in names if (labels == label).any()]
    group = "".join(f'3 {label} "{names[label]}"\n' for label in present)
    at = np.array([f"{x!r} {y!r} {z!r}" for x, y, z in nodes.tolist()], dtype=object)
    table = np.concatenate([np.arange(1, len(tetrahedra) + 1)[:, None], labels[:, None], labels[:, None], tetrahedra + 1], axis=1)
    _save(file, [
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n",
        f"$PhysicalNames\n{len(present)}\n{group}$EndPhysicalNames\n",
        f"$Nodes\n{len(nodes)}\n", "".join(f"{i} {words}\n" for i, words in enumerate(at, 1)), "$EndNodes\n",
        f"$Elements\n{len(tetrahedra)}\n", _rows("%d 4 2 %d %d %d %d %d %d\n", table), "$EndElements\n",
    ])  # fmt: skip


def write_obj(file: str, surface: _typing.Union[Picture, tuple[Array, Array]]) -> None:
    """Metres; with uv and normals if the surface has them."""
    corner = surface[1] + 1
    parts = [_rows("v %.9g %.9g %.9g\n", surface[0])]
    if isinstance(surface, Picture):
        parts += [_rows("vt %.6f %.6f\n", surface.uv), _rows("vn %.6f %.6f %.6f\n", surface.normals)]
        parts.append(_rows("f %d/%d/%d %d/%d/%d %d/%d/%d\n", np.repeat(corner, 3, axis=1)))
    else:
        parts.append(_rows("f %d %d %d\n", corner))
    _save(file, parts)


def write_labels(map_: LabelMap, file: str) -> None:
    """A label map as NIfTI-1 (.nii, .nii.gz), or as NRRD (.nrrd), which keeps the names: 16 bits per voxel, millimetres."""
    lower = file.lower()
    if not lower.endswith((".nii", ".nii.gz", ".nrrd")):
        raise Error(f"{file}: a label map must end with .nii, .nii.gz or .nrrd")
    if max(map_.labels) > 32767 or max(map_.array.shape) > 32767:
        raise Error(f"{file}: labels and sizes must be at most 32767")
    voxels = map_.array.astype("<i2").tobytes(order="F")
    if lower.endswith(".nrrd"):
        data = _nrrd_header(map_).encode() + gzip.compress(voxels, 6, mtime=0)
    else:
        data = _nifti_header(map_) + voxels
        data = gzip.compress(data, 6, mtime=0) if lower.endswith(".gz") else data
    try:
        with open(file, "wb") as stream:
            stream.write(data)
    except OSError as problem:
        raise Error(f"{file}: {problem.strerror or problem}") from None


def _nifti_header(map_: LabelMap) -> bytes:
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, *map_.array.shape, 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 4, 16)
    struct.pack_into("<8f", head, 76, 1, *(1e3 * map_.spacing), 0, 0, 0, 0)
    struct.pack_into("<3f", head, 108, 352, 1, 0)
    struct.pack_into("<b", head, 123, 2)
    struct.pack_into("<h", head, 254, 1)
    struct.pack_into("<12f", head, 280, *(1e3 * map_.affine[:3]).ravel())
    head[344:348] = b"n+1\0"
    return bytes(head)


def _nrrd_header(map_: LabelMap) -> str:
    """With the names as 3D Slicer writes those of segments."""

    def place(numbers: Array) -> str:
        return "(" + ",".join(f"{1e3 * x:.9g}" for x in numbers) + ")"

    names = "".join(f"Segment{i}_LabelValue:={label}\nSegment{i}_Name:={name}\n" for i, (label, name) in enumerate(map_.names.items()))
    directions = " ".join(place(map_.affine[:3, k]) for k in range(3))
    return (
        f"NRRD0004\ntype: int16\ndimension: 3\nspace: right-anterior-superior\nsizes: {' '.join(map(str, map_.array.shape))}\n"
        f"space directions: {directions}\nkinds: domain domain domain\nendian: little\nencoding: gzip\nspace origin: {place(map_.affine[:3, 3])}\n{names}\n"
    )


def write_json(file: str, value: _typing.Any) -> None:
    _save(file, [_json.dumps(value, indent=1), "\n"])


def _warnings(anatomy: Anatomy, name: str, quality: Quality) -> list[str]:
    """What a person should look at before they trust the mesh."""
    out = []
    if quality.hausdorff > _FAR * anatomy.size:
        out.append(f"'{name}' differs from its surface by up to {1e3 * quality.hausdorff:.1f} mm: parts of it are thinner than the elements of "
                   f"{1e3 * anatomy.size:.1f} mm; ask for more tetrahedra")  # fmt: skip
    off = quality.volume / quality.wanted_volume - 1.0
    if abs(off) > 0.01:
        out.append(f"the volume of '{name}' is off by {100 * off:+.1f} %; ask for more tetrahedra")
    if quality.flat:
        at = ", ".join(f"{1e3 * x:.1f}" for x in quality.flat_at)
        out.append(f"'{name}' has {quality.flat} tetrahedra with an angle below {LEAST_ANGLE:g} degrees, the worst {quality.least_angle:.1f} at ({at}) mm")
    return out


def report_of(anatomy: Anatomy) -> dict[str, _typing.Any]:
    """What was measured of each organ, landmarks, and which nodes neighbours share."""
    organs, notes = {}, list(anatomy.notes)
    for name in anatomy.names.values():
        quality = anatomy.quality(name)
        organs[name] = {**quality._asdict(), "landmarks": anatomy.landmarks(name)}
        notes += _warnings(anatomy, name, quality)
    shared = []
    for first, second in anatomy.neighbours():
        nodes, to = anatomy.shared(first, second)
        shared.append({"first": first, "second": second, "nodes": nodes.tolist(), "to_nodes": to.tolist()})
    return {"element_size": anatomy.size, "organs": organs, "attachments": shared, "notes": notes}


def write_anatomy(anatomy: Anatomy, file: str, parts: _typing.Optional[str] = None, detail: int = 2) -> dict[str, _typing.Any]:
    """The mesh as one file; into the folder `parts` the organs' own meshes, surfaces, and report.json. Returns the report."""
    anatomy.mesh()  # the engine's own check
    write_msh(file, anatomy.nodes, anatomy.tetrahedra, anatomy.labels, anatomy.names)
    report = report_of(anatomy)
    if parts is None:
        return report
    try:
        _os.makedirs(parts, exist_ok=True)
    except OSError as problem:
        raise Error(f"{parts}: {problem.strerror or problem}") from None
    for name, stem in file_names(anatomy).items():
        organ = anatomy.organ(name)
        label = anatomy.label(name)
        path = _os.path.join(parts, stem)
        write_msh(path + ".msh", organ.nodes, organ.tetrahedra, np.full(len(organ.tetrahedra), label), {label: name})
        write_obj(path + ".obj", anatomy.picture(name, detail))
        write_obj(path + "_collision.obj", anatomy.collision(name))
    write_json(_os.path.join(parts, "report.json"), report)
    return report


def file_names(anatomy: Anatomy) -> dict[str, str]:
    """Names that files can have, each once."""
    out: dict[str, str] = {}
    for label, name in anatomy.names.items():
        short = plain(name)
        out[name] = short if short not in out.values() else f"{short}_{label}"
    return out
