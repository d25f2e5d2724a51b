"""The surface of an organ in the fields that its mesh was fitted to, for measuring and for the picture."""

from __future__ import annotations

import numpy as np

from ._distance import distances, samples
from ._fields import Fields
from ._types import Array


def margin(fields: Fields, row: int, points: Array) -> tuple[Array, Array]:
    """Half of what this field is larger by than all others, about a distance [m], and its gradient."""
    value, slope = fields.sample_gradient(points, np.full(len(points), row))
    best, steepest = np.full(len(points), -np.inf), np.zeros_like(slope)
    for other in range(len(fields.labels)):
        if other == row:
            continue
        there, slope_there = fields.sample_gradient(points, np.full(len(points), other))
        better = there > best
        best, steepest = np.where(better, there, best), np.where(better[:, None], slope_there, steepest)
    return 0.5 * (value - best), 0.5 * (slope - steepest)


def crossings(fields: Fields, row: int) -> Array:
    """Points of the organ's surface on the edges of the grid."""
    others = np.delete(fields.values, row, axis=0).max(axis=0)
    value = fields.values[row].astype(float) - others
    out = []
    for axis in range(3):
        a = np.moveaxis(value, axis, 0)
        i = np.argwhere((a[1:] > 0) != (a[:-1] > 0))
        low, high = a[tuple(i.T)], a[tuple((i + [1, 0, 0]).T)]
        place = i.astype(float)
        place[:, 0] += low / (low - high)
        out.append(np.roll(place, axis, axis=1) if axis == 0 else place[:, [1, 0, 2] if axis == 1 else [1, 2, 0]])
    return fields.origin + fields.step * np.concatenate(out)


def level_distance(fields: Fields, label: int, vertices: Array, triangles: Array) -> tuple[float, float]:
    """Largest (Hausdorff) and mean distance [m] between an organ's mesh and its surface in the image, both ways."""
    row = int(np.flatnonzero(fields.labels == label)[0])
    level = crossings(fields, row)
    there = distances(level, vertices, triangles, 2.0 * fields.step)
    points = samples(vertices, triangles, 2.0 * fields.step)[0]
    value, slope = margin(fields, row, points)
    back = np.minimum(np.abs(value) / np.maximum(np.linalg.norm(slope, axis=1), 0.3), _nearest(level, points) + 0.5 * fields.step)
    return float(max(there.max(), back.max())), float(0.5 * (there.mean() + back.mean()))


def _nearest(level: Array, points: Array) -> Array:
    from ._needs import need

    return need("scipy.spatial", "scipy", "measuring").cKDTree(level).query(points)[0]
