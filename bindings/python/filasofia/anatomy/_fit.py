"""Moves the nodes of a labelled mesh so that interfaces lie on the surfaces of the fields and elements keep a good shape.

Minimises the sum over tetrahedra of (|J|^2 / (3 det(J)^(2/3)))^3, with J the map from a regular tetrahedron (1 if it is
regular, infinite if flat: the energy of Rabinovich et al., Scalable locally injective mappings, 2017), and the squared
distance of points of the interfaces from the surfaces. The method is L-BFGS with steps that invert no element."""

from __future__ import annotations

import dataclasses as _dataclasses

import numpy as np

from ._fields import Fields
from ._shapes import FACES, neighbours
from ._types import Array

_POWER = 3
# Edge vectors of a regular tetrahedron, as columns.
_REGULAR = np.array([[1.0, 0.5, 0.5], [0.0, 3**0.5 / 2, 3**0.5 / 6], [0.0, 0.0, (2 / 3) ** 0.5]])
_INVERSE = np.linalg.inv(_REGULAR)
_POINTS = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6.0  # exact for what is quadratic on a triangle


@_dataclasses.dataclass
class Interface:
    """Faces between two rows of the fields, from the lower to the higher one, with a weight each."""

    faces: Array
    low: Array
    high: Array
    owners: Array  # the two tetrahedra, -1: none
    weight: Array


def interface_of(tetrahedra: Array, rows: Array) -> Interface:
    """All faces where two organs, or an organ and the outside (row 0), meet."""
    beyond = neighbours(tetrahedra)
    other = np.where(beyond >= 0, rows[beyond], 0)
    i, face = np.nonzero((other != rows[:, None]) & ((beyond < 0) | (beyond > np.arange(len(rows))[:, None])))
    nodes = np.take_along_axis(tetrahedra[i], FACES[face], axis=1)
    mine, theirs = rows[i], other[i, face]
    owners = np.stack([i, beyond[i, face]], axis=1)
    return Interface(nodes, np.minimum(mine, theirs), np.maximum(mine, theirs), owners, np.ones(len(i)))


def shape_energy(nodes: Array, tetrahedra: Array) -> tuple[Array, Array]:
    """Energy of each tetrahedron (infinite if it has no positive volume), and its gradient by its four nodes."""
    corner = nodes.T[:, tetrahedra.T]  # (xyz, node, n): whole rows at a time
    edges = corner[:, 1:] - corner[:, :1]
    j = [sum(edges[:, k] * _INVERSE[k, c] for k in range(c + 1)) for c in range(3)]  # columns; _INVERSE is upper triangular
    cofactor = [_cross(j[1], j[2]), _cross(j[2], j[0]), _cross(j[0], j[1])]
    det = (j[0] * cofactor[0]).sum(axis=0)
    if det.min() <= 0.0:
        return np.where(det <= 0.0, np.inf, 0.0), corner
    scale = np.cbrt(det) ** -2
    g = sum((column * column).sum(axis=0) for column in j) / 3.0 * scale
    outer = (2.0 / 3.0 * _POWER) * g ** (_POWER - 1)
    slope = [outer * (scale * j[c] - (g / det) * cofactor[c]) for c in range(3)]
    out = np.empty((4, 3, len(tetrahedra)))
    for k in range(3):
        out[k + 1] = sum(slope[c] * _INVERSE[k, c] for c in range(k, 3))
    out[0] = -out[1:].sum(axis=0)
    return g**_POWER, np.moveaxis(out, 2, 0)


def _cross(a: Array, b: Array) -> Array:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def distance_energy(fields: Fields, nodes: Array, faces: Interface) -> tuple[Array, Array]:
    """Mean squared distance [m^2] of each face from its surface, and its gradient by its three nodes."""
    corner = nodes[faces.faces]
    energy, out = np.zeros(len(corner)), np.zeros_like(corner)
    for weight in _POINTS:
        points = np.einsum("k,nki->ni", weight, corner)
        low, slope_low = fields.sample_gradient(points, faces.low)
        high, slope_high = fields.sample_gradient(points, faces.high)
        off, slope = 0.5 * (high - low), 0.5 * (slope_high - slope_low)
        energy += off**2 / 3.0
        out += (2.0 / 3.0) * off[:, None, None] * weight[None, :, None] * slope[:, None, :]
    return energy, out


class _Problem:
    def __init__(self, fields: Fields, nodes: Array, tetrahedra: Array, faces: Interface, size: float, pull: float) -> None:
        self.fields, self.tetrahedra, self.faces, self.size, self.pull = fields, tetrahedra, faces, size, pull
        self.count = len(nodes)

    def __call__(self, flat: Array) -> tuple[float, Array]:
        nodes = flat.reshape(-1, 3)
        shape, by_node = shape_energy(nodes / self.size, self.tetrahedra)
        total = float(shape.sum())
        if not np.isfinite(total):
            return np.inf, flat
        distance, by_corner = distance_energy(self.fields, nodes, self.faces)
        weight = self.pull / self.size**2 * self.faces.weight
        total += float((weight * distance).sum())
        out = np.empty((3, self.count))
        t, f = self.tetrahedra.ravel(), self.faces.faces.ravel()
        by_corner = (weight[:, None, None] * by_corner).reshape(-1, 3)
        by_node = by_node.reshape(-1, 3) / self.size
        for k in range(3):
            out[k] = np.bincount(t, by_node[:, k], self.count) + np.bincount(f, by_corner[:, k], self.count)
        return total, out.T.ravel()


def minimise(problem: _Problem, nodes: Array, steps: int, tolerance: float = 2e-5) -> Array:
    """L-BFGS (Nocedal and Wright, Numerical optimization, algorithm 7.4) with halved steps."""
    x = nodes.ravel().copy()
    value, slope = problem(x)
    pairs: list[tuple[Array, Array, float]] = []
    longest = 0.25 * problem.size
    for _ in range(steps):
        direction = -_two_loops(slope, pairs, problem.size)
        if direction @ slope >= 0.0:
            pairs, direction = [], -slope * (problem.size**2 * 1e-3)
        reach = np.abs(direction).max()
        rate = min(1.0, longest / max(reach, 1e-300))
        for _ in range(25):
            tried = x + rate * direction
            fresh, next_slope = problem(tried)
            if fresh <= value + 1e-4 * rate * (direction @ slope):
                break
            rate *= 0.5
        else:
            break
        s, y = tried - x, next_slope - slope
        if s @ y > 1e-12 * np.sqrt((s @ s) * (y @ y)):
            pairs = [*pairs[-9:], (s, y, 1.0 / (s @ y))]
        gained = value - fresh
        x, value, slope = tried, fresh, next_slope
        if gained < tolerance * abs(value):
            break
    return x.reshape(-1, 3)


def _two_loops(slope: Array, pairs: list[tuple[Array, Array, float]], size: float) -> Array:
    q, kept = slope.copy(), []
    for s, y, rho in reversed(pairs):
        a = rho * (s @ q)
        q -= a * y
        kept.append(a)
    q *= 1.0 / (pairs[-1][2] * (pairs[-1][1] @ pairs[-1][1])) if pairs else size**2 * 1e-3
    for (s, y, rho), a in zip(pairs, reversed(kept)):
        q += (a - rho * (y @ q)) * s
    return q


def fit(fields: Fields, nodes: Array, tetrahedra: Array, faces: Interface, size: float, pull: float, steps: int) -> Array:
    """Fitted nodes. `pull` weighs squared distances, in units of the elements' size, against shape."""
    return minimise(_Problem(fields, nodes, tetrahedra, faces, size, pull), nodes, steps)
