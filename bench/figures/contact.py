"""`filasofia bench contact`: what a step costs while bodies touch."""
from .markdown import find, ms, ratio, table


def timed(cell, threads=1, contacts=True):
    return find(cell["runs"], threads=threads, contacts=contacts)


def times(data):
    def row(cell):
        run, two = timed(cell), timed(cell, 2)
        step = run["step_s"]
        return [cell["body"], cell["scene"], ms(step["median"]), ms(step["p99"]), ms(step["max"]),
                ms(run["detection_s"]["median"]), ms(run["response_s"]["median"]), ratio(cell["step_over_contact_free"]),
                ms(two["step_s"]["median"]) if two else ""]
    return table(["body", "scene", "median", "p99", "max", "detection", "response", "x contact-free", "2 threads"],
                 map(row, data["cells"]))


def counts(data):
    def row(cell):
        run = timed(cell)
        return [cell["body"], cell["scene"], str(cell["tetrahedra"]), f'{cell["found"]["median"]:.0f}',
                f'{cell["pushing"]["median"]:.0f}', f'{cell["rounds"]["median"]:.0f}', f'{run["iterations_mean"]:.1f}',
                f'{cell["force_n"]["median"]:.2f}', f'{1e6 * cell["penetration_m"]:.1f}',
                f'{max(run["cores_taken_by_others"]):.2f}']
    return table(["body", "scene", "tetrahedra", "found", "pushing", "rounds", "iterations", "force [N]", "deepest [um]",
                  "other load"], map(row, data["cells"]))


TABLES = {"times": times, "counts": counts}
