"""`filasofia bench cut`: what a step costs while a blade goes through a block."""
from .markdown import ms, table


def costs(data):
    def row(cell):
        topology = cell["topology_s"]
        return [cell["scene"], *(ms(topology[key]) for key in ("mean", "median", "p99", "max")),
                *(ms(cell[key]["median"]) for key in ("contacts_s", "advance_s", "step_s"))]
    return table(["scene", "topology: mean", "median", "p99", "max", "contacts: median", "advance: median", "step: median"],
                 map(row, data["cells"]))


def iterations(data):
    def row(cell):
        spreads = [cell["iterations_" + when] for when in ("before", "during", "after")]
        return [cell["scene"], *(f'{each["median"]:.0f} ({each["max"]:.0f})' for each in spreads),
                f'{spreads[2]["mean"] / spreads[0]["mean"]:.2f}', f'{1e4 * cell["opened_m2"]:.1f}',
                f'{cell["steps_that_opened"]} of {cell["steps_counted"]}']
    return table(["scene", "before: median (max)", "during", "after", "after / before, mean", "opened [cm^2]",
                  "steps that opened"], map(row, data["cells"]))


TABLES = {"costs": costs, "iterations": iterations}
