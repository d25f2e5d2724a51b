#!/usr/bin/env python3
"""Draw the JSON of `filasofia bench bunny --engine NAME --json FILE` as an SVG: cost of a step against its error, one colour per
mesh, one mark per engine and solver, both axes logarithmic. Usage: plot_engines.py FILE.json OUT.svg"""
import json
import math
import sys

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 860, 480, 70, 210, 40, 50
COLOURS = ["#e08020", "#53b0e8", "#1b3f94", "#7a2a7a", "#2a7a4a"]
COSTS, ERRORS = (-2, 2), (-7, -2)  # decades of ms, and of the error


def x(cost):
    return LEFT + (math.log10(cost) - COSTS[0]) / (COSTS[1] - COSTS[0]) * (WIDTH - LEFT - RIGHT)


def y(error):
    return TOP + (ERRORS[1] - math.log10(error)) / (ERRORS[1] - ERRORS[0]) * (HEIGHT - TOP - BOTTOM)


def line(x1, y1, x2, y2, style):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" {style}/>'


def text(px, py, words, style=""):
    return f'<text x="{px:.1f}" y="{py:.1f}" {style}>{words}</text>'


def axes():
    out = []
    for decade in range(COSTS[0], COSTS[1] + 1):
        out.append(line(x(10 ** decade), TOP, x(10 ** decade), HEIGHT - BOTTOM, 'stroke="#ddd"'))
        out.append(text(x(10 ** decade), HEIGHT - BOTTOM + 18, f"{10 ** decade:g}", 'text-anchor="middle"'))
    for decade in range(ERRORS[0], ERRORS[1] + 1):
        out.append(line(LEFT, y(10 ** decade), WIDTH - RIGHT, y(10 ** decade), 'stroke="#ddd"'))
        out.append(text(LEFT - 8, y(10 ** decade) + 4, f"1e{decade}", 'text-anchor="end"'))
    out.append(text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 12, "one step, median [ms]", 'text-anchor="middle"'))
    return out


def mark(px, py, colour, native):
    if native:
        return f'<circle cx="{px:.1f}" cy="{py:.1f}" r="5" fill="{colour}"/>'
    return f'<rect x="{px - 5:.1f}" y="{py - 5:.1f}" width="10" height="10" fill="white" stroke="{colour}" stroke-width="2"/>'


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        data = json.load(file)
    names = [each["name"] for each in data["engines"]]
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" '
           f'font-size="12"><rect width="100%" height="100%" fill="white"/>',
           text(LEFT, 22, "Error against the engine's own converged solution, matrix-free conjugate gradients")] + axes()
    meshes = sorted({cell["tets"] for cell in data["cells"]})
    for colour, tets in zip(COLOURS, meshes):
        for name in names:
            cells = [c for c in data["cells"] if c["tets"] == tets and c["engine"] == name and c["solver"].startswith("cg")]
            at = [(x(1e3 * c["step_cpu_s"]["median"]), y(c["error"])) for c in cells]
            out += [line(*a, *b, f'stroke="{colour}"') for a, b in zip(at, at[1:])]
            out += [mark(*point, colour, name == names[0]) for point in at]
        legend = TOP + 20 + 22 * meshes.index(tets)
        out += [line(WIDTH - RIGHT + 12, legend, WIDTH - RIGHT + 38, legend, f'stroke="{colour}" stroke-width="3"'),
                text(WIDTH - RIGHT + 46, legend + 4, f"{tets} tetrahedra")]
    for row, name in enumerate(names):
        legend = TOP + 40 + 22 * (len(meshes) + row)
        out += [mark(WIDTH - RIGHT + 25, legend, "#444", row == 0), text(WIDTH - RIGHT + 46, legend + 4, name)]
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write("\n".join(out + ["</svg>"]) + "\n")


main()
