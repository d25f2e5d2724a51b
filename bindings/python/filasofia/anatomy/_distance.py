"""How far two surfaces are from each other."""

from __future__ import annotations

import numpy as np

from ._needs import need
from ._types import Array


def to_triangles(points: Array, corners: Array) -> Array:
    """Distance of point i from triangle i, (n, 3) and (n, 3, 3). Ericson, Real-time collision detection (2005), 5.1.5."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    unit = normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    height = np.einsum("ij,ij->i", points - a, unit)
    on = points - height[:, None] * unit
    inside = np.ones(len(points), bool)
    edge = np.full(len(points), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(q - p, on - p), unit) >= 0.0
        d = q - p
        s = np.clip(np.einsum("ij,ij->i", points - p, d) / np.maximum(np.einsum("ij,ij->i", d, d), 1e-300), 0.0, 1.0)
        edge = np.minimum(edge, np.linalg.norm(points - p - s[:, None] * d, axis=1))
    return np.where(inside, np.abs(height), edge)


def samples(vertices: Array, triangles: Array, step: float) -> tuple[Array, Array]:
    """Points on triangles, no further than `step` from each other, and the triangle of each."""
    corner = vertices[triangles]
    longest = np.max(np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2), axis=1)
    parts = np.clip(np.ceil(longest / step).astype(int), 1, 64)
    points, owner = [], []
    for n in np.unique(parts):
        i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
        kept = i + j <= n
        weight = np.stack([i[kept], j[kept], n - i[kept] - j[kept]], axis=1) / n
        mine = np.flatnonzero(parts == n)
        points.append(np.einsum("wk,nki->nwi", weight, corner[mine]).reshape(-1, 3))
        owner.append(np.repeat(mine, len(weight)))
    return np.concatenate(points), np.concatenate(owner)


def distances(points: Array, vertices: Array, triangles: Array, step: float) -> Array:
    """Distance of each point from a surface: from the triangles of the 6 samples of it that are the nearest."""
    on, owner = samples(vertices, triangles, step)
    tree = need("scipy.spatial", "scipy", "measuring").cKDTree(on)
    near = tree.query(points, k=min(6, len(on)))[1].reshape(len(points), -1)
    out = np.full(len(points), np.inf)
    for k in range(near.shape[1]):
        out = np.minimum(out, to_triangles(points, vertices[triangles[owner[near[:, k]]]]))
    return out


def between(first: tuple[Array, Array], second: tuple[Array, Array], step: float) -> tuple[float, float]:
    """Largest (Hausdorff) and mean distance of two surfaces, both ways, found at points `step` apart."""
    there = distances(samples(*first, step)[0], *second, step)
    back = distances(samples(*second, step)[0], *first, step)
    return float(max(there.max(), back.max())), float(0.5 * (there.mean() + back.mean()))
