"""`filasofia bench contact --engine NAME`: what a step of bodies in contact costs with each engine, and its contacts."""
from .markdown import ms, table


def cells(data):
    def row(cell):
        step = cell["step_cpu_s"]
        return [cell["body"], cell["scene"], str(cell["tetrahedra"]), cell["engine"], ms(step["median"]),
                ms(step["p99"]), f'{cell["found"]["median"]:.0f}', f'{cell["pushing"]["median"]:.0f}',
                f'{cell["force_n"]["median"]:.3f}', f'{1e6 * cell["penetration_m"]:.1f}',
                f'{cell["steps_with_flags"]} of {cell["steps"]}']
    return table(["body", "scene", "tetrahedra", "engine", "median [ms]", "p99 [ms]", "found", "pushing", "forces [N]",
                  "deepest [um]", "steps with flags"], map(row, data["cells"]))


TABLES = {"cells": cells}
