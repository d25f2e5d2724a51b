"""`filasofia bench laws`: what a step of the bunny costs by elastic law."""
from .markdown import ms, ratio, table


def cells(data):
    def row(cell):
        step = cell["step_s"]
        return [str(cell["tetrahedra"]), cell["law"], ms(step["median"]), ms(step["p99"]), ratio(cell["over_corotational"]),
                f'{cell["iterations_mean"]:.1f}', f'{cell["error"]:.1e}', "yes" if cell["flags"] else ""]
    return table(["tetrahedra", "law", "median [ms]", "p99 [ms]", "over corotational", "iterations", "error", "flags"],
                 map(row, data["cells"]))


def incompressible(data):
    def row(cell):
        step = cell["step_s"]
        return [str(cell["tetrahedra"]), f'{cell["poisson_ratio"]:g}', ms(step["median"]), ms(step["p99"]), ratio(cell["over_045"]),
                f'{cell["iterations_mean"]:.1f}', f'{cell["error"]:.1e}', "yes" if cell["flags"] else ""]
    return table(["tetrahedra", "nu", "median [ms]", "p99 [ms]", "over 0.45", "iterations", "error", "flags"],
                 map(row, data["incompressible"]))


TABLES = {"cells": cells, "incompressible": incompressible}
