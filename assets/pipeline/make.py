"""Makes the meshes of hysteroscopy, suturing and laparoscopy, and report.txt, again. See README.md."""
import argparse
import json
from pathlib import Path

import numpy as np

import instruments
import laparoscopy
import suturing
import uterus
from implicit import gradient, project
from output import metre, metres, write_json, write_msh, write_obj
from polyps import MYOMAS, POLYPS, ROOT
from surface_mesh import Patch, closed, edges_of, march, remesh, volume
from tet_mesh import dihedral_angles, quality, surface_of, to_count, volumes

HERE = Path(__file__).resolve().parent
SIZES = {1702: 1.055, 5000: 0.69, 12000: 0.485}  # tetrahedra and where the search for them starts
CLEAR = (0.35, 0.8)  # a polyp fits where all of it but that part of its height is further from the wall than so many mm
CLEAR_BROAD = (0.5, 0.5)  # the same of a myoma, whose foot is as broad as itself
FORNIX = 10.0  # [mm] up to here the outside of the cervix is lining, seen from the vagina; above it is serosa


class Report:
    """What was made, as text: a change of the assets is a change of this file."""

    def __init__(self):
        self.rows = ["Made by assets/pipeline/make.sh. Quality: 1 regular, 0 flat (geometry/tet_mesh.h). Angles are dihedral.", ""]

    def add(self, text):
        print(text, flush=True)
        self.rows.append(text)

    def tets(self, name, nodes, tets):
        q, a = quality(nodes, tets), dihedral_angles(nodes, tets)
        self.add(f"{name}: {len(tets)} tetrahedra, {len(nodes)} nodes, {volumes(nodes, tets).sum() / 1000.0:.3f} ml, "
                 f"quality {q.min():.2f} at least, {q.mean():.2f} mean, angles {a.min():.0f} to {a.max():.0f} degrees")

    def surface(self, name, v, faces):
        self.add(f"{name}: {len(faces)} triangles, {'closed' if closed(faces) else 'open'}")


def nearest_gap(points, v, faces, count=12):
    """Distance [mm] of each point to a surface: exact to the triangles around its nearest corners."""
    gaps = np.empty(len(points))
    around = [[] for _ in v]
    for i, t in enumerate(faces):
        for a in t:
            around[a].append(i)
    for i, p in enumerate(points):
        near = np.argpartition(np.sum((v - p) ** 2, axis=1), count)[:count]
        some = faces[sorted({k for a in near for k in around[a]})]
        gaps[i] = np.sqrt(squared_to_triangles(p, v[some]).min())
    return gaps


def squared_to_triangles(p, t):
    a, b, c = t[:, 0], t[:, 1], t[:, 2]
    n = np.cross(b - a, c - a)
    n = n / np.linalg.norm(n, axis=1)[:, None]
    inside = np.ones(len(t), bool)
    best = np.full(len(t), np.inf)
    for s, e in ((a, b), (b, c), (c, a)):
        w = np.clip(np.sum((p - s) * (e - s), axis=1) / np.sum((e - s) ** 2, axis=1), 0.0, 1.0)
        best = np.minimum(best, np.sum((s + w[:, None] * (e - s) - p) ** 2, axis=1))
        inside &= np.sum(np.cross(n, e - s) * (p - s), axis=1) >= 0.0
    return np.where(inside, np.sum((p - a) * n, axis=1) ** 2, best)


def split_at(f, v, faces, height):
    """The triangles divided along the plane y = height where the surface is the outside; the plane's points stay on f."""
    outside = uterus.mucosa(v) < 0.0
    edge = np.zeros(len(v))
    for a, b in edges_of(faces):
        length = np.linalg.norm(v[a] - v[b])
        edge[a], edge[b] = max(edge[a], length), max(edge[b], length)
    near = outside & (np.abs(v[:, 1] - height) < 0.3 * edge)
    v = v.copy()
    v[near] = onto_plane(f, v[near], height)
    patch = Patch(v, faces, np.ones(len(v)))
    start = len(v)
    for a, b in edges_of(faces).tolist():
        da, db = v[a][1] - height, v[b][1] - height
        if outside[a] and outside[b] and da * db < 0.0 and not (near[a] or near[b]):
            patch.split(a, b)
    v, faces = patch.arrays()
    v[start:] = onto_plane(f, v[start:], height)
    lining = (uterus.mucosa(v[faces].mean(axis=1)) > 0.0) | (v[faces][:, :, 1].mean(axis=1) < height)
    return v, faces, lining


def onto_plane(f, p, height):
    p = p.copy()
    for _ in range(6):
        p[:, 1] = height
        p = project(f, p, rounds=1)
    p[:, 1] = height
    return p


def part(v, faces, uv):
    used = np.unique(faces)
    return v[used], np.searchsorted(used, faces), uv[used]


def mirrored_uv(v, length):
    """u goes once around half the axis and back, so that there is no seam; v goes along it."""
    return np.column_stack([np.abs(np.arctan2(v[:, 0], v[:, 2])) / np.pi, v[:, 1] / length])


def make_uterus(folder, report):
    start = march(uterus.wall, (-32.0, -6.0, -24.0), (32.0, 80.0, 24.0), 1.25)
    start = remesh(uterus.wall, *start, lambda p: np.where(uterus.mucosa(p) > 0.0, 1.0, 1.8), 4)
    meshes = {}
    for wanted, scale in SIZES.items():
        nodes, tets = to_count(uterus.wall, *start, uterus.edge_length, wanted, 0.003 if wanted == 1702 else 0.005, scale, 0.2)
        name = f"uterus_{wanted}"
        write_msh(folder / f"{name}.msh", nodes, tets)
        report.tets(name, nodes, tets)
        meshes[name] = (nodes, tets)

    def fine(p):
        s = np.clip(0.5 + uterus.mucosa(p) / 6.0, 0.0, 1.0)
        lips = np.linalg.norm(p, axis=1)
        lining = np.minimum(0.6 + 0.03 * np.maximum(p[:, 1] - 24.0, 0.0), 0.8)  # the folds in the canal are 3.6 mm apart
        return np.minimum(2.0 + (lining - 2.0) * s, 0.75 + 0.12 * np.maximum(lips - 6.0, 0.0))

    f = uterus.wall_for_pictures
    v, faces = remesh(f, *start, fine, 6)
    v, faces, lining = split_at(f, v, faces, FORNIX)
    uv = mirrored_uv(v, uterus.LENGTH)
    write_obj(folder / "uterus.obj", v, faces, uv)
    report.surface("uterus.obj", v, faces)
    for name, pick in (("uterus_lining.obj", lining), ("uterus_serosa.obj", ~lining)):
        write_obj(folder / name, *part(v, faces[pick], uv))
        report.surface(name, v, faces[pick])
    gaps = {}
    for name, (nodes, tets) in meshes.items():
        gap = nearest_gap(v, nodes, surface_of(tets))
        hollow = uterus.mucosa(v) > 0.0
        gaps[name] = {"inside": float(metre(gap[hollow].max())), "outside": float(metre(gap[~hollow].max()))}
        report.add(f"uterus.obj to the surface of {name}: {gap[hollow].mean():.2f} mm mean and {gap[hollow].max():.2f} mm at most in the "
                   f"hollow, {gap[~hollow].mean():.2f} and {gap[~hollow].max():.2f} mm outside")
    write_json(folder / "uterus.json", landmarks(start, report) | {"meshes": canal(meshes, gaps, report)})


def half_axes(y):
    """How wide and how deep the hollow is there [mm], to each side of the axis; infinite outside the os."""
    half = []
    for k in (0, 2):
        along = np.zeros((3000, 3))
        along[:, 1], along[:, k] = y, np.arange(3000) * 0.01
        tissue = uterus.wall(along) < 0.0
        half.append(along[np.argmax(tissue), k] if tissue.any() else np.inf)
    return half


def across(p, n):
    """Where a polyp at p hangs over to: along the wall towards the os, on the fundus towards the middle."""
    way = np.array([0.0, -1.0, 0.0])
    if abs(n @ way) > 0.9:
        way = np.array([-1.0 if p[0] > 0.0 else 1.0, 0.0, 0.0])
    way = way - (way @ n) * n
    return way / np.linalg.norm(way)


def landmarks(start, report):
    def size(p):
        return np.where(uterus.mucosa(p) > 0.0, 2.0, 4.0)
    v, faces = remesh(uterus.wall, *start, size, 8)
    into = gradient(uterus.wall, v)
    into /= np.linalg.norm(into, axis=1)[:, None]
    ostia = np.minimum(*(np.linalg.norm(v - uterus.CORNU * [s, 1.0, 1.0], axis=1) for s in (1.0, -1.0)))
    sites = []
    cavity = (uterus.mucosa(v) > 0.0) & (v[:, 1] > 38.0) & (ostia > 5.0)
    for p, n in zip(v[cavity], into[cavity]):
        along = np.arange(1.0, 60.0, 0.1)
        wall = uterus.inner(p + along[:, None] * n) > 0.0
        free = along[np.argmax(wall)] if wall.any() else along[-1]  # else the ray leaves through the canal
        names = (("right", "left"), ("fundus", "fundus"), ("posterior", "anterior"))
        k = int(np.argmax(np.abs(n)))
        side = names[k][int(n[k] < 0.0)]
        sites.append({"at": metres(p), "normal": [round(float(c), 4) for c in n],
                      "across": [round(float(c), 4) for c in across(p, n)], "free": float(metre(free)), "wall": side})
    line = []
    for y in np.arange(-4.0, uterus.CAVITY_TOP - 1.0, 2.0):
        half = half_axes(y)
        if np.isfinite(half).all():
            line.append({"at": metres([0.0, y, 0.0]), "halfWidth": float(metre(half[0])), "halfDepth": float(metre(half[1]))})
    top = np.array([[0.0, y, 0.0] for y in np.arange(55.0, 70.0, 0.01)])
    fundus = top[np.argmax(uterus.inner(top) > 0.0)]
    report.add(f"uterus.json: {len(sites)} sites for polyps, {len(line)} points of the centreline, "
               f"fundus inside at {fundus[1]:.1f} mm")
    tube = np.array([2.6, 1.3, 0.0]) / np.linalg.norm([2.6, 1.3, 0.0])
    return {
        "unit": "m",
        "axes": "origin in the external os, +y to the fundus, +z anterior, +x to the patient's left",
        "externalOs": [0.0, 0.0, 0.0],
        "internalOs": metres([0.0, uterus.INTERNAL_OS, 0.0]),
        "internalOsHalfAxes": metres(half_axes(uterus.INTERNAL_OS)),
        "fundusInside": metres(fundus),
        "fundusOutside": metres([0.0, uterus.LENGTH, 0.0]),
        "ostia": [{"side": name, "at": metres(uterus.CORNU * [s, 1.0, 1.0]),
                   "into": [round(s * float(tube[0]), 4), round(float(tube[1]), 4), 0.0]} for name, s in (("left", 1.0), ("right", -1.0))],
        "centreline": line,
        "sites": sites,
    }


def canal(meshes, gaps, report):
    """How far the way of the scope is from the axis in the meshes as they are, and how many elements make the wall."""
    entries = []
    for name, (nodes, tets) in meshes.items():
        faces = surface_of(tets)
        free = [(np.sqrt(squared_to_triangles(np.array([0.0, y, 0.0]), nodes[faces]).min()), y) for y in np.arange(0.0, 56.0, 0.5)]
        narrow = [y for r, y in free if r < instruments.SCOPE_RADIUS]
        report.add(f"{name}: free radius around the axis at least {min(free)[0]:.2f} mm (at y = {min(free)[1]:.1f} mm); below the "
                   f"scope's {instruments.SCOPE_RADIUS} mm from y = {min(narrow):.1f} to {max(narrow):.1f} mm")
        edges = edges_of(np.concatenate([tets[:, [0, 1, 2]], tets[:, [0, 1, 3]], tets[:, [2, 3, 0]], tets[:, [2, 3, 1]]]))
        skin = np.zeros(len(nodes), bool)
        skin[np.unique(faces)] = True
        hollow = skin & (uterus.mucosa(nodes) > 0.0)
        away = np.where(skin & ~hollow, 0, 99)
        for _ in range(12):
            for k in (0, 1):
                np.minimum.at(away, edges[:, k], away[edges[:, 1 - k]] + 1)
        deep = away[hollow & (nodes[:, 1] > 6.0)]
        report.add(f"{name}: edges from the hollow to the outside, above the lips: {deep.min()} at least, {deep.mean():.1f} mean; "
                   f"one at {(deep == 1).sum()} of {len(deep)} nodes")
        entries.append({"name": name, "tetrahedra": len(tets), "freeRadius": float(metre(np.floor(min(free)[0] * 100.0) / 100.0)),
                        "narrowUpTo": float(metre(max(narrow) + 0.5)),
                        "gapInHollow": gaps[name]["inside"], "gapOutside": gaps[name]["outside"]})
    return entries


def fitting(v, sites, clear=CLEAR):
    """The sites at which a polyp with these vertices touches nothing but its own place."""
    head, found = v[v[:, 1] > clear[0] * v[:, 1].max()], []
    for i, site in enumerate(sites):
        n, x = np.array(site["normal"]), np.array(site["across"])
        placed = 1000.0 * np.array(site["at"]) + head @ np.stack([x, n, np.cross(x, n)])
        if uterus.inner(placed).max() < -clear[1]:
            found.append(i)
    return found


def make_polyps(folder, report):
    entries, sites = [], json.loads((folder / "uterus.json").read_text())["sites"]
    for name, (kind, f, edge, fine, wanted, foot) in POLYPS.items():
        start = march(f, (-9.0, -2.0, -9.0), (9.0, 23.0, 9.0), min(0.5, fine))
        v, faces = remesh(f, *start, lambda p: np.full(len(p), fine), 5)
        def edge_length(p):  # a stalk needs edges shorter than its radius
            thin = min(edge, 0.85 * foot)
            return thin + (edge - thin) * np.clip((p[:, 1] / v[:, 1].max() - 0.3) / 0.3, 0.0, 1.0)
        nodes, tets = to_count(f, v, faces, edge_length, wanted, 0.06, 1.0, 0.2, -ROOT)
        base = np.flatnonzero(nodes[:, 1] <= 0.0)
        write_msh(folder / f"{name}.msh", nodes, tets)
        write_obj(folder / f"{name}.obj", v, faces, mirrored_uv(v - [0.0, -ROOT, 0.0], v[:, 1].max() + ROOT))
        report.tets(name, nodes, tets)
        report.surface(f"{name}.obj", v, faces)
        gap = nearest_gap(v, nodes, surface_of(tets)).max()
        fit = fitting(v, sites)
        report.add(f"{name}: base of {len(base)} nodes; picture at most {gap:.2f} mm off the tetrahedra; fits at {len(fit)} sites")
        entries.append({"name": name, "kind": kind, "height": float(metre(v[:, 1].max())), "width": float(metre(np.ptp(v[:, 0]))),
                        "footRadius": float(metre(foot)), "volume": float("%.4g" % (volume(v, faces) * 1e-9)),
                        "gapOfPicture": float(metre(gap)), "base": base.tolist(), "sites": fit})
    write_json(folder / "polyps.json", {
        "unit": "m", "axes": "origin in the wall's surface, +y out of the wall; the root goes down to y = -0.001",
        "root": float(metre(ROOT)), "polyps": entries})


def make_myomas(folder, report):
    """Bodies for a loop, and the places on the front and the back of the cavity where a straight one comes along them."""
    entries, sites = [], json.loads((folder / "uterus.json").read_text())["sites"]
    for name, (f, edge, wanted) in MYOMAS.items():
        start = march(f, (-9.0, -2.0, -9.0), (9.0, 9.0, 9.0), 0.5)
        v, faces = remesh(f, *start, lambda p: np.full(len(p), 0.5), 5)
        nodes, tets = to_count(f, v, faces, lambda p: np.full(len(p), edge), wanted, 0.05, 1.0, 0.2, -ROOT)
        base = np.flatnonzero(nodes[:, 1] <= 0.0)
        write_msh(folder / f"{name}.msh", nodes, tets)
        report.tets(name, nodes, tets)
        fit = [i for i in fitting(v, sites, CLEAR_BROAD) if abs(sites[i]["normal"][2]) > 0.98 and 0.046 < sites[i]["at"][1] < 0.0515]
        report.add(f"{name}: base of {len(base)} nodes; fits at {len(fit)} sites")
        entries.append({"name": name, "height": float(metre(nodes[:, 1].max())), "width": float(metre(np.ptp(nodes[:, 0]))),
                        "volume": float("%.4g" % (volumes(nodes, tets).sum() * 1e-9)), "base": base.tolist(), "sites": fit})
    write_json(folder / "myomas.json", {
        "unit": "m", "axes": "origin in the wall's surface, +y out of the wall; the root goes down to y = -0.001",
        "root": float(metre(ROOT)), "myomas": entries})


# Each part: its name, its folder, what makes it.
PARTS = (("uterus", "hysteroscopy", make_uterus), ("polyps", "hysteroscopy", make_polyps),
         ("myomas", "hysteroscopy", make_myomas),
         ("instruments", "hysteroscopy", instruments.make), ("suturing", "suturing", suturing.make), ("laparoscopy", "laparoscopy", laparoscopy.make))


def main():
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--into", type=Path, default=HERE.parent / "meshes", help="folder with those of the meshes")
    words.add_argument("--only", choices=[name for name, _, _ in PARTS], help="make only these, and no report")
    given = words.parse_args()
    report = Report()
    for name, folder, make in PARTS:
        if given.only in (None, name):
            (given.into / folder).mkdir(parents=True, exist_ok=True)
            make(given.into / folder, report)
    if given.only is None:
        (HERE / "report.txt").write_text("\n".join(report.rows + [""]))


if __name__ == "__main__":
    main()
