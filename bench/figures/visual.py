"""`filasofia bench visual`: what a picture of a moving surface costs."""
from .markdown import ms, table


def frames(data, backend):
    """Medians of surfaces that follow tetrahedra."""
    cells = [cell for cell in data["frames"] if (cell["backend"], cell["map"]) == (backend, "barycentric")]

    def row(cell):
        stages = ("mapping_s", "subdivision_s", "normals_s", "upload_s", "submit_s", "main_s")
        return [str(cell["vertices"]), str(cell["level"]), *(ms(cell[key]["median"]) for key in stages),
                ms(cell["main_s"]["p99"]), ms(cell["whole_s"]["median"], 1)]
    return table(["vertices", "level", "mapping", "subdivision", "normals", "upload", "submit", "main thread", "p99",
                  "all threads"], map(row, cells))


def topology(data):
    def row(cell):
        return [str(cell["vertices"]), str(cell["level"]),
                *(ms(cell[key][at], 2) for key in ("prepare_s", "adopt_s") for at in ("median", "p99"))]
    return table(["vertices", "level", "prepare (worker)", "p99", "adopt (main)", "p99"], map(row, data["topology"]))


def physics(data):
    def row(cell):
        free = cell["pace"] == "free"
        return [cell["beside"], "as fast as possible" if free else "every 1 ms", f'{cell["steps_per_s"]:.{0 if free else 1}f}',
                str(cell["pictures"]), str(cell["late"]), str(cell["clamped"])]
    return table(["beside", "steps", "steps/s", "pictures", "late", "clamped"], map(row, data["physics"]))


TABLES = {"frames": lambda data: frames(data, "null"), "filament": lambda data: frames(data, "headless"),
          "topology": topology, "physics": physics}
