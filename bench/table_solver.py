#!/usr/bin/env python3
"""Writes the JSON of `filasofia bench solver --json FILE` as the tables of docs/bench.md. Usage: table_solver.py FILE.json"""
import json
import sys

from tables import ratio, table


def find(cell, threads, busy=False):
    return next((run for run in cell["runs"] if (run["threads"], run["other_cores_busy"]) == (threads, busy)), None)


def one_thread(cell):
    run, error = find(cell, 1), cell["error"]
    step = run["step_s"]
    worse = [max(error["hanging" + kind], error["standing" + kind]) for kind in ("", "_tight")]
    steps = "" if error["steps"] == 200 else f' ({error["steps"]} steps)'
    return [str(cell["tetrahedra"]), f'{1e3 * cell["dt_s"]:g} ms', f'{1e3 * step["median"]:.3f}', f'{1e3 * step["p99"]:.3f}',
            f'{1 / step["median"]:.0f}', f'{run["iterations_mean"]:.1f}', f'{1e3 * run["floor_s"]["median"]:.3f}',
            ratio(run["step_over_floor"]), f'{run["floor_ns_per_tetrahedron"]:.1f}', f'{run["floor_gflop_per_s"]:.0f}',
            ratio(cell["oracle_over_step"]), f"{worse[0]:.1e}{steps}", f"{worse[1]:.1e}"]


def two_threads(cell):
    two, busy = find(cell, 2), find(cell, 2, True)
    trips = sorted(1e9 * trip for trip in cell["core_round_trip_s"])
    others = max(max(run["cores_taken_by_others"]) for run in cell["runs"])
    return [str(cell["tetrahedra"]), f'{1e3 * cell["dt_s"]:g} ms', f'{1e3 * two["step_s"]["median"]:.3f}',
            f'{1e3 * two["step_s"]["p99"]:.3f}', ratio(two["step_over_floor"]), ratio(two["times_as_fast_as_one_thread"]),
            ratio(busy["times_as_fast_as_one_thread"]), f"{trips[0]:.0f}-{trips[-1]:.0f}", f"{others:.2f}"]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        data = json.load(file)
    table(["tetrahedra", "dt", "step: median [ms]", "p99", "steps/s", "iterations", "floor [ms]", "step / floor",
           "floor [ns/tetrahedron]", "GFLOP/s", "oracle / step", "error", "tight"], map(one_thread, data["cells"]))
    if data["cores"] > 1:
        table(["tetrahedra", "dt", "step: median [ms]", "p99", "step / floor", "x one thread", "the same, other core busy",
               "core to core and back [ns]", "cores taken by others"], map(two_threads, data["cells"]))
    words = {True: "met", False: "**missed**", None: "unknown"}
    table(["limit", "", "measured"], [[limit["limit"], words[limit["met"]], limit["measured"]] for limit in data["limits"]])


main()
