"""`filasofia bench bunny --engine NAME`: what a step of the bunny costs beside its error, with each engine and solver."""
from .markdown import ms, table


def cells(data):
    def row(cell):
        step = cell["step_cpu_s"]
        return [str(cell["tets"]), cell["engine"], cell["solver"], ms(step["median"]), ms(step["p99"]),
                f'{cell["iterations"]:.1f}', f'{cell["error"]:.1e}',
                f'{cell["apart"]:.1e}', "yes" if cell["flags"] else ""]
    return table(["mesh", "engine", "solver", "median [ms]", "p99 [ms]", "iterations", "error", "apart", "flags"],
                 map(row, data["cells"]))


TABLES = {"cells": cells}
