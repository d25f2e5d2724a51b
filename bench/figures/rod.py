"""`filasofia bench rod`: what a step of a thread costs, alone, on a floor, and in tissue."""
from .markdown import ms, table


def cells(data):
    def row(cell):
        step = cell["step_s"]
        return [str(cell["nodes"]), cell["rod"], str(cell["tetrahedra"]) if cell["tetrahedra"] else "", ms(step["median"]),
                ms(step["p99"]), f'{cell["contacts_mean"]:.0f}', f'{cell["self_contacts_mean"]:.0f}',
                f'{cell["iterations_mean"]:.1f}', "yes" if cell["flags"] else ""]
    return table(["nodes", "it", "tetrahedra", "median [ms]", "p99 [ms]", "contacts", "with itself", "iterations", "flags"],
                 map(row, data["cells"]))


TABLES = {"cells": cells}
