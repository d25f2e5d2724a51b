"""The meshes of the cholecystectomy: a piece of liver, gall bladder, cystic duct, cystic artery, and the connective layer
between the last two. They are shapes of formulas, in the sizes of anatomy books; nothing of a patient is in them. Run it with
any Python 3: python3 cholecystectomy.py FOLDER. Millimetres; x to the right, y up, z towards the surgeon."""
import math
import sys
from pathlib import Path

FUNDUS, NECK = (-28.0, 30.0, 9.0), (12.0, -8.0, 10.0)  # ends of the gall bladder's axis
WALL = 1.8                                            # of the gall bladder
DUCT = ((10.5, -6.6, 10.0), (18.0, -13.5, 10.5), (27.0, -18.5, 9.0), (40.0, -24.0, 5.0))
DUCT_SIZE = (1.1, 0.8, 8, 24)                          # lumen, wall, cells around it and along it
ARTERY = ((5.0, 4.2, 13.0), (14.0, 2.5, 12.0), (26.0, -3.0, 8.5), (42.0, -9.0, 4.0))
ARTERY_SIZE = (0.6, 0.5, 6, 22)
LIVER, LIVER_AT, LIVER_CELLS = (150.0, 104.0, 26.0), (-6.0, 22.0, -15.0), (11, 8, 3)
LAYER = (0.20, 0.80, 12, 7, 0.5)                       # from and to along duct and artery, cells along and across, thickness


def add(a, b, t=1.0):
    return tuple(x + t * y for x, y in zip(a, b))


def sub(a, b):
    return add(a, b, -1.0)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return tuple(x / math.sqrt(dot(a, a)) for x in a)


def curve(points, t):
    """A Catmull-Rom spline through the points, t in [0, 1]."""
    n = len(points) - 1
    i = min(int(t * n), n - 1)
    u = t * n - i
    p1, p2 = points[i], points[i + 1]
    p0 = points[i - 1] if i > 0 else add(add(p1, p1), p2, -1.0)
    p3 = points[i + 2] if i + 2 <= n else add(add(p2, p2), p1, -1.0)
    return tuple(0.5 * (2 * b + (c - a) * u + (2 * a - 5 * b + 4 * c - d) * u * u + (3 * b - a - 3 * c + d) * u ** 3)
                 for a, b, c, d in zip(p0, p1, p2, p3))


def prisms(pairs, triangles):
    """Tetrahedra of prisms between two layers of nodes: pairs[v] = (inner, outer). Diagonals by the numbers, so that they fit."""
    tets = []
    for t in triangles:
        a, b, c = sorted(t)
        tets += [(pairs[a][0], pairs[b][0], pairs[c][0], pairs[c][1]), (pairs[a][0], pairs[b][0], pairs[b][1], pairs[c][1]),
                 (pairs[a][0], pairs[a][1], pairs[b][1], pairs[c][1])]
    return tets


def turned(nodes, tets):
    """All with a positive volume."""
    out = []
    for a, b, c, d in tets:
        six = dot(sub(nodes[b], nodes[a]), cross(sub(nodes[c], nodes[a]), sub(nodes[d], nodes[a])))
        assert abs(six) > 1e-6, "a flat tetrahedron"
        out.append((a, b, c, d) if six > 0 else (a, c, b, d))
    return nodes, out


def write(path, nodes, tets):
    nodes, tets = turned(nodes, tets)
    def metre(x):
        text = ("%.8f" % (x / 1000.0)).rstrip("0").rstrip(".")
        return "0" if text in ("-0", "") else text
    rows = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(nodes))]
    rows += [f"{i + 1} " + " ".join(metre(x) for x in p) for i, p in enumerate(nodes)]
    rows += ["$EndNodes", "$Elements", str(len(tets))]
    rows += ["%d 4 2 0 1 %d %d %d %d" % (i + 1, *(n + 1 for n in t)) for i, t in enumerate(tets)]
    path.write_text("\n".join(rows + ["$EndElements", ""]))
    print(path.name, len(tets), "tetrahedra", len(nodes), "nodes")


def pear(s):
    """[mm] Radius of the gall bladder at s in [-1, 1], from fundus to neck."""
    round_off = math.sqrt(max(0.0, 1.0 - s * s))
    t = 0.5 * (s + 1.0)
    return round_off * (14.5 - 10.2 * t ** 1.3) * 1.02


def sphere(n):
    """A cube of n x n cells per face, blown up: directions and triangles."""
    places, triangles, known = [], [], {}
    def node(p):
        key = tuple(round(x, 6) for x in p)
        if key not in known:
            known[key] = len(places)
            places.append(unit(tuple(math.tan(0.25 * math.pi * x) for x in p)))
        return known[key]
    for axis in range(3):
        for side in (-1.0, 1.0):
            def at(i, j):
                u, v = -1 + 2 * i / n, -1 + 2 * j / n
                return node(tuple(side if k == axis else (u if k == (axis + 1) % 3 else v) for k in range(3)))
            for i in range(n):
                for j in range(n):
                    a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
                    triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    return places, triangles


def gallbladder():
    directions, triangles = sphere(6)
    axis = unit(sub(NECK, FUNDUS))
    middle = tuple(0.5 * (a + b) for a, b in zip(FUNDUS, NECK))
    half = 0.5 * math.sqrt(dot(sub(NECK, FUNDUS), sub(NECK, FUNDUS)))
    u = unit(cross(axis, (0.0, 0.0, 1.0)))
    v = cross(u, axis)
    nodes, pairs = [], []
    for d in directions:
        for wall in (WALL, 0.0):
            s = d[2]
            across = math.hypot(d[0], d[1])
            flat = max(0.3, pear(s) - wall) if across > 1e-9 else 0.0
            shrink = (half - wall) / half
            x, y = (d[0] / across, d[1] / across) if across > 1e-9 else (0.0, 0.0)
            p = add(middle, axis, s * half * shrink)
            nodes.append(add(add(p, u, flat * x), v, flat * y))
        pairs.append((len(nodes) - 2, len(nodes) - 1))
    return nodes, prisms(pairs, triangles)


def vessel(points, size):
    lumen, wall, around, along = size
    nodes = []
    v = (0.0, 0.0, 1.0)
    for i in range(along + 1):
        t = i / along
        here = curve(points, t)
        tangent = unit(sub(curve(points, min(1.0, t + 1e-3)), curve(points, max(0.0, t - 1e-3))))
        v = unit(add(v, tangent, -dot(v, tangent)))
        u = cross(tangent, v)
        for k in range(around):
            angle = 2.0 * math.pi * k / around
            out = add(tuple(math.cos(angle) * x for x in u), v, math.sin(angle))
            nodes += [add(here, out, lumen), add(here, out, lumen + wall)]
    tets = []
    def node(i, k, layer):
        return 2 * (around * i + k % around) + layer
    surface, pairs = [], []
    for i in range(along + 1):
        for k in range(around):
            pairs.append((node(i, k, 0), node(i, k, 1)))
    for i in range(along):
        for k in range(around):
            a, b = around * i + k, around * i + (k + 1) % around
            c, d = around * (i + 1) + (k + 1) % around, around * (i + 1) + k
            surface += [(a, b, c), (a, c, d)] if (i + k) % 2 else [(a, b, d), (b, c, d)]
    tets = prisms(pairs, surface)
    return nodes, tets


def liver():
    nx, ny, nz = LIVER_CELLS
    axis = unit(sub(NECK, FUNDUS))
    length = math.sqrt(dot(sub(NECK, FUNDUS), sub(NECK, FUNDUS)))
    nodes = []
    for k in range(nz + 1):
        for j in range(ny + 1):
            for i in range(nx + 1):
                x, y, z = (2.0 * i / nx - 1.0, 2.0 * j / ny - 1.0, 2.0 * k / nz - 1.0)
                # a cushion: thinner towards its rim, round in its corners
                r = 1.0 - 0.17 * x * x * y * y
                rim = 1.0 - 0.45 * max(abs(x), abs(y)) ** 4
                p = (LIVER_AT[0] + 0.5 * LIVER[0] * x * r, LIVER_AT[1] + 0.5 * LIVER[1] * y * r,
                     LIVER_AT[2] + 0.5 * LIVER[2] * (z * rim))
                if k == nz: # the bed of the gall bladder
                    s = dot(sub(p, FUNDUS), axis) / length
                    near = add(FUNDUS, axis, max(0.0, min(1.0, s)) * length)
                    across = math.hypot(*sub(p, near)[:2])
                    bed = 5.5 * math.exp(-(across / 13.0) ** 2) * (1.0 if -0.1 < s < 1.05 else 0.4)
                    p = (p[0], p[1], p[2] - bed)
                nodes.append(p)
    tets = []
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                corner = [(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2 & 1)) for b in range(8)]
                ids = [a + (nx + 1) * (b + (ny + 1) * c) for a, b, c in corner]
                flip = (1 if i % 2 else 0) | (2 if j % 2 else 0) | (4 if k % 2 else 0)
                for order in ((1, 2), (1, 4), (2, 1), (2, 4), (4, 1), (4, 2)): # six around the diagonal
                    path = [0, order[0], order[0] + order[1], 7]
                    tets.append(tuple(ids[b ^ flip] for b in path))
    return nodes, tets


def layer():
    start, end, along, across, thick = LAYER
    nodes, pairs, triangles = [], [], []
    for i in range(along + 1):
        t = start + (end - start) * i / along
        a, b = curve(ARTERY, t), curve(DUCT, t)
        for j in range(across + 1):
            u = j / across
            p = add(tuple((1 - u) * x for x in a), b, u)
            nodes += [add(p, (0, 0, 1), -0.5 * thick - 0.3), add(p, (0, 0, 1), 0.5 * thick - 0.3)]
            pairs.append((len(nodes) - 2, len(nodes) - 1))
    for i in range(along):
        for j in range(across):
            a, b = (across + 1) * i + j, (across + 1) * (i + 1) + j
            triangles += [(a, b, b + 1), (a, b + 1, a + 1)] if (i + j) % 2 else [(a, b, a + 1), (b, b + 1, a + 1)]
    return nodes, prisms(pairs, triangles)


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    write(folder / "liver.msh", *liver())
    write(folder / "gallbladder.msh", *gallbladder())
    write(folder / "duct.msh", *vessel(DUCT, DUCT_SIZE))
    write(folder / "artery.msh", *vessel(ARTERY, ARTERY_SIZE))
    write(folder / "layer.msh", *layer())
