"""The instruments: closed surfaces cut out of solids by the program gmsh (its OpenCASCADE kernel), and coarse ones for
collision. Millimetres; every instrument points along -z as a camera looks, its shaft lies at +z, +y is up.

The hysteroscope's origin is on its axis, level with its foremost point. The tools' origin is on their axis, in the pivot
of the jaws; the pivot is the x axis. Jaws are modelled closed; a turn about +x opens the upper one (y > 0), a turn about
-x the lower one. Sizes: README.md beside this file."""
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from output import metre, metres, write_json, write_obj
from surface_mesh import volume

SCOPE_RADIUS = 2.5    # [mm] of the outer sheath
SCOPE_LENGTH = 185.0  # [mm] of the sheath
BEVEL = np.radians(30.0)
OPTIC = (0.97, 1.40)     # [mm] height of the lens above the axis, and its radius
CHANNEL = (-1.50, 0.90)  # [mm] the same of the working channel: 1.8 mm wide, for tools of 5 Fr
TOOL_RADIUS = 0.83    # [mm] 5 Fr
TOOL_LENGTH = 340.0   # [mm]
PIVOT_BEHIND = 12.0   # [mm] up to here the tool's end is cut out of solids; from there it is a plain rod

BEVEL_BOX = "Rotate {{1, 0, 0}, {0, %g, 0}, -Pi / 6} { Volume{%d}; }"

SHEATH = f"""
Cylinder(1) = {{0, 0, -1, 0, 0, {PIVOT_BEHIND + 1}, {SCOPE_RADIUS}}};
Box(2) = {{-10, -10, -20, 20, 20, 20}};
{BEVEL_BOX % (SCOPE_RADIUS, 2)}
Cylinder(3) = {{0, {CHANNEL[0]}, -2, 0, 0, 11, {CHANNEL[1]}}};
BooleanDifference(4) = {{ Volume{{1}}; Delete; }} {{ Volume{{2, 3}}; Delete; }};
"""

OPTIC_GLASS = f"""
Cylinder(1) = {{0, {OPTIC[0]}, -1, 0, 0, 5, {OPTIC[1]}}};
Box(2) = {{-10, -10, -20, 20, 20, 19.95}};
{BEVEL_BOX % (SCOPE_RADIUS, 2)}
BooleanDifference(3) = {{ Volume{{1}}; Delete; }} {{ Volume{{2}}; Delete; }};
"""

TOOL_END = f"""
Cylinder(1) = {{0, 0, -0.75, 0, 0, {PIVOT_BEHIND + 0.75}, {TOOL_RADIUS}}};
Box(2) = {{-0.42, -2, -2, 0.84, 4, 4.6}};
Cylinder(3) = {{-2, 0, 0, 4, 0, 0, 0.78}};
Box(4) = {{-2, -2, 0, 4, 4, {PIVOT_BEHIND}}};
BooleanUnion(5) = {{ Volume{{3}}; Delete; }} {{ Volume{{4}}; Delete; }};
BooleanIntersection(6) = {{ Volume{{1}}; Delete; }} {{ Volume{{5}}; Delete; }};
BooleanDifference(7) = {{ Volume{{6}}; Delete; }} {{ Volume{{2}}; Delete; }};
Cylinder(8) = {{-0.82, 0, 0, 1.64, 0, 0, 0.24}};
BooleanUnion(9) = {{ Volume{{7}}; Delete; }} {{ Volume{{8}}; Delete; }};
"""

# A jaw: a half rod with a tang beside the middle plane, in which the pin sits. `body` makes Volume 1.
JAW = """
{body}
Box(20) = {{-2, -2, -20, 4, 2, 40}};
Box(21) = {{-2, -2, -1.15, 4, 4, 10}};
BooleanDifference(22) = {{ Volume{{1}}; Delete; }} {{ Volume{{20, 21}}; Delete; }};
Box(23) = {{0.03, 0, -1.3, 0.34, 0.58, 1.3}};
Cylinder(24) = {{0.03, 0, 0, 0.34, 0, 0, 0.58}};
BooleanUnion(25) = {{ Volume{{22}}; Delete; }} {{ Volume{{23, 24}}; Delete; }};
{teeth}
"""


def teeth(first, last, pitch, depth):
    """Grooves across the face of a jaw (y = 0), between two places on z."""
    rows, count = [], int(round((first - last) / pitch))
    for i in range(count):
        z = first - i * pitch
        n = 100 + 10 * i
        rows.append(f"Point({n}) = {{-2, -0.01, {z}}}; Point({n + 1}) = {{-2, -0.01, {z - pitch}}}; "
                    f"Point({n + 2}) = {{-2, {depth}, {z - 0.5 * pitch}}}; "
                    f"Line({n}) = {{{n}, {n + 1}}}; Line({n + 1}) = {{{n + 1}, {n + 2}}}; "
                    f"Line({n + 2}) = {{{n + 2}, {n}}}; Curve Loop({n}) = {{{n}, {n + 1}, {n + 2}}}; Plane Surface({n}) = {{{n}}}; "
                    f"groove{i}() = Extrude {{4, 0, 0}} {{ Surface{{{n}}}; }};")
    volumes = ", ".join(f"groove{i}(1)" for i in range(count))
    return "\n".join(rows) + f"\nBooleanDifference(90) = {{ Volume{{25}}; Delete; }} {{ Volume{{{volumes}}}; Delete; }};"


# Biopsy forceps: two cups with a toothed rim.
CUP = JAW.format(body="""
Cylinder(10) = {0, 0, 1, 0, 0, -4.6, 0.83};
Sphere(11) = {0, 0, -3.6, 0.83};
Dilate {{0, 0, -3.6}, {1, 1, 1.15}} { Volume{11}; }
BooleanUnion(12) = { Volume{10}; Delete; } { Volume{11}; Delete; };
Sphere(13) = {0, 0, -2.9, 0.58};
Dilate {{0, 0, -2.9}, {1, 1, 2.1}} { Volume{13}; }
BooleanDifference(1) = { Volume{12}; Delete; } { Volume{13}; Delete; };
""", teeth=teeth(-1.7, -4.2, 0.5, 0.2))

# Grasper: long slender jaws with teeth over their whole length.
ALLIGATOR = JAW.format(body="""
Cone(10) = {0, 0, -0.9, 0, 0, -5.7, 0.83, 0.5};
Sphere(11) = {0, 0, -6.6, 0.5};
BooleanUnion(1) = { Volume{10}; Delete; } { Volume{11}; Delete; };
""", teeth=teeth(-1.5, -6.6, 0.51, 0.2))

# Scissors: a blade lies beside the middle plane, its edge is where x = 0 meets y = 0.
BLADE = """
Point(1) = {0, -0.06, -1.0}; Point(2) = {0, -0.06, -6.4}; Point(3) = {0, 0.1, -6.7}; Point(4) = {0, 0.5, -5.2};
Point(5) = {0, 0.72, -3.0}; Point(6) = {0, 0.72, -1.0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Spline(3) = {3, 4, 5, 6}; Line(4) = {6, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
blade() = Extrude {0.36, 0, 0} { Surface{1}; };
Box(20) = {0.0, -0.06, -1.3, 0.36, 0.62, 1.3};
Cylinder(21) = {0.0, 0, 0, 0.36, 0, 0, 0.58};
BooleanUnion(30) = { Volume{blade(1)}; Delete; } { Volume{20, 21}; Delete; };
Point(40) = {0.05, -0.07, -8}; Point(41) = {0.4, -0.07, -8}; Point(42) = {0.4, 0.23, -8};
Line(40) = {40, 41}; Line(41) = {41, 42}; Line(42) = {42, 40}; Curve Loop(40) = {40, 41, 42}; Plane Surface(40) = {40};
ground() = Extrude {0, 0, 6.7} { Surface{40}; };
BooleanDifference(50) = { Volume{30}; Delete; } { Volume{ground(1)}; Delete; };
"""
BLADE_EDGE = ((0.0, -0.06, -1.0), (0.0, -0.06, -6.4))


def solid(script, largest, around=20):
    """The closed surface of what a script leaves: vertices and triangles, outwards."""
    with tempfile.TemporaryDirectory() as folder:
        source, result = Path(folder) / "solid.geo", Path(folder) / "solid.msh"
        source.write_text(f"""SetFactory("OpenCASCADE");\n{script}
            Mesh.MeshSizeFromCurvature = {around}; Mesh.MeshSizeMax = {largest}; Mesh.MeshSizeMin = {largest / 12};
            Mesh.Algorithm = 6; Mesh.RandomSeed = 1; Mesh.SaveAll = 1;\n""")
        run = subprocess.run(["gmsh", "-2", "-nt", "1", "-format", "msh22", source, "-o", result], capture_output=True, text=True)
        if run.returncode != 0 or "Error" in run.stdout + run.stderr:
            raise SystemExit("gmsh could not make a solid:\n" + script + run.stdout[-3000:] + run.stderr)
        lines = result.read_text().splitlines()
    at = lines.index("$Nodes")
    nodes = np.array([[float(c) for c in line.split()[1:4]] for line in lines[at + 2:at + 2 + int(lines[at + 1])]])
    at = lines.index("$Elements")
    rows = [[int(w) for w in line.split()] for line in lines[at + 2:at + 2 + int(lines[at + 1])]]
    faces = np.array([r[3 + r[2]:] for r in rows if r[1] == 2]) - 1
    # Two corners at one place, to the 10 nm that will be written, are one corner.
    places, where = np.unique(np.round(nodes, 5), axis=0, return_inverse=True)
    faces = where.ravel()[faces]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    used = np.unique(faces)
    return oriented(places[used], np.searchsorted(used, faces))


def oriented(v, faces):
    """Neighbours walk their edge in opposite directions, every piece has a positive volume."""
    beside = {}
    for i, t in enumerate(faces.tolist()):
        for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0])):
            beside.setdefault((min(a, b), max(a, b)), []).append((i, a < b))
    if any(len(x) != 2 for x in beside.values()):
        raise SystemExit("a solid's surface is not closed")
    links = [[] for _ in faces]
    for (i, up), (j, also) in beside.values():
        links[i].append((j, up == also))
        links[j].append((i, up == also))
    turn = np.full(len(faces), -1)
    for seed in range(len(faces)):
        if turn[seed] >= 0:
            continue
        turn[seed], piece, todo = 0, [seed], [seed]
        while todo:
            i = todo.pop()
            for j, same in links[i]:
                if turn[j] < 0:
                    turn[j] = turn[i] ^ int(same)
                    piece.append(j)
                    todo.append(j)
        sides = faces[piece].copy()
        flip = turn[piece] == 1
        sides[flip] = sides[flip][:, ::-1]
        if volume(v, sides) < 0.0:
            turn[piece] ^= 1
    faces = faces.copy()
    faces[turn == 1] = faces[turn == 1][:, ::-1]
    return v, faces


def lengthened(v, faces, z, end):
    """The flat end at z, which all of `v` lies before, drawn out to `end`: a ring of long quads and a new end."""
    flat = (np.abs(v[faces][:, :, 2] - z) < 1e-6).all(axis=1)
    cap = faces[flat].tolist()
    there = {(t[k], t[(k + 1) % 3]) for t in cap for k in range(3)}
    rim = {a: b for a, b in there if (b, a) not in there}
    loop = [min(rim)]
    while rim[loop[-1]] != loop[0]:
        loop.append(rim[loop[-1]])
    ring, n = v[loop], len(loop)
    # The last ring stands close before the end, so that the light on the rod does not bend towards its flat end.
    stations = [end - 0.05, end]
    first = len(v)
    rings = [np.array(loop)] + [first + n * k + np.arange(n) for k in range(len(stations))]
    more = [np.column_stack([ring[:, :2], np.full(n, s)]) for s in stations]
    middle = first + n * len(stations)
    v = np.concatenate([v, *more, [[0.0, 0.0, end]]])
    out = [faces[~flat]]
    for low, high in zip(rings[:-1], rings[1:]):
        a, b, c, d = low, np.roll(low, -1), np.roll(high, -1), high
        out += [np.column_stack([a, b, c]), np.column_stack([a, c, d])]
    out.append(np.column_stack([rings[-1], np.roll(rings[-1], -1), np.full(n, middle)]))
    faces = np.concatenate(out)
    used = np.unique(faces)
    return v[used], np.searchsorted(used, faces)


def lathe(profile, around=24, bevel=0.3):
    """A body of revolution about z from (z, radius) pairs, its edges taken off by `bevel`."""
    points = []
    for i, p in enumerate(profile):
        p = np.array(p, float)
        if 0 < i < len(profile) - 1:
            for other in (profile[i - 1], profile[i + 1]):
                way = np.array(other, float) - p
                points.append(p + way * min(0.4, bevel / np.linalg.norm(way)))
        else:
            points.append(p)
    angle = 2.0 * np.pi * np.arange(around) / around
    v = [[0.0, 0.0, points[0][0]]]
    for z, r in points[1:-1]:
        v += [[r * np.cos(a), r * np.sin(a), z] for a in angle]
    v.append([0.0, 0.0, points[-1][0]])
    last, faces = len(v) - 1, []
    for k in range(around):
        l = (k + 1) % around
        faces.append([0, 1 + l, 1 + k])
        for ring in range(len(points) - 3):
            a, b = 1 + ring * around, 1 + (ring + 1) * around
            faces += [[a + k, a + l, b + l], [a + k, b + l, b + k]]
        a = 1 + (len(points) - 3) * around
        faces.append([a + k, a + l, last])
    return oriented(np.array(v), np.array(faces))


def loft(sections):
    """A closed body through polygons with as many corners each; its ends are fans about their first corner."""
    n, v = len(sections[0]), np.concatenate([np.array(s, float) for s in sections])
    faces = []
    for s in range(len(sections) - 1):
        for k in range(n):
            a, b, c, d = s * n + k, s * n + (k + 1) % n, (s + 1) * n + (k + 1) % n, (s + 1) * n + k
            faces += [[a, b, c], [a, c, d]]
    for s in (0, (len(sections) - 1) * n):
        faces += [[s, s + k, s + k + 1] for k in range(1, n - 1)]
    return oriented(v, np.array(faces))


def together(parts):
    v, faces, count = [], [], 0
    for a, f in parts:
        v.append(a)
        faces.append(f + count)
        count += len(a)
    return np.concatenate(v), np.concatenate(faces)


def turned(mesh, axis, angle, shift=(0.0, 0.0, 0.0)):
    v, faces = mesh
    k, c, s = np.asarray(axis, float), np.cos(angle), np.sin(angle)
    v = v * c + np.cross(k, v) * s + np.outer(v @ k, k) * (1.0 - c)
    return v + np.asarray(shift, float), faces


def bevel_height(y):
    """Where the bevelled face lies on z."""
    return (SCOPE_RADIUS - y) * np.tan(BEVEL)


def handle():
    """Bridge, light post, two taps and eyepiece: what is seen from outside only."""
    body = lathe([(183, 0), (183, 3.4), (190, 3.4), (196, 7.0), (232, 7.0), (238, 5.0), (262, 5.0), (270, 9.0), (276, 16.0),
                  (281, 16.0), (281, 0)], 32)
    post = turned(lathe([(0, 0), (0, 3.2), (22, 3.2), (22, 4.6), (30, 4.6), (30, 0)], 20), (1, 0, 0), -np.radians(90.0), (0, 4, 248))
    inlet = turned(lathe([(0, 0), (0, 2.4), (20, 2.4), (20, 3.4), (26, 3.4), (26, 0)], 20), (0, 1, 0), np.radians(60.0), (3, 0, 206))
    outlet = turned(lathe([(0, 0), (0, 2.4), (20, 2.4), (20, 3.4), (26, 3.4), (26, 0)], 20), (0, 1, 0), -np.radians(60.0), (-3, 0, 206))
    channel = turned(lathe([(0, 0), (0, 2.6), (26, 2.6), (26, 4.0), (31, 4.0), (31, 0)], 20), (1, 0, 0), np.radians(35.0), (0, -3, 212))
    return together([body, post, inlet, outlet, channel])


def scope_collision(around=16):
    """The sheath as a prism with the bevel, its rim taken off."""
    angle = 2.0 * np.pi * (np.arange(around) + 0.5) / around
    x, y = np.cos(angle), np.sin(angle)
    sections = []
    for r, behind in ((2.1, 0.0), (SCOPE_RADIUS, 0.35)):
        sections.append(np.column_stack([r * x, r * y, bevel_height(r * y) + behind]))
    for z in (8.0, 60.0, SCOPE_LENGTH):
        sections.append(np.column_stack([SCOPE_RADIUS * x, SCOPE_RADIUS * y, np.full(around, z)]))
    return loft(sections)


def half_rod(stations):
    """The upper half of a rod: flat below at y = 0, radius by place."""
    angle = np.pi * np.arange(5) / 4.0
    return loft([np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(5, z)]) for z, r in stations])


def shaft_collision(around=8):
    angle = 2.0 * np.pi * np.arange(around) / around
    return loft([np.column_stack([TOOL_RADIUS * np.cos(angle), TOOL_RADIUS * np.sin(angle), np.full(around, z)])
                 for z in (-0.5, 4.0, 20.0, 80.0, TOOL_LENGTH)])


BLADE_FOR_COLLISION = loft([[(0, -0.06, z), (0.36, -0.06, z), (0.36, h, z), (0, h, z)]
                            for z, h in ((0.4, 0.4), (-1.0, 0.72), (-3.0, 0.72), (-5.2, 0.5), (-6.6, 0.06))])


@dataclass
class Mouth:
    """Two jaws or blades, in the size of the tools of 5 Fr; `size` makes larger ones of their vertices."""
    name: str
    script: str                  # of the upper one; the lower one is the same, turned about the shaft
    coarse: tuple                # the same for collision
    reach: float                 # [mm] from the pivot to the tip
    opening: float               # [degrees]
    edge: tuple = ()             # the two ends of a blade's cutting edge
    size: Callable = lambda vertices: vertices
    shape: Callable = lambda vertices: vertices  # what then becomes of the vertices of both


def mouth(save, shaft, made):
    """Writes both jaws, and returns what instruments.json says of the tool."""
    def sized(mesh):
        return made.size(mesh[0]), mesh[1]

    def placed(mesh, half_turn):
        vertices, faces = turned(mesh, (0, 0, 1), half_turn)
        return made.shape(vertices), faces

    word, (upper, coarse) = "blade" if made.edge else "jaw", (sized(solid(made.script, 0.26, 16)), sized(made.coarse))
    reach = -made.size(np.array([[0.0, 0.0, -made.reach]]))[0, 2]
    tool = {"name": made.name, **shaft, "reach": float(metre(reach)), "pivot": [0.0, 0.0, 0.0], "jaws": []}
    for side, half_turn, sign in (("upper", 0.0, 1.0), ("lower", np.pi, -1.0)):
        file = f"{made.name.replace(' ', '_')}_{word}_{side}"
        jaw = {"name": side,
               "surface": save(f"{file}.obj", placed(upper, half_turn), f"{side} {word} of the {made.name}, closed"),
               "collision": save(f"{file}_collision.obj", placed(coarse, half_turn), f"that {word} for collision"),
               "axis": [sign, 0.0, 0.0], "opensBy": round(float(np.radians(made.opening)), 4)}
        if made.edge:
            jaw["edge"] = [metres(turned((made.size(np.array([p])), None), (0, 0, 1), half_turn)[0]) for p in made.edge]
        tool["jaws"].append(jaw)
    return tool


def writer(folder, report):
    def save(name, mesh, note):
        write_obj(folder / name, *mesh, note=note)
        report.surface(name, *mesh)
        return name
    return save


def make(folder, report):
    save = writer(folder, report)
    sheath = lengthened(*solid(SHEATH, 0.6, 24), PIVOT_BEHIND, SCOPE_LENGTH)
    save("hysteroscope_sheath.obj", sheath, "outer sheath of the hysteroscope")
    save("hysteroscope_optic.obj", solid(OPTIC_GLASS, 0.4, 24), "its lens")
    save("hysteroscope_handle.obj", handle(), "its handle")
    save("hysteroscope_collision.obj", scope_collision(), "sheath for collision")
    end = lengthened(*solid(TOOL_END, 0.35, 18), PIVOT_BEHIND, TOOL_LENGTH)
    save("tool_shaft.obj", end, "shaft of forceps, grasper and scissors")
    save("tool_shaft_collision.obj", shaft_collision(), "that shaft for collision")

    shaft = {"shaft": "tool_shaft.obj", "shaftCollision": "tool_shaft_collision.obj", "radius": float(metre(TOOL_RADIUS)),
             "length": float(metre(TOOL_LENGTH))}
    tools = [mouth(save, shaft, Mouth(*each)) for each in (
        ("forceps", CUP, half_rod([(-0.6, 0.6), (-1.2, 0.83), (-3.6, 0.83), (-4.3, 0.6), (-4.52, 0.25)]), 4.55, 45.0),
        ("grasper", ALLIGATOR, half_rod([(-0.6, 0.6), (-1.2, 0.8), (-4.0, 0.65), (-6.6, 0.5), (-7.05, 0.2)]), 7.1, 40.0),
        ("scissors", BLADE, BLADE_FOR_COLLISION, 6.7, 35.0, BLADE_EDGE))]

    look = [0.0, round(float(-np.sin(BEVEL)), 6), round(float(-np.cos(BEVEL)), 6)]
    write_json(folder / "instruments.json", {
        "unit": "m",
        "axes": "every instrument points along -z, its shaft lies at +z, +y is up",
        "hysteroscope": {
            "origin": "on the axis, level with the foremost point",
            "surfaces": ["hysteroscope_sheath.obj", "hysteroscope_optic.obj", "hysteroscope_handle.obj"],
            "collision": "hysteroscope_collision.obj", "radius": float(metre(SCOPE_RADIUS)), "length": float(metre(SCOPE_LENGTH)),
            "lens": metres([0.0, OPTIC[0], bevel_height(OPTIC[0])]), "lensRadius": float(metre(OPTIC[1])), "look": look,
            "channelExit": metres([0.0, CHANNEL[0], bevel_height(CHANNEL[0])]), "channelDirection": [0.0, 0.0, -1.0],
            "channelRadius": float(metre(CHANNEL[1]))},
        "tools": tools,
    })
