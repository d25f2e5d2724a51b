"""Meshes that several tasks are made of. Lengths in metres, y is up."""

from __future__ import annotations

import typing

import numpy as np

import filasofia as fs

from .tool import Array


def joined(*meshes: fs.TriangleMesh) -> fs.TriangleMesh:
    """One mesh of several."""
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    vertices = np.concatenate([np.asarray(mesh.vertices) for mesh in meshes])
    triangles = np.concatenate([np.asarray(mesh.triangles) + k for mesh, k in zip(meshes, first)])
    return fs.TriangleMesh(vertices=vertices, triangles=triangles)


def moved(mesh: fs.TriangleMesh, away: typing.Any) -> fs.TriangleMesh:
    """A mesh somewhere else."""
    return fs.TriangleMesh(vertices=np.asarray(mesh.vertices) + away, triangles=mesh.triangles)


def pieces(triangles: Array, count: int) -> Array:
    """For each of so many nodes the lowest one of its piece of a surface."""
    piece = np.arange(count)
    while True:
        low = piece[triangles].min(axis=1)
        new = piece.copy()
        for k in range(3):
            np.minimum.at(new, triangles[:, k], low)
        new = new[new]
        if np.array_equal(new, piece):
            return piece
        piece = new


def covered(triangles: Array, points: Array) -> Array:
    """Which points (k, 2) lie in one of the triangles (m, 3, 2) of a plane: (k,); those without area cover none."""
    a = triangles[:, 0]
    (px, py), (qx, qy) = (triangles[:, 1] - a).T, (triangles[:, 2] - a).T
    whole = px * qy - py * qx
    wide = np.abs(whole) > 1e-9 * np.max(np.abs([px, py, qx, qy]), axis=0, initial=0.0) ** 2
    rx, ry = (points[:, None] - a[wide]).transpose(2, 0, 1)
    v = (rx * qy[wide] - ry * qx[wide]) / whole[wide]
    w = (px[wide] * ry - py[wide] * rx) / whole[wide]
    return np.any((v >= -1e-9) & (w >= -1e-9) & (v + w <= 1 + 1e-9), axis=1)


def revolved(profile: typing.Any, sides: int) -> fs.TriangleMesh:
    """The surface that a closed polygon (radius, height), counter-clockwise, makes as it turns about y."""
    corners = np.asarray(profile, dtype=float)
    angles = 2 * np.pi * np.arange(sides) / sides
    r, y = corners[:, 0], corners[:, 1]
    rings = np.stack([np.outer(np.cos(angles), r), np.tile(y, (sides, 1)), np.outer(np.sin(angles), r)], axis=2)
    i, j = np.meshgrid(np.arange(sides), np.arange(len(corners)), indexing="ij")
    here, up = i * len(corners) + j, i * len(corners) + (j + 1) % len(corners)
    on, diagonal = (up + len(corners)) % rings[..., 0].size, (here + len(corners)) % rings[..., 0].size
    triangles = np.concatenate(
        [np.stack(each, axis=2).reshape(-1, 3) for each in ((here, up, on), (here, on, diagonal))]
    )
    return fs.TriangleMesh(vertices=rings.reshape(-1, 3), triangles=triangles)


def pipe(inner: float, outer: float, height: float, sides: int = 24) -> fs.TriangleMesh:
    """A hollow cylinder from y = 0 up."""
    return revolved([(inner, 0), (outer, 0), (outer, height), (inner, height)], sides)


def eyelet(radius: float, wire: float) -> fs.TriangleMesh:
    """A ring of wire whose axis is x."""
    angles = 2 * np.pi * np.arange(10) / 10
    ring = revolved(np.stack([radius + wire * np.cos(angles), wire * np.sin(angles)], axis=1), 28)
    return fs.TriangleMesh(vertices=np.asarray(ring.vertices)[:, [1, 2, 0]], triangles=ring.triangles)


def soft_pipe(inner: float, outer: float, height: float, cells: tuple[int, int, int]) -> fs.TetMesh:
    """Tetrahedra of a hollow cylinder from y = 0 up; cells around it, along it and through its wall."""
    grid = fs.shapes.block((2 * np.pi, height, outer - inner), cells)
    angle, y, across = np.asarray(grid.nodes).T
    r = across + (inner + outer) / 2
    return _sewn(np.stack([r * np.cos(angle), y + height / 2, r * np.sin(angle)], axis=1), np.asarray(grid.tetrahedra))


def soft_cylinder(radius: float, height: float, cells: tuple[int, int, int]) -> fs.TetMesh:
    """Tetrahedra of a cylinder from y = 0 up; cells along x, y and z."""
    grid = fs.shapes.block((2 * radius, height, 2 * radius), cells)
    x, y, z = np.asarray(grid.nodes).T
    # Squares become circles; half of the way there the mesh is smoother.
    away, flat = np.hypot(x, z), np.maximum(np.abs(x), np.abs(z))
    factor = np.where(away > 0, flat / np.where(away > 0, away, 1.0), 1.0)
    return _sewn(np.stack([x * factor, y + height / 2, z * factor], axis=1), np.asarray(grid.tetrahedra))


def _sewn(nodes: Array, tetrahedra: Array) -> fs.TetMesh:
    """Nodes at the same place become one, and all tetrahedra have positive volume."""
    _, first, same = np.unique(np.round(nodes, 9), axis=0, return_index=True, return_inverse=True)
    nodes, tetrahedra = nodes[first], same.reshape(-1)[tetrahedra]
    a, b, c, d = (nodes[tetrahedra[:, k]] for k in range(4))
    wrong = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0
    tetrahedra[wrong] = tetrahedra[wrong][:, [0, 2, 1, 3]]
    return fs.TetMesh(nodes=nodes, tetrahedra=tetrahedra)
