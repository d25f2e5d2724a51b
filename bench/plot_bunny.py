#!/usr/bin/env python3
"""Draw the JSON of `filasofia bench bunny --json FILE` as an SVG like the paper's figure 5: the physics rate over time,
one panel per mesh, one line per subdivision level and picture. Usage: plot_bunny.py FILE.json OUT.svg"""
import json
import statistics
import sys

WIDTH, PANEL, LEFT, RIGHT, TOP, GAP = 860, 150, 60, 210, 40, 44
COLOURS = {0: "#7a7a7a", 1: "#53b0e8", 2: "#1b3f94"}
WINDOW_S = 0.2  # each point is the median rate of this long


def rates(cell):
    """(time [s], median rate [1/s]) per window, from the times between wake-ups."""
    wake = [t * 1e-6 for t in cell["series"]["wake_us"]]
    windows = {}
    for before, now in zip(wake, wake[1:]):
        windows.setdefault(int(now / WINDOW_S), []).append(1.0 / max(now - before, 1e-6))
    return [((k + 0.5) * WINDOW_S, statistics.median(v)) for k, v in sorted(windows.items())]


def panel(top, tets, cells, seconds):
    def x(t): return LEFT + t / seconds * (WIDTH - LEFT - RIGHT)
    def y(rate): return top + PANEL * (1 - min(rate, 250.0) / 250.0)
    out = [f'<text x="{LEFT}" y="{top - 8}" font-weight="bold">{tets} tetrahedra</text>']
    for rate in (0, 50, 100, 150, 200, 250):
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(rate):.1f}" y2="{y(rate):.1f}" stroke="#ddd"/>')
        out.append(f'<text x="{LEFT - 8}" y="{y(rate) + 4:.1f}" text-anchor="end">{rate}</text>')
    for row, cell in enumerate(cells):
        points = " ".join(f"{x(t):.1f},{y(rate):.1f}" for t, rate in rates(cell))
        dash = ' stroke-dasharray="5 3"' if cell["backend"] == "null" else ""
        colour = COLOURS[cell["subdivision"]]
        out.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.6"{dash}/>')
        legend = top + 14 + 22 * row
        out.append(f'<line x1="{WIDTH - RIGHT + 12}" x2="{WIDTH - RIGHT + 38}" y1="{legend}" y2="{legend}" '
                   f'stroke="{colour}" stroke-width="2"{dash}/>')
        out.append(f'<text x="{WIDTH - RIGHT + 44}" y="{legend + 4}">level {cell["subdivision"]}, {cell["backend"]}: '
                   f'{cell["rate_per_s"]["median"]:.1f}/s</text>')
    return out


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        data = json.load(file)
    paced = [cell for cell in data["cells"] if cell["pace"] != "free"]
    meshes = sorted({cell["tets"] for cell in paced})
    height = TOP + len(meshes) * (PANEL + GAP) + 10
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}" font-family="sans-serif" '
           f'font-size="12"><rect width="100%" height="100%" fill="white"/>',
           f'<text x="{LEFT}" y="18">Physics updates per second over {data["seconds_per_cell"]:g} s, period 5 ms '
           f'(at most 200/s); medians of {WINDOW_S:g} s</text>']
    for index, tets in enumerate(meshes):
        cells = [cell for cell in paced if cell["tets"] == tets]
        out += panel(TOP + 16 + index * (PANEL + GAP), tets, cells, data["seconds_per_cell"])
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write("\n".join(out + ["</svg>"]) + "\n")


main()
