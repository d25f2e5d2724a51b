"""A picture of what went in beside what came out."""

from __future__ import annotations

import typing as _typing

import numpy as np

import filasofia as _fs

from ._anatomy import Anatomy
from ._labels import LabelMap
from ._names import kind_of
from ._scene import colour_of
from ._types import Array

_WIDTH, _HEIGHT = 640, 600


def voxel_surface(map_: LabelMap, label: int) -> tuple[Array, Array]:
    """Faces of the label's voxels."""
    inside = np.pad(map_.array == label, 1)
    vertices: list[Array] = []
    triangles: list[Array] = []
    for axis in range(3):
        for sign in (1, -1):
            rim = np.argwhere(inside & ~np.roll(inside, -sign, axis)) - 1
            u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
            middle = rim + 0.5 * sign * np.eye(3)[axis]
            ring = [middle - 0.5 * u - 0.5 * v, middle + 0.5 * u - 0.5 * v, middle + 0.5 * u + 0.5 * v, middle - 0.5 * u + 0.5 * v]
            at = len(rim) * np.arange(4)[None, :] + np.arange(len(rim))[:, None] + sum([len(part) for part in vertices])
            order = at if sign > 0 else at[:, ::-1]
            vertices.append(np.concatenate(ring))
            triangles += [order[:, [0, 1, 2]], order[:, [0, 2, 3]]]
    places, order = map_.world(np.concatenate(vertices)), np.concatenate(triangles)
    return places, order if np.linalg.det(map_.affine[:3, :3]) > 0 else order[:, ::-1]


def _render(surfaces: _typing.Mapping[str, tuple[Array, Array]], low: Array, high: Array) -> _typing.Any:
    with _fs.Simulation(rate=100, threads=1, look=_fs.LookDef(around=_fs.Box(low, high), direction=(0.35, 1.0, -0.75))) as sim:
        for name, (vertices, triangles) in surfaces.items():
            material = _fs.BoneMaterial() if kind_of(name).bone else _fs.TissueMaterial(base_color=colour_of(name))
            body = sim.add(_fs.RigidBodyDef(name=name, elements=[(0, 0, 0)], mesh=_fs.TriangleMesh(vertices, triangles)))
            sim.show(body, material=material)
        return sim.render(_WIDTH, _HEIGHT)


def draw(anatomy: Anatomy, map_: _typing.Optional[LabelMap], file: str) -> None:
    """What went in, the tetrahedra's boundary, and the picture surface, beside each other. Needs OpenGL."""
    from filasofia import _pictures

    if not file.lower().endswith(".png"):
        raise _fs.Error(f"{file}: a picture must end with .png")
    low, high = anatomy.nodes.min(axis=0), anatomy.nodes.max(axis=0)
    rows = []
    if map_ is not None:
        rows.append({name: voxel_surface(map_, label) for label, name in map_.names.items()})
    elif anatomy.surfaces:
        rows.append({anatomy.names[label]: surface for label, surface in anatomy.surfaces.items()})
    rows.append({name: _faceted(*anatomy.collision(name)) for name in anatomy.names.values()})
    rows.append({name: anatomy.picture(name)[:2] for name in anatomy.names.values()})
    parts = [_render(surfaces, low, high) for surfaces in rows]
    try:
        np.concatenate(parts, axis=1).view(_pictures.Picture).save(file)
    except OSError as problem:
        raise _fs.Error(f"{file}: {problem.strerror or problem}") from None


def _faceted(vertices: Array, triangles: Array) -> tuple[Array, Array]:
    """Every triangle for itself, so that the elements can be seen."""
    return vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


__all__ = ["draw", "voxel_surface"]
