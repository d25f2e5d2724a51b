"""The surface that is drawn: the boundary of the mesh, divided, on the surface of the fields, with normals and uv."""

from __future__ import annotations

import typing as _typing

import numpy as np

from ._fields import Fields
from ._level import margin
from ._shapes import normals
from ._types import Array


class Picture(_typing.NamedTuple):
    vertices: Array
    triangles: Array
    normals: Array
    uv: Array


def divided(vertices: Array, triangles: Array) -> tuple[Array, Array]:
    """Each triangle becomes four."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
    unique, number = np.unique(edges, axis=0, return_inverse=True)
    middle = len(vertices) + number.reshape(-1, 3)
    a, b, c = triangles.T
    x, y, z = middle.T
    four = np.stack([np.stack(t, axis=1) for t in ((a, x, z), (x, b, y), (z, y, c), (x, y, z))], axis=1)
    return np.concatenate([vertices, vertices[unique].mean(axis=1)]), four.reshape(-1, 3)


def smoothed(vertices: Array, triangles: Array, share: float) -> Array:
    """Each vertex moved towards the mean of its neighbours."""
    edges = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2), axis=0)
    both = np.concatenate([edges, edges[:, ::-1]])
    count = np.maximum(np.bincount(both[:, 0], minlength=len(vertices)), 1)
    mean = np.stack([np.bincount(both[:, 0], vertices[both[:, 1], k], len(vertices)) for k in range(3)], axis=1) / count[:, None]
    return vertices + share * (mean - vertices)


def on_level(fields: Fields, row: int, vertices: Array, longest: float) -> Array:
    """Vertices moved onto the organ's surface, none further than `longest` [m]."""
    start = vertices
    for _ in range(4):
        value, slope = margin(fields, row, vertices)
        step = -(value / np.maximum(np.einsum("ij,ij->i", slope, slope), 0.09))[:, None] * slope
        moved = vertices + 0.8 * step - start
        far = np.linalg.norm(moved, axis=1)
        vertices = start + moved * np.minimum(1.0, longest / np.maximum(far, 1e-300))[:, None]
    return vertices


def octahedral(directions: Array) -> Array:
    """Directions as points of the unit square, without a seam: the sphere is unfolded from an octahedron."""
    d = directions / np.maximum(np.abs(directions).sum(axis=1), 1e-300)[:, None]
    x, y = d[:, 0], d[:, 1]
    fold = d[:, 2] < 0.0
    u = np.where(fold, (1.0 - np.abs(y)) * np.where(x < 0, -1.0, 1.0), x)
    v = np.where(fold, (1.0 - np.abs(x)) * np.where(y < 0, -1.0, 1.0), y)
    return 0.5 + 0.5 * np.stack([u, v], axis=1)


def picture_of(fields: _typing.Optional[Fields], label: int, vertices: Array, triangles: Array, detail: int, size: float) -> Picture:
    row = 0 if fields is None else int(np.flatnonzero(fields.labels == label)[0])
    for level in range(detail):
        vertices, triangles = divided(vertices, triangles)
        if fields is not None:
            vertices = smoothed(vertices, triangles, 0.5)
            vertices = on_level(fields, row, vertices, 0.3 * size)
    unit = normals(vertices, triangles)
    return Picture(vertices, triangles, unit, octahedral(vertices - vertices.mean(axis=0)))
