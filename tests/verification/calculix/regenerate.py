#!/usr/bin/env python3
"""Write the decks beside this file and run CalculiX on them: NAME.inp -> NAME.csv. Usage: regenerate.py [ccx]"""
import itertools, math, subprocess, sys, tempfile
from pathlib import Path

HERE = Path(__file__).parent


def box(n, size):
    """n[0] x n[1] x n[2] cells of six tetrahedra (Kuhn 1960): nodes, and tetrahedra of positive volume with indices from 0."""
    nodes = [[size[a] * p[a] / n[a] for a in range(3)] for p in itertools.product(*(range(c + 1) for c in n))]
    index = lambda p: (p[0] * (n[1] + 1) + p[1]) * (n[2] + 1) + p[2]
    tetrahedra = []
    for cell in itertools.product(*(range(c) for c in n)):
        for axes in itertools.permutations(range(3)):
            corner, t = list(cell), [index(cell)]
            for axis in axes:
                corner[axis] += 1
                t.append(index(corner))
            tetrahedra.append(t)
    return nodes, [upright(nodes, t) for t in tetrahedra]


def ball(n, radius):
    """A cube of n^3 cells mapped to a ball: every cube around the centre becomes a sphere."""
    nodes, tetrahedra = box([n] * 3, [2.0] * 3)
    for i, p in enumerate(nodes):
        p = [x - 1.0 for x in p]
        stretch = radius * max(map(abs, p)) / (math.hypot(*p) or 1.0)
        nodes[i] = [stretch * x for x in p]
    return nodes, [upright(nodes, t) for t in tetrahedra]


def volume(nodes, t):
    a, b, c = ([nodes[i][k] - nodes[t[0]][k] for k in range(3)] for i in t[1:])
    return sum(a[k] * (b[k - 2] * c[k - 1] - b[k - 1] * c[k - 2]) for k in range(3)) / 6.0


def upright(nodes, t):
    return t if volume(nodes, t) > 0.0 else [t[0], t[1], t[3], t[2]]


def outer_faces(tetrahedra, wanted):
    """(element, CalculiX's number of the face) for the faces that belong to one element only and have only wanted nodes."""
    faces = {}
    for e, t in enumerate(tetrahedra):
        for number, corners in enumerate(((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)), 1):
            faces.setdefault(tuple(sorted(t[c] for c in corners)), []).append((e, number))
    return [on[0] for face, on in faces.items() if len(on) == 1 and all(map(wanted, face))]


def deck(title, mesh, material, held, density=None, dload=(), cload=(), nonlinear=False):
    nodes, tetrahedra = mesh
    worst = min(volume(nodes, t) / max(math.dist(nodes[i], nodes[j]) for i in t for j in t) ** 3 for t in tetrahedra)
    assert worst > 1e-3, f"{title}: an element is too flat: {worst}"
    lines = ["*HEADING", title, "*NODE, NSET=Nall"]
    lines += ["%d, %.13g, %.13g, %.13g" % (i, *p) for i, p in enumerate(nodes, 1)]
    lines += ["*ELEMENT, TYPE=C3D4, ELSET=Eall"]
    lines += ["%d, %d, %d, %d, %d" % (e, *(i + 1 for i in t)) for e, t in enumerate(tetrahedra, 1)]
    lines += ["*MATERIAL, NAME=tissue", *material]
    lines += ["*DENSITY", f"{density}"] if density else []
    lines += ["*SOLID SECTION, ELSET=Eall, MATERIAL=tissue"]
    lines += ["*BOUNDARY"] + [f"{i}, 1, 3" for i, p in enumerate(nodes, 1) if held(p)]
    if nonlinear:  # ten increments, each converged to the last printed digit; the fifth and the tenth are printed
        lines += ["*STEP, NLGEOM", "*STATIC, DIRECT", "0.1, 1.", "*CONTROLS, PARAMETERS=FIELD", "1e-8, 1e-8"]
    else:
        lines += ["*STEP", "*STATIC"]
    lines += ["*DLOAD", *dload] if dload else []
    lines += ["*CLOAD", *cload] if cload else []
    return "\n".join(lines + ["*NODE PRINT, NSET=Nall, FREQUENCY=5", "U", "*END STEP"]) + "\n"


def elastic(young, poisson):
    return ["*ELASTIC", f"{young}, {poisson}"]


def sagging_beam():
    """Clamped at x = 0, under oblique gravity, so that no component is zero."""
    mesh = box((16, 4, 3), (1.0, 0.25, 0.2))
    down = (0.48, -0.64, 0.6)
    return deck("clamped beam under its weight", mesh, elastic(1e10, 0.3), lambda p: p[0] == 0.0, density=1000.0,
                dload=["Eall, GRAV, 10., %g, %g, %g" % down])


def pressed_ball():
    """A ball with a rigid core: all nodes within a third of the radius are fixed, and pressure acts on the outer surface."""
    mesh = ball(6, 0.03)
    outside = lambda i: math.hypot(*mesh[0][i]) > 0.0299
    faces = outer_faces(mesh[1], outside)
    return deck("ball around a rigid core under pressure", mesh, elastic(1e4, 0.45), lambda p: math.hypot(*p) < 0.0101,
                dload=[f"{e + 1}, P{number}, 1." for e, number in faces])


def bent_beam():
    """A slender beam clamped at x = 0, its end pushed sideways by a quarter of its length: large rotation, small strain."""
    mesh = box((50, 2, 2), (1.0, 0.04, 0.04))
    end = [i for i, p in enumerate(mesh[0], 1) if p[0] == 1.0]
    return deck("slender beam under an end load", mesh, elastic(1e6, 0.3), lambda p: p[0] == 0.0, nonlinear=True,
                cload=[f"{i}, 2, {-0.3 / len(end):.13g}" for i in end])  # 0.3 N in total


SHEAR, BULK = 1e4, 1.4e5 / 3  # Pa: Poisson's ratio 0.4


def pulled_block(law, *constants):
    """A block clamped at x = 0, its end pulled along and across: strains of a half. The last constant is D1 = 2 / K."""
    mesh = box((10, 4, 4), (0.1, 0.04, 0.04))
    end = [i for i, p in enumerate(mesh[0], 1) if p[0] == 0.1]
    material = [f"*HYPERELASTIC, {law}", ", ".join("%.13g" % c for c in (*constants, 2.0 / BULK))]
    return deck(f"block pulled and bent, {law}", mesh, material, lambda p: p[0] == 0.0, nonlinear=True,
                cload=[f"{i}, {axis}, {force / len(end):.13g}" for i in end for axis, force in ((1, 12.0), (2, -4.0))])


def neo_hooke_block():
    return pulled_block("NEO HOOKE", SHEAR / 2)


def mooney_rivlin_block():
    return pulled_block("MOONEY-RIVLIN", 0.35 * SHEAR, 0.15 * SHEAR)


def ogden_block():
    return pulled_block("OGDEN, N=1", SHEAR, 4.0)


def run(ccx, name, text):
    (HERE / f"{name}.inp").write_text(text)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "deck.inp").write_text(text)
        log = subprocess.run([ccx, "deck"], cwd=folder, capture_output=True, text=True).stdout
        rows = [line.split() for line in (Path(folder) / "deck.dat").read_text().splitlines()]
    rows = [row for row in rows if len(row) == 4 and row[0].isdigit()]
    count = text[:text.index("*ELEMENT")].count("\n") - 3
    tables = ["half_" + name, name] if "NLGEOM" in text else [name]
    if len(rows) != count * len(tables) or "*ERROR" in log:
        sys.exit(f"{name}: CalculiX gave {len(rows)} rows for {count} nodes\n{log}")
    for i, table in enumerate(tables):
        of_one = rows[i * count:(i + 1) * count]
        (HERE / f"{table}.csv").write_text("\n".join(["node,ux,uy,uz"] + [",".join(row) for row in of_one]) + "\n")
        print(table, "largest displacement", max(math.hypot(*map(float, row[1:])) for row in of_one), "m")


for make in (sagging_beam, pressed_ball, bent_beam, neo_hooke_block, mooney_rivlin_block, ogden_block):
    run(sys.argv[1] if len(sys.argv) > 1 else "ccx", make.__name__, make())
