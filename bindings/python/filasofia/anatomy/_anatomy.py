"""The result: organs that are parts of one mesh, with their surfaces and what they share."""

from __future__ import annotations

import typing as _typing

import numpy as np

import filasofia as _fs

from . import _shapes
from ._distance import between
from ._fields import Fields, make_fields
from ._level import level_distance
from ._labels import LabelMap, box
from ._mesh import GROWTH, LEAST_ANGLE, mesh_fields, refuse_too_small, size_for
from ._needs import scipy_ndimage
from ._picture import Picture, picture_of
from ._types import Array, Tell, silent

_FEWEST, _MOST = 20, 5_000_000
_NEEDED = 0.8  # size of elements relative to what they shall fill: at 1.0 a tube inside another organ lost a fifth of its volume


class Organ(_typing.NamedTuple):
    """An organ's own mesh; node i of it is `numbers[i]` of the whole."""

    nodes: Array
    tetrahedra: Array
    numbers: Array


class Quality(_typing.NamedTuple):
    """What was measured of one organ. Volumes [m^3], distances [m], angles [degrees]."""

    tetrahedra: int
    volume: float
    wanted_volume: float
    hausdorff: float
    mean_distance: float
    least_angle: float
    largest_angle: float
    flat: int
    flat_at: tuple[float, ...]


class Anatomy:
    """Organs that share the nodes where they touch. `nodes` [m], `tetrahedra`, the label of each, `names` of labels."""

    def __init__(self, nodes: Array, tetrahedra: Array, labels: Array, names: dict[int, str], fields: _typing.Optional[Fields], size: float):
        self.nodes, self.tetrahedra, self.labels, self.names = nodes, tetrahedra, labels, names
        self.fields, self.size = fields, size
        self.wanted: dict[int, float] = {}
        self.surfaces: dict[int, tuple[Array, Array]] = {}  # what it was made of, if that was closed surfaces
        self.notes: list[str] = []

    def label(self, name: str) -> int:
        for label, each in self.names.items():
            if each == name:
                return label
        raise _fs.Error(f"no organ has the name '{name}'; there are {', '.join(self.names.values())}")

    def mesh(self, name: _typing.Optional[str] = None) -> _fs.TetMesh:
        """The whole, or one organ, checked by the engine. Labels and their names are regions for materials."""
        if name is None:
            return _fs.TetMesh(self.nodes, self.tetrahedra, self.labels, {each: label for label, each in self.names.items()})
        organ = self.organ(name)
        label = self.label(name)
        return _fs.TetMesh(organ.nodes, organ.tetrahedra, np.full(len(organ.tetrahedra), label), {name: label})

    def organ(self, name: str) -> Organ:
        mine = self.tetrahedra[self.labels == self.label(name)]
        nodes, tetrahedra, numbers = _shapes.compact(self.nodes, mine)
        return Organ(nodes, tetrahedra, numbers)

    def collision(self, name: str) -> tuple[Array, Array]:
        """Vertices and triangles of the organ's boundary: what is in contact is what moves."""
        organ = self.organ(name)
        vertices, triangles, _ = _shapes.compact(organ.nodes, _shapes.boundary(organ.tetrahedra))
        return vertices, triangles

    def picture(self, name: str, detail: int = 2) -> Picture:
        """A finer surface, with 4^detail times the triangles, smooth normals and uv."""
        return picture_of(self.fields, self.label(name), *self.collision(name), detail, self.size)

    def shared(self, first: str, second: str) -> tuple[Array, Array]:
        """Nodes that two organs share, by their numbers in the first and in the second one: an attachment list."""
        _, i, j = np.intersect1d(self.organ(first).numbers, self.organ(second).numbers, return_indices=True)
        return i, j

    def neighbours(self) -> list[tuple[str, str]]:
        """Pairs of organs that share a face."""
        beyond = _shapes.neighbours(self.tetrahedra)
        i, face = np.nonzero(beyond >= 0)
        a, b = self.labels[i], self.labels[beyond[i, face]]
        pairs = np.unique(np.stack([a, b], axis=1)[a < b], axis=0)
        return [(self.names[int(x)], self.names[int(y)]) for x, y in pairs]

    def landmarks(self, name: str) -> dict[str, list[float]]:
        """Places [m]: the middle of the volume, and the outermost nodes along each axis of the patient."""
        organ = self.organ(name)
        volume = _shapes.volumes(organ.nodes, organ.tetrahedra)
        middle = (organ.nodes[organ.tetrahedra].mean(axis=1) * volume[:, None]).sum(axis=0) / volume.sum()
        out = {"middle": middle.tolist()}
        for axis, (low, high) in enumerate((("left", "right"), ("back", "front"), ("foot", "head"))):
            out[low] = organ.nodes[organ.nodes[:, axis].argmin()].tolist()
            out[high] = organ.nodes[organ.nodes[:, axis].argmax()].tolist()
        return out

    def quality(self, name: str) -> Quality:
        """Volume, angles and the distance from the image's surface; 0 if the mesh did not come from an image."""
        organ = self.organ(name)
        volume = _shapes.volumes(organ.nodes, organ.tetrahedra)
        angles = _shapes.dihedral_angles(organ.nodes, organ.tetrahedra)
        hausdorff, mean = self._distance(name)
        flat = angles.min(axis=1) < LEAST_ANGLE
        worst = organ.nodes[organ.tetrahedra[angles.min(axis=1).argmin()]].mean(axis=0)
        return Quality(
            len(volume), float(volume.sum()), self.wanted.get(self.label(name), float(volume.sum())), hausdorff, mean,
            float(angles.min()), float(angles.max()), int(flat.sum()), tuple(float(x) for x in worst),
        )  # fmt: skip


    def _distance(self, name: str) -> tuple[float, float]:
        label = self.label(name)
        if label in self.surfaces:
            return between(self.collision(name), self.surfaces[label], 0.25 * self.size)
        return level_distance(self.fields, label, *self.collision(name)) if self.fields is not None else (0.0, 0.0)


def checked_number(what: str, value: _typing.Any, low: float, high: float) -> float:
    """The number, or an Error with its bounds."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise _fs.Error(f"{what} must be a number, got {value!r}") from None
    if not low <= number <= high:
        raise _fs.Error(f"{what} must be in [{low:g}, {high:g}], got {number:g}")
    return number


def thickness(map_: LabelMap) -> dict[int, float]:
    """Of each organ at its thickest place [m]: the diameter of the largest ball in it."""
    ndimage = scipy_ndimage()
    out = {}
    for label in map_.labels:
        cut = tuple(slice(a, b + 1) for a, b in zip(*box(map_.array == label)))
        inside = np.pad(map_.array[cut] == label, 1)
        out[label] = 2.0 * float(ndimage.distance_transform_edt(inside, sampling=map_.spacing).max())
    return out


def fitting_size(map_: LabelMap, least: int = 10_000, most: int = 60_000) -> float:
    """Size of elements [m] for `least` tetrahedra, or as small as the thinnest organ needs, for at most about `most` tetrahedra."""
    volume = sum(map_.volume(label) for label in map_.labels)
    thin = _NEEDED * min(thickness(map_).values())
    return max(min(size_for(volume, least), thin), size_for(volume, most))


def mesh_labels(
    map_: LabelMap,
    tetrahedra: _typing.Optional[int] = None,
    *,
    size: _typing.Optional[float] = None,
    smoothing: float = 0.8,
    tell: Tell = silent,
) -> Anatomy:
    """Meshes all organs of a label map together: about so many `tetrahedra`, or elements of `size` [m]. If nothing is
    said, 10,000 tetrahedra, or as many as the thinnest organ needs. `smoothing` is in voxels."""
    if tetrahedra is not None and size is not None:
        raise _fs.Error("mesh: tetrahedra and size exclude each other")
    checked_number("mesh: smoothing", smoothing, 0.0, 10.0)
    wanted = np.array([map_.volume(label) for label in map_.labels])
    number = None
    if size is not None:
        checked_number("mesh: size", size, 1e-6, 1.0)
    elif tetrahedra is not None:
        number = int(checked_number("mesh: tetrahedra", tetrahedra, _FEWEST, _MOST))
        size = size_for(float(wanted.sum()), number)
    else:
        size = fitting_size(map_)
        number = int(round(12.0 * wanted.sum() * GROWTH / size**3))
    low, high = box(map_.array != 0)
    refuse_too_small(size, float(np.prod((high - low + 1) * map_.spacing)))
    fields = make_fields(map_, size / 4.0, smoothing)
    tell(f"{len(map_.labels)} labels on a grid of {fields.step * 1e3:.2f} mm")
    made = mesh_fields(fields, wanted, size, number, tell)
    out = Anatomy(made.nodes, made.tetrahedra, fields.labels[made.rows], dict(map_.names), fields, made.size)
    out.wanted = dict(zip(map_.labels, wanted.tolist()))
    return out
