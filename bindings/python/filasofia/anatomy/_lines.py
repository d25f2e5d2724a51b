"""Centre lines of tubes."""

from __future__ import annotations

import numpy as np

from filasofia import Error

from ._labels import LabelMap
from ._needs import need, scipy_ndimage
from ._types import Array

_MOST_VOXELS = 2_000_000


def centre_line(map_: LabelMap, label: int, step: float = 2e-3) -> Array:
    """Places [m] along the middle of a tube, about `step` apart, between its two ends that are the furthest from each other.

    The way of least cost through the label's voxels, where a voxel costs the more the nearer it is to the wall (Bitter et
    al., Penalized-distance volumetric skeleton algorithm, 2001), smoothed."""
    if label not in map_.labels:
        raise Error(f"{map_.source}: has no label {label}; it has {map_.labels}")
    graph = need("scipy.sparse.csgraph", "scipy", "a centre line")
    inside = map_.array == label
    voxels = np.argwhere(inside)
    if len(voxels) > _MOST_VOXELS:
        raise Error(f"{map_.source}: a centre line is found in at most {_MOST_VOXELS} voxels, got {len(voxels)}")
    depth = scipy_ndimage().distance_transform_edt(np.pad(inside, 1), sampling=map_.spacing)[1:-1, 1:-1, 1:-1][tuple(voxels.T)]
    table = _neighbours(map_, voxels, (1.0 - 0.98 * depth / depth.max()) ** 6 + 1e-3)
    plain = _neighbours(map_, voxels, np.ones(len(voxels)))
    start = int(depth.argmax())
    for _ in range(2):  # from the thickest place to the furthest end, from there to the other one
        far = graph.dijkstra(plain, directed=False, indices=start)
        end, start = start, int(np.where(np.isfinite(far), far, -1.0).argmax())
    far, before = graph.dijkstra(plain, directed=False, indices=start), graph.dijkstra(table, directed=False, indices=start, return_predecessors=True)[1]
    at, path = int(np.where(np.isfinite(far), far, -1.0).argmax()), []
    while at >= 0:
        path.append(at)
        at = int(before[at])
    return _even(map_.world(voxels[path].astype(float)), step, float(depth.max()))


def _neighbours(map_: LabelMap, voxels: Array, cost: Array) -> Array:
    """Sparse graph of voxels that touch, also at an edge or a corner."""
    sparse = need("scipy.sparse", "scipy", "a centre line")
    number = np.full(np.array(map_.array.shape) + 2, -1)
    number[tuple((voxels + 1).T)] = np.arange(len(voxels))
    first, second, weight = [], [], []
    for step in np.ndindex(3, 3, 3):
        way = np.array(step) - 1
        if tuple(way) <= (0, 0, 0):
            continue
        other = number[tuple((voxels + 1 + way).T)]
        here = np.flatnonzero(other >= 0)
        first.append(here)
        second.append(other[here])
        weight.append(np.linalg.norm(way * map_.spacing) * 0.5 * (cost[here] + cost[other[here]]))
    return sparse.csr_matrix((np.concatenate(weight), (np.concatenate(first), np.concatenate(second))), shape=(len(voxels),) * 2)


def _even(line: Array, step: float, width: float) -> Array:
    """Smoothed over about the tube's radius, points `step` apart; the ends stay."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    count = max(2, int(round(along[-1] / step)) + 1)
    places = np.linspace(0.0, along[-1], count)
    out = np.stack([np.interp(places, along, line[:, k]) for k in range(3)], axis=1)
    for _ in range(max(1, int((width / step) ** 2))):
        out[1:-1] += 0.5 * (0.5 * (out[:-2] + out[2:]) - out[1:-1])
    return out
