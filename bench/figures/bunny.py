"""`filasofia bench bunny`: the rate of physics beside a picture."""
from .markdown import ms, table


def paced(data):
    cells = [cell for cell in data["cells"] if cell["pace"] != "free"]
    cells.sort(key=lambda cell: (cell["tets"], cell["subdivision"], cell["backend"] != "null"))

    def row(cell):
        rate = cell["rate_per_s"]
        return [str(cell["tets"]), str(cell["subdivision"]), cell["backend"],
                *(f"{rate[key]:.1f}" for key in ("median", "p1", "p99")), *(str(cell[key]) for key in ("late", "clamped", "frames"))]
    return table(["mesh", "level", "picture", "median rate [1/s]", "p1", "p99", "late", "clamped", "pictures"], map(row, cells))


def free(data):
    def row(cell):
        cost = cell["cost_s"]
        return [str(cell["tets"]), str(cell["subdivision"]), *(ms(cost[key]) for key in ("median", "p1", "p99")),
                f'{cell["real_time_factor"]:.2f}']
    return table(["mesh", "level", "median [ms]", "p1", "p99", "x real time"],
                 map(row, (cell for cell in data["cells"] if cell["pace"] == "free")))


TABLES = {"paced": paced, "free": free}
