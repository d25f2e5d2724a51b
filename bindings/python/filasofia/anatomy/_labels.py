"""A label map: which organ each voxel belongs to, and where the voxels are."""

from __future__ import annotations

import typing as _typing

import numpy as np

from filasofia import Error

from ._types import Array

MOST_LABELS = 256


class LabelMap:
    """Whole numbers (i, j, k), 0 for none, and where they are.

    `affine` is 4 by 4 and maps voxel numbers to places [m]: x to the right hand of the patient, y to the front, z to the
    head. So gravity along -y is that of a patient who lies on the back. `spacing` [m] instead of `affine` puts the first
    voxel at the origin. `names` are the organs' names by label.
    """

    @np.errstate(all="ignore")  # what is not finite is refused
    def __init__(
        self,
        array: _typing.Any,
        affine: _typing.Any = None,
        *,
        spacing: _typing.Any = None,
        names: _typing.Optional[_typing.Mapping[int, str]] = None,
        source: str = "label map",
    ) -> None:
        array = np.asarray(array)
        if array.ndim != 3:
            raise Error(f"{source}: a label map must have 3 dimensions, got {array.ndim}")
        if array.dtype.kind == "f":
            if not np.isfinite(array).all() or (array != np.round(array)).any():
                raise Error(f"{source}: labels must be whole numbers; this looks like an image, not a segmentation")
            if np.abs(array).max(initial=0) >= 2**31:
                raise Error(f"{source}: labels must be below 2^31, got {np.abs(array).max():g}")
            array = array.astype(np.int64)
        if array.dtype.kind not in "iub":
            raise Error(f"{source}: labels must be whole numbers, got an array of {array.dtype}")
        if affine is None:
            affine = np.diag([*np.broadcast_to(np.asarray(1e-3 if spacing is None else spacing, float), 3), 1.0])
        affine = np.asarray(affine, float)
        if affine.shape != (4, 4) or not np.isfinite(affine).all():
            raise Error(f"{source}: affine must be 4 by 4 finite numbers")
        self.array = array
        self.affine = affine
        self.source = source
        self.spacing = np.linalg.norm(affine[:3, :3], axis=0)
        if not ((self.spacing > 1e-7) & (self.spacing < 1.0)).all():
            raise Error(f"{source}: the size of a voxel must be in (1e-7, 1) m, got {self.spacing.tolist()}")
        unit = affine[:3, :3] / self.spacing
        if np.abs(unit.T @ unit - np.eye(3)).max() > 1e-3:
            raise Error(f"{source}: the axes of the voxels must be at right angles; resample the image first")
        present = np.unique(array)
        if len(present) > MOST_LABELS + 1:
            raise Error(f"{source}: a map may have {MOST_LABELS} labels, got {len(present)}; this looks like an image, not a segmentation")
        if present.size and present[0] < 0:
            raise Error(f"{source}: labels must be >= 0, got {present[0]}")
        self.labels = [int(label) for label in present if label != 0]
        if not self.labels:
            raise Error(f"{source}: every voxel is 0: nothing is segmented")
        given = dict(names or {})
        self.names = {label: given.get(label, f"label_{label}") for label in self.labels}
        twice = sorted({name for name in self.names.values() if list(self.names.values()).count(name) > 1})
        if twice:
            raise Error(f"{source}: two labels have the name '{twice[0]}'")

    def world(self, index: Array) -> Array:
        """Places [m] of voxel numbers."""
        return index @ self.affine[:3, :3].T + self.affine[:3, 3]

    def index(self, places: Array) -> Array:
        """Voxel numbers, with fractions, of places."""
        return (places - self.affine[:3, 3]) @ np.linalg.inv(self.affine[:3, :3]).T

    def volume(self, label: int) -> float:
        """Of the label's voxels [m^3]."""
        return float((self.array == label).sum() * np.prod(self.spacing))

    def only(self, labels: _typing.Iterable[int]) -> "LabelMap":
        """The same map with these labels alone."""
        kept = set(labels)
        absent = sorted(kept - set(self.labels))
        if absent:
            raise Error(f"{self.source}: has no label {absent[0]}; it has {self.labels}")
        return LabelMap(np.where(np.isin(self.array, sorted(kept)), self.array, 0), self.affine, names=self.names, source=self.source)


def box(inside: Array) -> tuple[Array, Array]:
    """First and last index of what is true along each axis. By projections: an image has hundreds of millions of voxels."""
    ends = [np.flatnonzero(inside.any(axis=tuple(k for k in range(3) if k != axis)))[[0, -1]] for axis in range(3)]
    return np.array([end[0] for end in ends]), np.array([end[1] for end in ends])
