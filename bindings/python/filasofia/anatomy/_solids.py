"""Fields of closed surfaces, and meshes of them."""

from __future__ import annotations

import typing as _typing

import numpy as np

from filasofia import Error

from . import _shapes
from ._anatomy import Anatomy, checked_number
from ._dirty import Surface, clean, inside
from ._distance import samples, to_triangles
from ._fields import Fields, filled
from ._mesh import mesh_fields, refuse_too_small, size_for
from ._needs import need
from ._types import Array, Tell, silent

_MOST_VALUES = 30_000_000


def signed_distance(surface: Surface, axes: list[Array], notes: list[str]) -> Array:
    """Positive inside, on a grid; holes are closed as the grid's rays close them."""
    step = float(axes[0][1] - axes[0][0])
    within, twice = inside(surface, axes)
    if twice > 1e-3:
        notes.append(f"{100 * twice:.1f} % of its volume is enclosed more than once: it passes through itself; all of it is inside")
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    points, owner = samples(surface.vertices, surface.triangles, 0.7 * step)
    distance = _nearest(grid, points, owner, surface)
    # Where the sign changes far from any triangle there is a hole: its lid is between these points.
    lids = []
    for axis in range(3):
        a, d, p = (np.moveaxis(x, axis, 0) for x in (within, distance, grid))
        lid = (a[1:] != a[:-1]) & (np.minimum(d[1:], d[:-1]) > step)
        lids.append(0.5 * (p[1:] + p[:-1])[lid])
    closed = np.concatenate(lids)
    if len(closed):
        tree = need("scipy.spatial", "scipy", "meshing").cKDTree(closed)
        distance = np.minimum(distance, tree.query(grid.reshape(-1, 3))[0].reshape(distance.shape))
    return np.where(within, distance, -distance)


def _nearest(grid: Array, points: Array, owner: Array, surface: Surface) -> Array:
    """Distance of each point from the surface, exact where that is near; nothing is further away than 12 cells."""
    flat = grid.reshape(-1, 3)
    step = float(np.abs(grid[1, 0, 0] - grid[0, 0, 0]).sum())
    tree = need("scipy.spatial", "scipy", "meshing").cKDTree(points)
    far, near = tree.query(flat, k=2, distance_upper_bound=12.0 * step, workers=2)
    out = np.minimum(far[:, 0], 12.0 * step)
    close = np.flatnonzero(out < 4.0 * step)
    for k in range(2):
        triangles = surface.triangles[owner[np.minimum(near[close, k], len(owner) - 1)]]
        out[close] = np.minimum(out[close], to_triangles(flat[close], surface.vertices[triangles]))
    return out.reshape(grid.shape[:3])


def mesh_surfaces(
    surfaces: _typing.Mapping[str, tuple[_typing.Any, _typing.Any]],
    tetrahedra: _typing.Optional[int] = None,
    *,
    size: _typing.Optional[float] = None,
    scale: _typing.Optional[float] = None,
    tell: Tell = silent,
) -> Anatomy:
    """Meshes organs that are given as (vertices, triangles) by name. Surfaces may have holes, overlap themselves and each
    other, face either way and be in millimetres: what was found is in `notes`."""
    if not surfaces:
        raise Error("mesh: there must be at least one surface, got none")
    if tetrahedra is not None and size is not None:
        raise Error("mesh: tetrahedra and size exclude each other")
    parts = {name: clean(*given, name, scale) for name, given in surfaces.items()}
    notes = [note for part in parts.values() for note in part.notes]
    low = np.min([part.vertices[part.triangles].min(axis=(0, 1)) for part in parts.values()], axis=0)
    high = np.max([part.vertices[part.triangles].max(axis=(0, 1)) for part in parts.values()], axis=0)
    if (high - low).min() < 1e-4 * (high - low).max():
        raise Error(f"{next(iter(parts))}: the surface encloses no volume: it is flat")
    number = None
    if size is None:
        number = int(checked_number("mesh: tetrahedra", 10_000 if tetrahedra is None else tetrahedra, 20, 5_000_000))
        rough = sum(max(abs(_shapes.enclosed(part.vertices - low, part.triangles)), 1e-3 * float(np.prod(high - low))) for part in parts.values())
        size = size_for(min(rough, float(np.prod(high - low))), number)
    else:
        checked_number("mesh: size", size, 1e-6, 1.0)
    refuse_too_small(size, float(np.prod(high - low)))
    fields = _fields_of(parts, low, high, size, notes)
    wanted = filled(fields)[0]
    for row, part in enumerate(parts.values()):
        exact = _shapes.enclosed(part.vertices, part.triangles)
        if part.closed and abs(exact - wanted[row]) < 0.02 * exact:
            wanted[row] = exact  # otherwise what it encloses is a matter of its holes and overlaps
    if (wanted <= 0).any():
        raise Error(f"{list(parts)[int(np.argmin(wanted))]}: the surface encloses no volume")
    for note in notes:
        tell(note)
    made = mesh_fields(fields, wanted, size, number, tell)
    out = Anatomy(made.nodes, made.tetrahedra, made.rows, dict(enumerate(parts, 1)), fields, made.size)
    out.wanted, out.notes = dict(enumerate(wanted.tolist(), 1)), notes
    out.surfaces = {label: (part.vertices, part.triangles) for label, part in enumerate(parts.values(), 1) if part.closed}
    return out


def _fields_of(parts: _typing.Mapping[str, Surface], low: Array, high: Array, size: float, notes: list[str]) -> Fields:
    step = max(size / 5.0, float((np.prod(high - low) * (len(parts) + 1) / _MOST_VALUES) ** (1 / 3)))
    origin = low - 4.0 * step
    axes = [np.arange(origin[k], high[k] + 4.5 * step, step) for k in range(3)]
    values = []
    for name, part in parts.items():
        found: list[str] = []
        values.append(signed_distance(part, axes, found))
        notes += [f"{name}: {note}" for note in found]
    outside = -np.max(values, axis=0)
    return Fields(origin, step, np.stack([outside, *values]).astype(np.float32), np.arange(len(parts) + 1))
