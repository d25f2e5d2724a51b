"""Tetrahedra inside a closed surface: made by the program gmsh (GPL, run as a program of its own), measured here."""
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from surface_mesh import balanced, remesh

FACES = [(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)]  # outwards, face i opposite node i
EDGES = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]


def read_msh(path):
    """Nodes and tetrahedra of a Gmsh 2.2 ASCII file; nodes of no tetrahedron are dropped."""
    lines = Path(path).read_text().splitlines()
    at = lines.index("$Nodes")
    count = int(lines[at + 1])
    rows = [line.split() for line in lines[at + 2:at + 2 + count]]
    number = {int(r[0]): i for i, r in enumerate(rows)}
    nodes = np.array([[float(c) for c in r[1:4]] for r in rows])
    at = lines.index("$Elements")
    tets = []
    for line in lines[at + 2:at + 2 + int(lines[at + 1])]:
        word = [int(w) for w in line.split()]
        if word[1] == 4:
            tets.append([number[w] for w in word[3 + word[2]:]])
    tets = np.array(tets)
    used = np.unique(tets)
    return nodes[used], np.searchsorted(used, tets)


def fill(v, faces):
    """Tetrahedra whose boundary is exactly that surface."""
    with tempfile.TemporaryDirectory() as folder:
        surface, volume, script = (Path(folder) / name for name in ("surface.msh", "volume.msh", "fill.geo"))
        rows = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(v))]
        rows += ["%d %.17g %.17g %.17g" % (i + 1, *p) for i, p in enumerate(v)]
        rows += ["$EndNodes", "$Elements", str(len(faces))]
        rows += ["%d 2 2 0 1 %d %d %d" % (i + 1, *(t + 1)) for i, t in enumerate(faces)]
        surface.write_text("\n".join(rows + ["$EndElements", ""]))
        script.write_text(f"""Merge "{surface}"; Surface Loop(1) = {{1}}; Volume(1) = {{1}};
            General.NumThreads = 1; Mesh.RandomSeed = 1; Mesh.Algorithm3D = 1;
            Mesh.Optimize = 1; Mesh.SaveAll = 1;\n""")  # without the line's end gmsh drops the last command
        run = subprocess.run(["gmsh", "-3", "-nt", "1", "-v", "5", "-format", "msh22", script, "-o", volume], capture_output=True, text=True)
        if run.returncode != 0 or not volume.exists():
            raise SystemExit("gmsh could not fill a surface: " + run.stdout + run.stderr)
        nodes, tets = read_msh(volume)
    flipped = volumes(nodes, tets) < 0.0
    tets[flipped] = tets[flipped][:, [0, 2, 1, 3]]
    return nodes, tets


def volumes(v, t):
    a, b, c, d = (v[t[:, k]] for k in range(4))
    return np.sum((b - a) * np.cross(c - a, d - a), axis=1) / 6.0


def quality(v, t):
    """sqrt(2) 6 V / l_rms^3, as in filasofia/geometry/tet_mesh.h: 1 regular, 0 flat."""
    squares = sum(np.sum((v[t[:, i]] - v[t[:, j]]) ** 2, axis=1) for i, j in EDGES) / 6.0
    return np.sqrt(2.0) * 6.0 * volumes(v, t) / squares ** 1.5


def dihedral_angles(v, t):
    """Six angles [degrees] per tetrahedron."""
    n = []
    for f in FACES:
        a, b, c = (v[t[:, k]] for k in f)
        x = np.cross(b - a, c - a)
        n.append(x / np.linalg.norm(x, axis=1)[:, None])
    return np.degrees(np.stack([np.arccos(np.clip(-np.sum(n[i] * n[j], axis=1), -1.0, 1.0)) for i, j in EDGES], axis=1))


def surface_of(t):
    """Boundary faces, outwards, in the order of the tetrahedra."""
    faces = np.stack([t[:, list(f)] for f in FACES], axis=1).reshape(-1, 3)
    _, where, count = np.unique(np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True)
    return faces[count[where.ravel()] == 1]


def to_count(f, v, faces, edge_length, wanted, tolerance, scale, worst, lowest=-np.inf):
    """Tetrahedra inside the zero surface of f, `wanted` of them within `tolerance`, none of a quality below `worst`.

    Wanted edge lengths are edge_length(points) times a factor; tries one near `scale` after the other, always the same.
    No node lies below y = lowest."""
    for turn in range(80):
        v, faces = remesh(f, v, faces, lambda p: scale * edge_length(p), 2 if turn else 8)
        even = balanced(f, v, faces)
        even[:, 1] = np.maximum(even[:, 1], lowest)
        nodes, tets = fill(np.round(even, 5), faces)
        nodes = np.round(nodes, 5)  # as it will be written: 10 nm
        if abs(len(tets) - wanted) <= tolerance * wanted and quality(nodes, tets).min() >= worst:
            return nodes, tets
        scale *= min(1.05, max(0.95, (len(tets) / wanted) ** 0.3)) * (1.0 + 0.004 * (turn % 3 - 1))
    raise SystemExit(f"no mesh of {wanted} tetrahedra with a quality of {worst} or more was found")
