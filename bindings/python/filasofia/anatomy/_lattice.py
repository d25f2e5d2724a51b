"""Tetrahedra of a body-centred cubic lattice, labelled and tidied so that they can be fitted to surfaces.

The lattice is the one of Molino, Bridson, Teran and Fedkiw, A crystalline, red green strategy for meshing highly
deformable objects with tetrahedra (2003). All organs are parts of one lattice, so neighbours share their nodes."""

from __future__ import annotations

import numpy as np

from ._fields import Fields
from ._needs import need
from ._shapes import EDGES, faces_of, neighbours
from ._types import Array

# Points of a tetrahedron: the 20 of a cubic element, each a quarter of the way to the middle.
_POINTS = [
    0.75 * np.array([i, j, k, 3 - i - j - k]) / 3.0 + 0.0625
    for i in range(4) for j in range(4 - i) for k in range(4 - i - j)
]  # fmt: skip
_ENOUGH = 2  # of those points
_AWAY = 0.8  # times the reach of a tetrahedron from its middle, 0.56 of the size of the lattice: neighbours are nearer


def lattice(origin: Array, shape: Array, size: float) -> tuple[Array, Array]:
    """Nodes and tetrahedra (of positive volume size^3 / 12) of `shape` cubes of edge `size`."""
    nx, ny, nz = (int(n) for n in shape)
    corner = np.arange((nx + 1) * (ny + 1) * (nz + 1)).reshape(nx + 1, ny + 1, nz + 1)
    middle = corner.size + np.arange(nx * ny * nz).reshape(nx, ny, nz)
    grid = np.stack(np.meshgrid(*(np.arange(n + 1) for n in (nx, ny, nz)), indexing="ij"), axis=-1).reshape(-1, 3)
    half = np.stack(np.meshgrid(*(np.arange(n) + 0.5 for n in (nx, ny, nz)), indexing="ij"), axis=-1).reshape(-1, 3)
    nodes = origin + size * np.concatenate([grid, half])
    out = []
    for axis in range(3):
        u, v = [(1, 2), (2, 0), (0, 1)][axis]
        low = np.moveaxis(middle, (axis, u, v), (0, 1, 2))
        c = np.moveaxis(corner, (axis, u, v), (0, 1, 2))[1:-1]
        ring = [c[:, :-1, :-1], c[:, 1:, :-1], c[:, 1:, 1:], c[:, :-1, 1:]]  # around the face, seen from above
        for k in range(4):
            out.append(np.stack([low[:-1], ring[k], ring[(k + 1) % 4], low[1:]], axis=-1).reshape(-1, 4))
    return nodes, np.concatenate(out)


def _votes(fields: Fields, nodes: Array, tetrahedra: Array) -> Array:
    """Row that has most of 20 points in each tetrahedron; the field at the middle decides where it is far ahead."""
    if not len(tetrahedra):  # the whole map is smaller than an element
        return np.zeros(0, int)
    corner = nodes[tetrahedra]
    middle = corner.mean(axis=1)
    out, ahead = fields.leader(middle)
    reach = np.linalg.norm(corner - middle[:, None], axis=2).max(axis=1)
    open_ = np.flatnonzero(ahead < 2.0 * reach)
    count = np.zeros((len(fields.labels), len(open_)))
    for weight in _POINTS:
        row = fields.leader(np.einsum("k,nki->ni", weight, corner[open_]))[0]
        count[row, np.arange(len(open_))] += 1.0
    count[out[open_], np.arange(len(open_))] += 0.5  # of equal votes the middle's counts
    out[open_] = count.argmax(axis=0)
    _keep_thin(middle, out, open_, count, float(reach.max()))
    return out


def _keep_thin(middle: Array, rows: Array, open_: Array, count: Array, reach: float) -> None:
    """What is thinner than a tetrahedron has the majority nowhere: there a tenth of the points is enough."""
    tree = need("scipy.spatial", "scipy", "meshing").cKDTree
    for row in range(1, len(count)):
        few = open_[(count[row] >= _ENOUGH) & (rows[open_] == 0)]
        mine = np.flatnonzero(rows == row)
        if len(few) and len(mine):
            few = few[tree(middle[mine]).query(middle[few])[0] > _AWAY * reach]
        rows[few] = row


def labelled(fields: Fields, size: float) -> tuple[Array, Array, Array]:
    """Nodes, tetrahedra and the row of the field that has most of each; those far outside are left out."""
    room = (np.array(fields.values.shape[1:]) - 1) * fields.step
    shape = np.ceil(room / size).astype(int) + 2
    origin = fields.origin - 0.5 * (shape * size - room)
    nodes, tetrahedra = lattice(origin, shape, size)
    middle = nodes[tetrahedra].mean(axis=1)
    outside = fields.sample(middle, np.zeros(len(middle), int))
    near = outside < 1.6 * size
    inside_box = ((middle > fields.origin) & (middle < fields.origin + room)).all(axis=1)
    tetrahedra = tetrahedra[near & inside_box]
    return nodes, tetrahedra, _votes(fields, nodes, tetrahedra)


def tidy(nodes: Array, tetrahedra: Array, rows: Array, smallest: int = 6) -> Array:
    """Rows without spikes, pinched places and crumbs: what is small, thin or hangs on an edge becomes its neighbour's."""
    beyond = neighbours(tetrahedra)
    rows = rows.copy()
    for _ in range(12):
        before = rows.copy()
        _without_spikes(rows, beyond)
        _without_pinches(tetrahedra, rows, beyond)
        if np.array_equal(before, rows):
            break
    _without_crumbs(rows, beyond, smallest)
    return rows


def _beside(rows: Array, beyond: Array) -> Array:
    return np.where(beyond >= 0, rows[beyond], 0)


def _without_spikes(rows: Array, beyond: Array) -> None:
    """A tetrahedron with three faces towards one other organ is that one's."""
    for _ in range(6):
        other = _beside(rows, beyond)
        ordered = np.sort(other, axis=1)
        most = np.where((ordered[:, 1] == ordered[:, 2]), ordered[:, 1], -1)
        count = (other == most[:, None]).sum(axis=1)
        spike = (most >= 0) & (count >= 3) & (most != rows)
        # Two spikes that touch would change places for ever: only the first of them moves.
        spike &= ~((spike[np.maximum(beyond, 0)] & (beyond >= 0) & (beyond < np.arange(len(rows))[:, None])).any(axis=1))
        if not spike.any():
            return
        rows[spike] = most[spike]


def _without_pinches(tetrahedra: Array, rows: Array, beyond: Array) -> None:
    """Around a node the tetrahedra of an organ hang together by faces; a smaller part is given to a neighbour."""
    for row in np.unique(rows):
        mine = np.flatnonzero(rows == row)
        # Nodes of corners, joined where a face of two tetrahedra of the organ has that node.
        at = -np.ones(len(rows), int)
        at[mine] = np.arange(len(mine))
        i, face = np.nonzero((beyond[mine] >= 0) & (at[np.maximum(beyond[mine], 0)] >= 0))
        j = at[beyond[mine[i], face]]
        first, second = [], []
        for corner in range(4):
            here = face != corner
            node = tetrahedra[mine[i[here]], corner]
            there = (tetrahedra[mine[j[here]]] == node[:, None]).argmax(axis=1)
            first.append(4 * i[here] + corner)
            second.append(4 * j[here] + there)
        part = _parts(4 * len(mine), np.concatenate(first), np.concatenate(second))
        node = tetrahedra[mine].ravel()
        keys, group, size = np.unique(node.astype(np.int64) * (4 * len(mine)) + part, return_inverse=True, return_counts=True)
        owner = keys // (4 * len(mine))
        largest = np.zeros(int(node.max()) + 1, int)
        np.maximum.at(largest, owner, size)
        # Of equal parts the last one goes.
        loses = size < largest[owner]
        ties = np.flatnonzero(~loses)
        later = ties[1:][owner[ties][1:] == owner[ties][:-1]]
        loses[later] = True
        lost = mine[np.unique(np.flatnonzero(loses[group.ravel()]) // 4)]
        if len(lost):
            other = _beside(rows, beyond)[lost]
            rows[lost] = _most_common(other, rows[lost])


def _most_common(other: Array, own: Array) -> Array:
    count = (other[:, :, None] == other[:, None, :]).sum(axis=2) * (other != own[:, None])
    return np.where(count.max(axis=1) > 0, other[np.arange(len(other)), count.argmax(axis=1)], 0)


def _parts(count: int, first: Array, second: Array) -> Array:
    """Number of the connected part of each of `count` things that are joined in pairs."""
    part = np.arange(count)
    while len(first):
        low = np.minimum(part[first], part[second])
        before = part.copy()
        np.minimum.at(part, part[first], low)
        np.minimum.at(part, part[second], low)
        part = part[part]
        if np.array_equal(before, part):
            break
    return part


def pieces(rows: Array, beyond: Array) -> Array:
    """Number of the connected piece of one label that each tetrahedron belongs to."""
    i, face = np.nonzero(beyond >= 0)
    j = beyond[i, face]
    same = (rows[i] == rows[j]) & (i < j)
    return np.unique(_parts(len(rows), i[same], j[same]), return_inverse=True)[1].ravel()


def _without_crumbs(rows: Array, beyond: Array, smallest: int) -> None:
    """Pieces of fewer tetrahedra than `smallest` become their neighbours', unless they are all of their organ."""
    for _ in range(3):
        piece = pieces(rows, beyond)
        size = np.bincount(piece)
        largest = np.zeros(int(rows.max()) + 1, int)
        np.maximum.at(largest, rows, size[piece])
        crumb = (size[piece] < smallest) & (size[piece] < largest[rows])
        if not crumb.any():
            return
        rows[crumb] = _most_common(_beside(rows, beyond)[crumb], rows[crumb])


def split_edges(nodes: Array, tetrahedra: Array, rows: Array, chosen: Array) -> tuple[Array, Array, Array]:
    """Divides edges (n, 2) in the middle, at most one of each tetrahedron: others of a tetrahedron wait for the next call."""
    count = len(nodes)
    edges = np.sort(tetrahedra[:, EDGES], axis=2).astype(np.int64)
    keys = edges[:, :, 0] * count + edges[:, :, 1]
    wanted = np.unique(np.sort(chosen, axis=1).astype(np.int64) @ np.array([count, 1]))
    number = np.searchsorted(wanted, keys)
    hit = (number < len(wanted)) & (wanted[np.minimum(number, len(wanted) - 1)] == keys)
    number = np.where(hit, number, len(wanted))
    taken = np.zeros(len(wanted) + 1, bool)
    first = number.min(axis=1)  # an edge is split if it is the first one in all of its tetrahedra
    taken[:] = True
    later = hit & (number != first[:, None])
    taken[number[later]] = False
    taken[len(wanted)] = False
    here = taken[number] & hit
    which = np.flatnonzero(here.any(axis=1))
    local = here[which].argmax(axis=1)
    fresh = np.cumsum(taken) - 1 + count
    a, b = EDGES[local, 0], EDGES[local, 1]
    one, two = tetrahedra[which].copy(), tetrahedra[which].copy()
    middle = fresh[number[which, local]]
    one[np.arange(len(which)), a] = middle
    two[np.arange(len(which)), b] = middle
    ends = np.stack([wanted[taken[:-1]] // count, wanted[taken[:-1]] % count], axis=1)
    tetrahedra = tetrahedra.copy()
    tetrahedra[which] = one
    return (
        np.concatenate([nodes, nodes[ends].mean(axis=1)]),
        np.concatenate([tetrahedra, two]),
        np.concatenate([rows, rows[which]]),
    )


def flat_corners(tetrahedra: Array, rows: Array) -> Array:
    """Edges to divide: a tetrahedron with two faces on one interface would become flat as they do. Its edge opposite to
    the one where they meet is divided, and the new node can move inside."""
    beyond = neighbours(tetrahedra)
    rim = _beside(rows, beyond) != rows[:, None]
    which = np.flatnonzero(rim.sum(axis=1) == 2)
    kept = rim[which]
    # Faces i and j of the rim meet at the edge of the two other nodes; the opposite edge is that of nodes i and j.
    i = kept.argmax(axis=1)
    j = 3 - kept[:, ::-1].argmax(axis=1)
    return np.stack([tetrahedra[which, i], tetrahedra[which, j]], axis=1)


__all__ = ["faces_of", "flat_corners", "labelled", "lattice", "pieces", "split_edges", "tidy"]
