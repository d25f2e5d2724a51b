"""What a tetrahedral mesh measures: volumes, angles, faces and neighbours. Arrays in, arrays out."""

from __future__ import annotations

import typing as _typing

import numpy as np

from ._types import Array

FACES = np.array([(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)])  # outwards, face i opposite node i
EDGES = np.array([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])
_BESIDE = np.array([(2, 3), (1, 3), (1, 2), (0, 3), (0, 2), (0, 1)])  # the two faces that meet at an edge


def volumes(nodes: Array, tetrahedra: Array) -> Array:
    """Per tetrahedron, negative if inverted."""
    a, b, c, d = (nodes[tetrahedra[:, k]] for k in range(4))
    return np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6.0


def dihedral_angles(nodes: Array, tetrahedra: Array) -> Array:
    """Six angles [degrees] per tetrahedron, in the order of EDGES."""
    unit = []
    for face in FACES:
        a, b, c = (nodes[tetrahedra[:, k]] for k in face)
        normal = np.cross(b - a, c - a)
        unit.append(normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None])
    cosines = [-np.einsum("ij,ij->i", unit[i], unit[j]) for i, j in _BESIDE]
    return np.degrees(np.arccos(np.clip(np.stack(cosines, axis=1), -1.0, 1.0)))


def faces_of(tetrahedra: Array) -> Array:
    """The four faces of each, (4 n, 3), outwards."""
    return tetrahedra[:, FACES].reshape(-1, 3)


def _keys(faces: Array) -> Array:
    """One whole number per face, the same for any order of its nodes."""
    nodes = np.sort(faces.astype(np.int64), axis=1)
    count = int(nodes.max()) + 1 if len(nodes) else 1
    if count < 2_000_000:
        return (nodes[:, 0] * count + nodes[:, 1]) * count + nodes[:, 2]
    return np.unique(nodes, axis=0, return_inverse=True)[1].ravel()


def neighbours(tetrahedra: Array) -> Array:
    """(n, 4): the tetrahedron beyond face i, -1 at the rim."""
    keys = _keys(faces_of(tetrahedra))
    order = np.argsort(keys, kind="stable")
    same = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    first, second = order[same], order[same + 1]
    out = np.full(4 * len(tetrahedra), -1)
    out[first], out[second] = second // 4, first // 4
    return out.reshape(-1, 4)


def boundary(tetrahedra: Array) -> Array:
    """Faces of one tetrahedron only, outwards, in the order of the tetrahedra."""
    return faces_of(tetrahedra)[neighbours(tetrahedra).ravel() < 0]


def compact(nodes: Array, elements: Array) -> _typing.Tuple[Array, Array, Array]:
    """Without the nodes that no element uses: nodes, elements, and the old number of each node."""
    used = np.unique(elements)
    return nodes[used], np.searchsorted(used, elements), used


def enclosed(vertices: Array, triangles: Array) -> float:
    """Volume inside a closed surface that is oriented outwards."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def normals(vertices: Array, triangles: Array) -> Array:
    """Unit normals of vertices, weighted by area."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    face, out = np.cross(b - a, c - a), np.zeros_like(vertices)
    for k in range(3):
        np.add.at(out, triangles[:, k], face)
    return out / np.maximum(np.linalg.norm(out, axis=1), 1e-300)[:, None]
