"""Closed triangle meshes of implicit shapes: marching tetrahedra, then remeshing to a wanted edge length.

The remeshing is that of Botsch and Kobbelt, A remeshing approach to multiresolution modeling (2004): split long edges,
collapse short ones, flip towards six neighbours, move along the surface. Everything runs in index order."""
import numpy as np

from implicit import gradient, project

# Six tetrahedra around the diagonal of a cube; corner c lies at its bits (x, y, z).
CUBE = [(0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7)]


def march(f, low, high, cell):
    """The zero surface of f in a box, one piece or several, oriented outwards (towards larger f)."""
    axes = [np.arange(low[k], high[k] + cell, cell) for k in range(3)]
    shape = tuple(len(a) for a in axes)
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    value = np.concatenate([f(part) for part in np.array_split(grid, max(1, len(grid) // 100000))])
    value = np.where(np.abs(value) < 1e-6, 1e-6, value)
    index = np.arange(len(grid)).reshape(shape)
    corner = []
    for c in range(8):
        bits = [(c >> k) & 1 for k in range(3)]
        corner.append(index[tuple(slice(b, shape[k] - 1 + b) for k, b in enumerate(bits))].ravel())
    edges, sides = [], []  # three edges of the grid per triangle, and one node inside
    for tet in CUBE:
        nodes = np.stack([corner[c] for c in tet], axis=1)
        inside = value[nodes] < 0.0
        for bits in range(1, 15):
            pick = np.array([(bits >> k) & 1 for k in range(4)], bool)
            here = nodes[(inside == pick).all(axis=1)]
            if not len(here):
                continue
            a, b = np.flatnonzero(pick), np.flatnonzero(~pick)
            if len(a) == 2:
                quad = [(a[0], b[0]), (a[0], b[1]), (a[1], b[1]), (a[1], b[0])]
                triangles = [quad[:3], [quad[0], quad[2], quad[3]]]
            elif len(a) == 1:
                triangles = [[(a[0], k) for k in b]]
            else:
                triangles = [[(k, b[0]) for k in a]]
            for t in triangles:
                edges.append(np.stack([np.sort(here[:, e], axis=1) for e in t], axis=1))
                sides.append(here[:, a[0]])
    edges, sides = np.concatenate(edges), np.concatenate(sides)
    key = edges[:, :, 0].astype(np.int64) * len(grid) + edges[:, :, 1]
    unique, faces = np.unique(key.ravel(), return_inverse=True)
    faces = faces.reshape(-1, 3)
    i, j = unique // len(grid), unique % len(grid)
    s = np.clip(value[i] / (value[i] - value[j]), 0.05, 0.95)
    vertices = grid[i] + s[:, None] * (grid[j] - grid[i])
    normal = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    inwards = np.sum(normal * (vertices[faces[:, 0]] - grid[sides]), axis=1) < 0.0
    faces[inwards] = faces[inwards][:, ::-1]
    return vertices, faces


def normals(v, f):
    """Per vertex, weighted by area."""
    face = np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]])
    n = np.zeros_like(v)
    for k in range(3):
        np.add.at(n, f[:, k], face)
    return n / np.maximum(np.linalg.norm(n, axis=1), 1e-300)[:, None]


def edges_of(f):
    """Edges (low, high) in order."""
    e = np.sort(np.concatenate([f[:, [0, 1]], f[:, [1, 2]], f[:, [2, 0]]]), axis=1)
    return np.unique(e, axis=0)


class Patch:
    """A closed surface under change: triangles by number, and the triangles around each vertex."""

    def __init__(self, v, f, size):
        self.v = [np.asarray(x, float) for x in v]
        self.size = list(size)
        self.f = [list(map(int, t)) for t in f]
        self.around = [set() for _ in self.v]
        for i, t in enumerate(self.f):
            for a in t:
                self.around[a].add(i)

    def neighbours(self, a):
        return {b for i in self.around[a] for b in self.f[i]} - {a}

    def arrays(self):
        faces = np.array([t for t in self.f if t is not None])
        used = np.unique(faces)
        return np.array([self.v[i] for i in used]), np.searchsorted(used, faces)

    def length(self, a, b):
        d = self.v[a] - self.v[b]
        return (d @ d) ** 0.5 / (0.5 * (self.size[a] + self.size[b]))

    def split(self, a, b):
        m = len(self.v)
        self.v.append(0.5 * (self.v[a] + self.v[b]))
        self.size.append(0.5 * (self.size[a] + self.size[b]))
        self.around.append(set())
        for i in sorted(self.around[a] & self.around[b]):
            t = self.f[i]
            other = [m if x == a else x for x in t]
            self.f[i] = [m if x == b else x for x in t]
            self.around[b].discard(i)
            self.around[m].add(i)
            self.f.append(other)
            for x in other:
                self.around[x].add(len(self.f) - 1)

    def flips(self, i, a, place):
        """Whether triangle i turns over when its corner a moves."""
        p = [self.v[x] for x in self.f[i]]
        q = [place if x == a else self.v[x] for x in self.f[i]]
        n, m = np.cross(p[1] - p[0], p[2] - p[0]), np.cross(q[1] - q[0], q[2] - q[0])
        return n @ m < 0.3 * ((n @ n) * (m @ m)) ** 0.5

    def collapse(self, a, b):
        """b into a, at the middle, unless that would tie, fold or stretch the surface."""
        shared = self.around[a] & self.around[b]
        if len(shared) != 2 or len(self.neighbours(a) & self.neighbours(b)) != 2:
            return
        place, size = 0.5 * (self.v[a] + self.v[b]), 0.5 * (self.size[a] + self.size[b])
        for x in self.neighbours(a) | self.neighbours(b):
            d = self.v[x] - place
            if (d @ d) ** 0.5 > 1.33 * 0.5 * (size + self.size[x]):
                return
        for corner in (a, b):
            if any(self.flips(i, corner, place) for i in self.around[corner] - shared):
                return
        for i in shared:
            for x in self.f[i]:
                self.around[x].discard(i)
            self.f[i] = None
        for i in self.around[b]:
            self.f[i] = [a if x == b else x for x in self.f[i]]
            self.around[a].add(i)
        self.around[b] = set()
        self.v[a], self.size[a] = place, size

    def flip(self, a, b):
        """Turns the edge where that brings its four corners nearer to six neighbours each, and folds nothing."""
        shared = sorted(self.around[a] & self.around[b])
        if len(shared) != 2:
            return
        i, j = shared
        if (self.f[i].index(b) - self.f[i].index(a)) % 3 != 1:
            i, j = j, i
        c, d = (next(x for x in self.f[k] if x not in (a, b)) for k in (i, j))
        if d in self.neighbours(c):
            return
        n = [len(self.around[x]) - 6 for x in (a, b, c, d)]
        if sum(x * x for x in n) <= (n[0] - 1) ** 2 + (n[1] - 1) ** 2 + (n[2] + 1) ** 2 + (n[3] + 1) ** 2:
            return
        old = [self.normal(a, b, c), self.normal(b, a, d)]
        new = [self.normal(a, d, c), self.normal(d, b, c)]
        if old[0] @ old[1] < 0.5 or min(x @ y for x in old for y in new) < 0.5:
            return
        self.f[i], self.f[j] = [a, d, c], [d, b, c]
        self.around[a].discard(j)
        self.around[b].discard(i)
        self.around[d].add(i)
        self.around[c].add(j)

    def normal(self, a, b, c):
        n = np.cross(self.v[b] - self.v[a], self.v[c] - self.v[a])
        return n / max((n @ n) ** 0.5, 1e-300)


def remesh(f, v, faces, size, rounds=10, smoothing=2):
    """Triangles whose edges are about size(points) long, vertices on the zero surface of f."""
    for turn in range(rounds):
        patch = Patch(v, faces, size(v))
        ratio = {(a, b): patch.length(a, b) for a, b in edges_of(faces).tolist()}
        for a, b in sorted((e for e in ratio if ratio[e] > 1.33), key=lambda e: (-ratio[e], e)):
            if patch.around[a] & patch.around[b]:
                patch.split(a, b)
        v, faces = patch.arrays()
        patch = Patch(v, faces, size(v))
        ratio = {(a, b): patch.length(a, b) for a, b in edges_of(faces).tolist()}
        for a, b in sorted((e for e in ratio if ratio[e] < 0.8), key=lambda e: (ratio[e], e)):
            if patch.around[a] & patch.around[b] and patch.length(a, b) < 0.8:
                patch.collapse(a, b)
        v, faces = patch.arrays()
        patch = Patch(v, faces, size(v))
        for a, b in edges_of(faces).tolist():
            patch.flip(a, b)
        v, faces = patch.arrays()
        for _ in range(smoothing):
            v = project(f, relaxed(v, faces, gradient(f, v)), rounds=2)
    return project(f, v, rounds=6), faces


def relaxed(v, f, normal):
    """Every vertex to the middle of its triangles (weighted by area), along the surface only."""
    a, b, c = v[f[:, 0]], v[f[:, 1]], v[f[:, 2]]
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    # Equal triangles relative to what is wanted there: the square root keeps graded meshes graded.
    weight = np.sqrt(area)
    total, middle = np.zeros(len(v)), np.zeros_like(v)
    for k in range(3):
        np.add.at(total, f[:, k], weight)
        np.add.at(middle, f[:, k], weight[:, None] * (a + b + c) / 3.0)
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    move = middle / total[:, None] - v
    return v + 0.7 * (move - np.sum(move * normal, axis=1)[:, None] * normal)


def balanced(f, v, faces, rounds=6):
    """Vertices moved off the surface so far that the triangles between them lie on it on the average."""
    for _ in range(rounds):
        error, count = np.zeros(len(v)), np.zeros(len(v))
        samples = f(v[faces].mean(axis=1))
        for k in range(3):
            np.add.at(error, faces[:, k], samples)
            np.add.at(count, faces[:, k], 1.0)
        # The mean over a triangle of what is quadratic there: 3/4 of its middle and 1/4 of its corners.
        v = v - 0.7 * (0.75 * error / count + 0.25 * f(v))[:, None] * normals(v, faces)
    return v


def closed(faces):
    """Whether every edge is walked exactly once in each direction."""
    e = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    once = len(np.unique(e, axis=0)) == len(e)
    return once and np.array_equal(np.unique(e, axis=0), np.unique(e[:, ::-1], axis=0))


def volume(v, f):
    return np.sum(v[f[:, 0]] * np.cross(v[f[:, 1]], v[f[:, 2]])) / 6.0
