#!/usr/bin/env python3
"""Print where a build folder's time went: its twenty slowest compilations and its twenty slowest tests.

Usage: slowest.py <build folder>
The times of compilations are those of the last time that each file was compiled (.ninja_log), those of tests are ctest's
(Testing/Temporary/CTestCostData.txt). Both are wall-clock times beside whatever else ran.
"""
import sys
from pathlib import Path

COUNT = 20


def compilations(folder):
    times = {}
    for line in (folder / ".ninja_log").read_text().splitlines()[1:]:
        start, end, _, output, *_ = line.split("\t")
        if output.endswith((".o", ".gch")):
            times[output] = (int(end) - int(start)) / 1000
    return times


def tests(folder):
    times = {}
    costs = folder / "Testing/Temporary/CTestCostData.txt"
    for line in costs.read_text().splitlines() if costs.exists() else []:
        if line == "---":
            break
        name, runs, cost = line.rsplit(" ", 2)
        if int(runs) > 0:
            times[name] = float(cost)
    return times


def show(what, times):
    print(f"{what}: {len(times)}, {sum(times.values()):.0f} s one after another; the slowest:")
    for name, seconds in sorted(times.items(), key=lambda each: -each[1])[:COUNT]:
        print(f"  {seconds:6.1f} s  {name}")


def main():
    folder = Path(sys.argv[1])
    show("compilations", compilations(folder))
    show("tests", tests(folder))


if __name__ == "__main__":
    main()
