"""Smooth functions of a label map: for each label one that is larger than all others where the label is.

They are signed distances [m] on a grid, smoothed by less than a voxel. Each is shifted so that the part where it is the
largest has the volume of the label's voxels: smoothing alone makes what is round smaller."""

from __future__ import annotations

import dataclasses as _dataclasses

import numpy as np

from ._labels import LabelMap, box
from ._needs import scipy_ndimage
from ._types import Array

_MOST_VALUES = 60_000_000  # numbers in all fields together: 240 MB


@_dataclasses.dataclass
class Fields:
    """`values[i]` belongs to `labels[i]`; labels[0] is 0, the background."""

    origin: Array
    step: float
    values: Array
    labels: Array

    def sample(self, points: Array, rows: Array) -> Array:
        """Linear in each cell; `rows` says which field each point is read from."""
        return self._corners(points, rows, gradients=False)[0]

    def sample_gradient(self, points: Array, rows: Array) -> tuple[Array, Array]:
        """Values, and gradients (n, 3)."""
        return self._corners(points, rows, gradients=True)

    def _corners(self, points: Array, rows: Array, gradients: bool) -> tuple[Array, Array]:
        shape = np.array(self.values.shape[1:])
        place = np.clip((points - self.origin) / self.step, 0.0, shape - 1.000001)
        low = np.minimum(place.astype(np.int64), shape - 2)
        s = place - low
        at = ((rows * shape[0] + low[:, 0]) * shape[1] + low[:, 1]) * shape[2] + low[:, 2]
        flat = self.values.reshape(-1)
        x, y, z = s[:, 0], s[:, 1], s[:, 2]
        along_y, along_x = shape[2], shape[1] * shape[2]
        v = [flat[at + i * along_x + j * along_y + k].astype(float) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
        a = [v[2 * n] + z * (v[2 * n + 1] - v[2 * n]) for n in range(4)]
        b = [a[0] + y * (a[1] - a[0]), a[2] + y * (a[3] - a[2])]
        value = b[0] + x * (b[1] - b[0])
        if not gradients:
            return value, value
        dz = [v[2 * n + 1] - v[2 * n] for n in range(4)]
        dz_y = [dz[0] + y * (dz[1] - dz[0]), dz[2] + y * (dz[3] - dz[2])]
        dy = [a[1] - a[0], a[3] - a[2]]
        slope = np.stack([b[1] - b[0], dy[0] + x * (dy[1] - dy[0]), dz_y[0] + x * (dz_y[1] - dz_y[0])], axis=1)
        return value, slope / self.step

    def leader(self, points: Array) -> tuple[Array, Array]:
        """Row of the largest field at each point, and by how much it is larger than the next one."""
        first = self.sample(points, np.zeros(len(points), int))
        second, out = np.full(len(points), -np.inf), np.zeros(len(points), int)
        for row in range(1, len(self.labels)):
            value = self.sample(points, np.full(len(points), row))
            better = value > first
            second = np.where(better, first, np.maximum(second, value))
            first, out = np.where(better, value, first), np.where(better, row, out)
        return out, first - second


def _signed_distance(inside: Array, spacing: Array, sigma: float) -> Array:
    ndimage = scipy_ndimage()
    inner = ndimage.distance_transform_edt(inside, sampling=spacing)
    outer = ndimage.distance_transform_edt(~inside, sampling=spacing)
    return ndimage.gaussian_filter((inner - outer).astype(np.float32), sigma, mode="nearest")


def _grid(map_: LabelMap, low: Array, high: Array, wanted: float, rows: int) -> tuple[Array, float, tuple[int, ...]]:
    """A cubic grid of the world around the voxels from `low` to `high`, as fine as `wanted` if memory allows it."""
    corners = np.array([[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    world = map_.world(corners)
    room = world.max(0) - world.min(0)
    step = max(wanted, float((np.prod(room) * rows / _MOST_VALUES) ** (1 / 3)))
    pad = 2.0 * step + float(map_.spacing.max())
    shape = tuple(int(n) for n in np.ceil((room + 2.0 * pad) / step) + 1)
    return world.min(0) - pad, step, shape


def make_fields(map_: LabelMap, step: float, smoothing: float = 0.8) -> Fields:
    """Fields of all labels of a map on a grid of about `step` [m]; `smoothing` in voxels."""
    ndimage = scipy_ndimage()
    labels = np.array([0, *map_.labels])
    first, last = box(map_.array != 0)
    origin, step, shape = _grid(map_, first - 0.5, last + 0.5, step, len(labels))
    axes = [origin[k] + step * np.arange(shape[k]) for k in range(3)]
    index = map_.index(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)).T
    # A grid coarser than the voxels must not see what is finer than itself.
    sigma = np.maximum(smoothing, 0.5 * step / map_.spacing)
    pad = np.ceil(3.0 * step / map_.spacing).astype(int) + 3
    far = -float((pad * map_.spacing).min())
    values = np.full((len(labels), *shape), far, np.float32)
    for row, label in enumerate(labels):
        where = map_.array != 0 if label == 0 else map_.array == label
        low, high = box(where)
        cut = tuple(slice(a, b + 1) for a, b in zip(low, high))
        inside = np.pad(where[cut], [(p, p) for p in pad])
        distance = _signed_distance(inside, map_.spacing, sigma)
        local = index - (low - pad)[:, None]
        values[row] = ndimage.map_coordinates(distance, local, order=1, mode="nearest").reshape(shape)
    values[0] *= -1.0
    fields = Fields(origin, step, values, labels)
    _balance(fields, np.array([map_.volume(label) for label in map_.labels]))
    return fields


def filled(fields: Fields) -> tuple[Array, Array]:
    """Volume [m^3] where each label's field is the largest, without the background, and its growth [m^2] as the field grows."""
    order = np.partition(fields.values, -2, axis=0)
    first, second = order[-1], order[-2]
    volume, growth = [], []
    for value in fields.values[1:]:
        margin = np.where(value == first, first - second, value - first)
        slope = np.maximum(np.sqrt(sum(g.astype(float) ** 2 for g in np.gradient(margin))), 1e-9)
        share = 0.5 + margin / slope
        volume.append(np.clip(share, 0.0, 1.0).sum() * fields.step**3)
        growth.append((1.0 / slope[(share > 0.0) & (share < 1.0)]).sum() * fields.step**3)
    return np.array(volume), np.array(growth)


def _balance(fields: Fields, wanted: Array) -> None:
    """Shifts fields until every label fills the volume of its voxels."""
    for _ in range(6):
        now, growth = filled(fields)
        if np.all(np.abs(now - wanted) < 1e-3 * wanted):
            return
        shift = np.clip((wanted - now) / np.maximum(growth, 1e-12), -fields.step, fields.step)
        fields.values[1:] += shift[:, None, None, None].astype(np.float32)
