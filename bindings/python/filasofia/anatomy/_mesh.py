"""From fields to a mesh: the lattice, its labels, the fit, and what is done where elements are too flat."""

from __future__ import annotations

import typing as _typing

import numpy as np

from filasofia import Error

from . import _fit, _lattice, _shapes
from ._fields import Fields
from ._types import Array, Tell

LEAST_ANGLE = 10.0  # degrees, of dihedral angles: what is promised or told
_WANTED_ANGLE = 12.0
_MOST_TETRAHEDRA = 5_000_000
_PULLS = ((5.0, 40), (50.0, 50), (300.0, 60), (2000.0, 120))  # weight of the surfaces, steps
# Tetrahedra after the fit per tetrahedron of the lattice inside: those at the rim are divided. Measured: 1.1 to 1.3.
GROWTH = 1.2
_FARTHEST = 0.12  # of the elements' size: how far surfaces may be moved to correct volumes


def size_for(volume: float, tetrahedra: float) -> float:
    """Edge [m] of the lattice's cubes with which a volume has so many tetrahedra."""
    return float((12.0 * volume * GROWTH / tetrahedra) ** (1.0 / 3.0))


class Meshed(_typing.NamedTuple):
    nodes: Array
    tetrahedra: Array
    rows: Array  # of the fields, >= 1
    size: float


def mesh_fields(fields: Fields, wanted: Array, size: float, number: _typing.Optional[int], tell: Tell) -> Meshed:
    """Tetrahedra of all fields but the background. `wanted` [m^3] are the organs' volumes; `number` corrects the size."""
    for turn in range(6):
        nodes, tetrahedra, rows = _start(fields, size)
        tell(f"lattice of {size * 1e3:.2f} mm: {len(tetrahedra)} tetrahedra")
        if number is None or abs(len(tetrahedra) - number) < 0.05 * number or turn == 5:
            break
        # By a little less each time: the number jumps as layers of the lattice come and go.
        size *= float(np.clip(len(tetrahedra) / number, 0.2, 5.0) ** (1.0 / (3.0 + turn)))
    _refuse_lost(fields, rows, wanted, size)
    for pull, steps in _PULLS:
        faces = _fit.interface_of(tetrahedra, rows)
        nodes = _fit.fit(fields, nodes, tetrahedra, faces, size, pull, steps)
        tell(f"fitted with weight {pull:g}: smallest angle {_least(nodes, tetrahedra):.1f} degrees")
    nodes = _to_volume(fields, nodes, tetrahedra, rows, faces, wanted, size)
    nodes = _without_flat(fields, nodes, tetrahedra, faces, size, tell)
    return Meshed(nodes, tetrahedra, rows, size)


def refuse_too_small(size: float, room: float) -> None:
    """`room` [m^3] is that of the box around all organs."""
    if room / size**3 * 12 > 20 * _MOST_TETRAHEDRA:
        raise Error(f"mesh: elements of {size * 1e3:.3g} mm are too small for this image: the box around the organs has room for {room / size**3 * 12:.1e}")


def _start(fields: Fields, size: float) -> tuple[Array, Array, Array]:
    nodes, tetrahedra, rows = _lattice.labelled(fields, size)
    if not rows.any():  # a voxel or two, which smoothing has removed
        return nodes, tetrahedra[:0], rows[:0]
    rows = _lattice.tidy(nodes, tetrahedra, rows)
    tetrahedra, rows = tetrahedra[rows > 0], rows[rows > 0]
    for _ in range(8):
        if not len(rows):
            break
        edges = _lattice.flat_corners(tetrahedra, rows)
        if not len(edges):
            break
        nodes, tetrahedra, rows = _lattice.split_edges(nodes, tetrahedra, rows, edges)
    if len(rows) > _MOST_TETRAHEDRA:
        raise Error(f"mesh: more than {_MOST_TETRAHEDRA} tetrahedra, got {len(rows)}; choose larger elements")
    nodes, tetrahedra, _ = _shapes.compact(nodes, tetrahedra) if len(rows) else (nodes, tetrahedra, None)
    return nodes, tetrahedra, rows


def _refuse_lost(fields: Fields, rows: Array, wanted: Array, size: float) -> None:
    count = np.bincount(rows, minlength=len(fields.labels))[1:]
    lost = np.flatnonzero((count == 0) & (wanted > 0))
    if len(lost):
        label = fields.labels[1 + lost[0]]
        raise Error(
            f"mesh: label {label} is thinner than the elements of {size * 1e3:.3g} mm, or than its smoothing, so nothing of it is left; "
            f"ask for smaller elements or less smoothing, or leave the label out"
        )


def _least(nodes: Array, tetrahedra: Array) -> float:
    return float(_shapes.dihedral_angles(nodes, tetrahedra).min())


def _areas(nodes: Array, faces: _fit.Interface, count: int) -> Array:
    corner = nodes[faces.faces]
    area = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    return np.bincount(faces.low, area, count) + np.bincount(faces.high, area, count)


def _to_volume(
    fields: Fields, nodes: Array, tetrahedra: Array, rows: Array, faces: _fit.Interface, wanted: Array, size: float
) -> Array:
    """Shifts the fields until the organs of the mesh have the wanted volumes: corners on a round surface cut it short."""
    pull, moved = _PULLS[-1][0], np.zeros(len(wanted))
    for _ in range(5):
        now = np.bincount(rows, _shapes.volumes(nodes, tetrahedra), len(fields.labels))[1:]
        if np.all(np.abs(now - wanted) < 2e-3 * wanted):
            break
        shift = (wanted - now) / _areas(nodes, faces, len(fields.labels))[1:]
        # Not further: what is missing because it is thinner than the elements must not be made up for elsewhere.
        shift = np.clip(moved + shift, -_FARTHEST * size, _FARTHEST * size) - moved
        moved += shift
        # Half of the difference of two fields is a distance, so a field moves by twice of what its surface shall.
        fields.values[1:] += (2.0 * shift)[:, None, None, None].astype(np.float32)
        nodes = _fit.fit(fields, nodes, tetrahedra, faces, size, pull, 60)
    return nodes


def _without_flat(fields: Fields, nodes: Array, tetrahedra: Array, faces: _fit.Interface, size: float, tell: Tell) -> Array:
    """Where elements are flat the surface pulls less, and less again, until they are not."""
    for _ in range(6):
        angles = _shapes.dihedral_angles(nodes, tetrahedra)
        flat = (angles.min(axis=1) < _WANTED_ANGLE) | (angles.max(axis=1) > 180.0 - _WANTED_ANGLE)
        if not flat.any():
            break
        tell(f"{int(flat.sum())} flat elements: the surface pulls less there")
        touched = np.zeros(len(nodes), bool)
        touched[tetrahedra[flat]] = True
        faces.weight[touched[faces.faces].any(axis=1)] *= 0.15
        nodes = _fit.fit(fields, nodes, tetrahedra, faces, size, _PULLS[-1][0], 60)
    return nodes
