"""Surfaces as they come: what is wrong with them is told, and repaired as far as it can be.

Holes and overlaps need no repair of triangles: whether a point is inside is asked of rays along three axes, which count
how often they leave more than they enter. A ray through a hole does not come out even, and its vote does not count."""

from __future__ import annotations

import typing as _typing

import numpy as np

from filasofia import Error

from ._needs import need, scipy_ndimage
from ._shapes import enclosed
from ._types import Array

_METRES_AT_MOST = 3.0  # a larger organ must have been given in millimetres


class Surface(_typing.NamedTuple):
    """Vertices [m], triangles that are oriented outwards, and what was found and done."""

    vertices: Array
    triangles: Array
    notes: list[str]
    closed: bool


def clean(vertices: _typing.Any, triangles: _typing.Any, name: str, scale: _typing.Optional[float] = None) -> Surface:
    """Joined, oriented, in metres. `scale` is the unit of the numbers [m]; without it the size decides."""
    vertices, triangles = np.array(vertices, float), np.array(triangles, np.int64)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or triangles.ndim != 2 or triangles.shape[1] != 3 or not len(triangles):
        raise Error(f"{name}: a surface must have vertices (n, 3) and at least one triangle (m, 3), got {vertices.shape} and {triangles.shape}")
    if not np.isfinite(vertices).all():
        raise Error(f"{name}: vertex {int(np.argwhere(~np.isfinite(vertices))[0, 0])} must be finite")
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise Error(f"{name}: triangles must name vertices in [0, {len(vertices)}), got {int(triangles.min())} to {int(triangles.max())}")
    notes: list[str] = []
    vertices = _in_metres(vertices, triangles, name, scale, notes)
    vertices, triangles = _joined(vertices, triangles, notes)
    if len(triangles) < 4:
        raise Error(f"{name}: a surface must have at least 4 triangles of some area, got {len(triangles)}")
    closed = _count_edges(triangles, notes)
    triangles = _oriented(vertices, triangles, notes)
    return Surface(vertices, triangles, [f"{name}: {note}" for note in notes], closed)


def _in_metres(vertices: Array, triangles: Array, name: str, scale: _typing.Optional[float], notes: list[str]) -> Array:
    room = float(np.linalg.norm(np.ptp(vertices[np.unique(triangles)], axis=0)))
    if scale is None and room > _METRES_AT_MOST:
        notes.append(f"it is {room:.4g} large, so its unit is taken for millimetres (--scale 1 says metres)")
        scale = 1e-3
    vertices = vertices * (scale or 1.0)
    room *= scale or 1.0
    if not 1e-4 <= room <= 10.0:
        raise Error(f"{name}: must be 0.1 mm to 10 m large, got {room:.4g} m; --scale says what its unit is")
    return vertices


def _joined(vertices: Array, triangles: Array, notes: list[str]) -> tuple[Array, Array]:
    """Vertices nearer than a millionth of the size are one; triangles without area or given twice go."""
    room = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    tree = need("scipy.spatial", "scipy", "repairing").cKDTree(vertices)
    pairs = tree.query_pairs(1e-6 * room, output_type="ndarray")
    if len(pairs):
        from ._lattice import _parts

        part = _parts(len(vertices), pairs[:, 0], pairs[:, 1])
        triangles = part[triangles]
        notes.append(f"{len(vertices) - len(np.unique(part))} vertices lay on others and were joined")
    corner = vertices[triangles]
    area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    kept = area > 1e-14 * room**2
    if not kept.all():
        notes.append(f"{int((~kept).sum())} triangles without area were dropped")
    triangles = triangles[kept]
    first = np.sort(np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)[1])
    if len(first) < len(triangles):
        notes.append(f"{len(triangles) - len(first)} triangles were there twice")
    return vertices, triangles[first]


def _edges(triangles: Array) -> tuple[Array, Array, Array]:
    """Of each side of each triangle: its number, its direction, and how many sides have that number."""
    sides = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    _, number, count = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True)
    number = number.ravel()
    return number, sides[:, 0] < sides[:, 1], count[number]


def _count_edges(triangles: Array, notes: list[str]) -> bool:
    number, _, count = _edges(triangles)
    open_, many = int((count == 1).sum()), len(np.unique(number[count > 2]))
    if open_:
        notes.append(f"{open_} edges have a triangle on one side only: its holes are closed")
    if many:
        notes.append(f"{many} edges have more than two triangles: it is not a manifold; the volume decides what is inside")
    return not open_ and not many


def _oriented(vertices: Array, triangles: Array, notes: list[str]) -> Array:
    """Neighbours agree on what is outside, and the largest part encloses a positive volume."""
    number, along, count = _edges(triangles)
    order = np.argsort(number, kind="stable")
    pair = order[(count[order] == 2)].reshape(-1, 2)
    first, second = pair[:, 0] // 3, pair[:, 1] // 3
    against = along[pair[:, 0]] == along[pair[:, 1]]
    part, turned = _sides(len(triangles), first, second, against)
    out = triangles.copy()
    size, flips = np.bincount(part), np.bincount(part, turned)
    minority = turned ^ (flips > 0.5 * size)[part]  # of each part the fewer triangles are turned
    out[minority] = out[minority][:, ::-1]
    if minority.any():
        notes.append(f"{int(minority.sum())} triangles faced the other way than their neighbours and were turned")
    volume = np.array([enclosed(vertices, out[part == p]) for p in range(len(size))]) if len(size) < 1000 else np.ones(1)
    mixed = np.zeros(len(size), bool)
    mixed[part[minority]] = True
    # A part inside another may face inwards: it is a cavity. Only if all face inwards, or a part was mixed, it is turned.
    inwards = (volume < 0) & (mixed | (volume[np.abs(volume).argmax()] < 0)) if len(size) < 1000 else np.zeros(len(size), bool)
    if inwards.any():
        out[inwards[part]] = out[inwards[part]][:, ::-1]
        notes.append(f"{int(inwards.sum())} of {len(size)} parts faced inwards and were turned")
    return out


def _sides(count: int, first: Array, second: Array, against: Array) -> tuple[Array, Array]:
    """Parts of triangles that hang together, and which of a part face the other way than its first one."""
    sparse = need("scipy.sparse", "scipy", "repairing")
    graph = need("scipy.sparse.csgraph", "scipy", "repairing")
    ones = np.ones(len(first), np.int8)
    table = sparse.csr_matrix((ones, (first, second)), shape=(count, count))
    parts, part = graph.connected_components(table, directed=False)
    # Twice as many nodes: a triangle as it is, and turned. Where neighbours disagree the one joins the other's turned one.
    ends = np.concatenate([second + count * against, second + count * ~against])
    double = sparse.csr_matrix((np.ones(len(ends), np.int8), (np.concatenate([first, first + count]), ends)), shape=(2 * count, 2 * count))
    _, side = graph.connected_components(double, directed=False)
    start = np.full(parts, count)
    np.minimum.at(start, part, np.arange(count))
    return part, side[:count] != side[start[part]]


def _votes(vertices: Array, triangles: Array, axes: list[Array], axis: int) -> tuple[Array, Array, Array]:
    """Rays along an axis: whether each point is inside, whether its column came out even, and how often inside."""
    u, v = [(1, 2), (2, 0), (0, 1)][axis]
    step = axes[0][1] - axes[0][0]
    shape = (len(axes[u]), len(axes[v]), len(axes[axis]))
    corner = vertices[triangles][:, :, [u, v, axis]]
    # No ray through a vertex: a shift that no mesh has.
    place = (corner - [axes[u][0] + 0.0137 * step, axes[v][0] + 0.0219 * step, axes[axis][0]]) / step
    low = np.clip(np.ceil(place[:, :, :2].min(axis=1)), 0, np.array(shape[:2])).astype(int)
    high = np.clip(np.floor(place[:, :, :2].max(axis=1)) + 1, 0, np.array(shape[:2])).astype(int)
    extent = np.maximum(high - low, 0)
    owner = np.repeat(np.arange(len(triangles)), extent.prod(axis=1))
    within = np.arange(len(owner)) - np.repeat(np.cumsum(extent.prod(axis=1)) - extent.prod(axis=1), extent.prod(axis=1))
    i, j = low[owner, 0] + within // extent[owner, 1], low[owner, 1] + within % extent[owner, 1]
    a, b, c = (place[owner, k] for k in range(3))
    point = np.stack([i, j], axis=1)

    def side(p: Array, q: Array) -> Array:
        return (q[:, 0] - p[:, 0]) * (point[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (point[:, 0] - p[:, 0])

    s, t, w = side(b, c), side(c, a), side(a, b)
    total = s + t + w
    hit = ((s >= 0) & (t >= 0) & (w >= 0) | (s <= 0) & (t <= 0) & (w <= 0)) & (total != 0)
    i, j, s, t, w, total = i[hit], j[hit], s[hit], t[hit], w[hit], total[hit]
    height = (s * a[hit, 2] + t * b[hit, 2] + w * c[hit, 2]) / total
    k = np.clip(np.ceil(height).astype(int) - 1, -1, shape[2] - 1)  # points up to k are below the crossing
    table = np.zeros((shape[0], shape[1], shape[2] + 1), np.int32)
    np.add.at(table, (i, j, k + 1), np.where(total > 0, 1, -1))
    winding = np.cumsum(table[:, :, ::-1], axis=2)[:, :, ::-1]
    even = np.broadcast_to(winding[:, :, :1] == 0, winding.shape)[:, :, 1:]
    back = np.argsort([u, v, axis])
    return (winding[:, :, 1:] > 0).transpose(back), even.transpose(back), winding[:, :, 1:].transpose(back)


def inside(surface: Surface, axes: list[Array]) -> tuple[Array, float]:
    """Whether each point of a grid is inside, and the share of points that are inside more than once."""
    yes, counted, most = None, None, None
    for axis in range(3):
        vote, even, winding = _votes(surface.vertices, surface.triangles, axes, axis)
        vote, even = (vote & even).astype(np.int8), even.astype(np.int8)
        yes = vote if yes is None else yes + vote
        counted = even if counted is None else counted + even
        most = np.where(even, winding, 0) if most is None else np.minimum(most, np.where(even, winding, 0))
    assert yes is not None and counted is not None and most is not None
    out, known = 2 * yes > counted, (counted > 0) & (2 * yes != counted)
    ndimage = scipy_ndimage()
    for _ in range(64):  # where no ray came out even, or they disagree, the neighbours decide
        if known.all():
            break
        votes = ndimage.uniform_filter(np.where(known, np.where(out, 1.0, -1.0), 0.0), 3, mode="nearest")
        fresh = ~known & (np.abs(votes) > 1e-9)
        if not fresh.any():
            break
        out[fresh], known[fresh] = votes[fresh] > 0, True
    return out, float((most > 1).sum() / max(1, int(out.sum())))
