#!/usr/bin/env python3
"""Writes the JSON of `filasofia bench contact --json FILE` as the tables of docs/bench.md. Usage: table_contact.py FILE.json"""
import json
import sys

from tables import ratio, table


def find(cell, threads, contacts=True):
    runs = (run for run in cell["runs"] if (run["threads"], run["contacts"]) == (threads, contacts))
    return next(runs, None)


def ms(value):
    return f"{1e3 * value:.3f}"


def row(cell, cores):
    run, many = find(cell, 1), find(cell, cores) if cores > 1 else None
    step = run["step_s"]
    return [cell["body"], cell["scene"], str(cell["tetrahedra"]), ms(step["median"]), ms(step["p99"]), ms(step["max"]),
            ms(run["detection_s"]["median"]), ms(run["response_s"]["median"]), ratio(cell["step_over_contact_free"]),
            f'{cell["found"]["median"]:.0f}', f'{cell["pushing"]["median"]:.0f}', f'{cell["rounds"]["median"]:.0f}',
            f'{run["iterations_mean"]:.1f}', f'{cell["force_n"]["median"]:.2f}', f'{1e6 * cell["penetration_m"]:.1f}',
            ms(many["step_s"]["median"]) if many else "", f'{max(run["cores_taken_by_others"]):.2f}']


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        data = json.load(file)
    table(["body", "scene", "tetrahedra", "step: median [ms]", "p99", "max", "detection", "response", "x contact-free",
           "found", "pushing", "rounds", "iterations", "force [N]", "deepest [um]", f'{data["cores"]} threads [ms]',
           "cores taken by others"], (row(cell, data["cores"]) for cell in data["cells"]))
    words = {True: "met", False: "**missed**", None: "unknown"}
    table(["limit", "", "measured"], [[limit["limit"], words[limit["met"]], limit["measured"]] for limit in data["limits"]])


main()
