"""`filasofia bench solver`: what a step of the bunny costs without contact."""
from .markdown import find, ms, ratio, table, wrapped


def timed(cell, threads=1, busy=False):
    return find(cell["runs"], threads=threads, other_cores_busy=busy)


def mesh(cell):
    return [str(cell["tetrahedra"]), f'{1e3 * cell["dt_s"]:g} ms']


def error(cell):
    """The larger error of the two scenes."""
    return max(cell["error"]["hanging"], cell["error"]["standing"])


def error_cell(cell):
    steps = cell["error"]["steps"]
    return f"{error(cell):.1e}" + ("" if steps == 200 else f" ({steps} steps)")


def steps(data):
    def row(cell):
        run = timed(cell)
        step = run["step_s"]
        return [*mesh(cell), ms(step["median"]), ms(step["p99"]), f'{1 / step["median"]:.0f}', f'{run["iterations_mean"]:.1f}',
                ratio(cell["oracle_over_step"])]
    return table(["tetrahedra", "dt", "median [ms]", "p99 [ms]", "steps/s", "iterations", "reference / step"],
                 map(row, data["cells"]))


def bound(data):
    def row(cell):
        run = timed(cell)
        return [*mesh(cell), ms(run["floor_s"]["median"]), ratio(run["step_over_floor"]),
                f'{run["floor_ns_per_tetrahedron"]:.1f}', f'{run["floor_gflop_per_s"]:.0f}']
    return table(["tetrahedra", "dt", "lower bound [ms]", "step / lower bound", "lower bound [ns/tetrahedron]", "GFLOP/s"],
                 map(row, data["cells"]))


def errors(data):
    def row(cell):
        each = cell["error"]
        return [*mesh(cell), *(f"{each[kind]:.1e}" for kind in ("hanging", "standing", "hanging_tight", "standing_tight")),
                str(each["steps"])]
    return table(["tetrahedra", "dt", "hanging", "standing", "hanging, tight", "standing, tight", "steps"],
                 map(row, data["cells"]))


def threads(data):
    def row(cell):
        two, busy = timed(cell, 2), timed(cell, 2, True)
        trips = sorted(1e9 * trip for trip in cell["core_round_trip_s"])
        others = max(max(run["cores_taken_by_others"]) for run in cell["runs"])
        return [*mesh(cell), ms(two["step_s"]["median"]), ms(two["step_s"]["p99"]), ratio(two["step_over_floor"]),
                ratio(two["times_as_fast_as_one_thread"]), ratio(busy["times_as_fast_as_one_thread"]),
                f"{trips[0]:.0f}-{trips[-1]:.0f}", f"{others:.2f}"]
    return table(["tetrahedra", "dt", "median [ms]", "p99 [ms]", "step / lower bound", "speed-up", "speed-up, core busy",
                  "round trip [ns]", "other load"], map(row, data["cells"]))


def stiff(data):
    materials = list(dict.fromkeys((run["young_modulus_pa"], run["poisson_ratio"]) for run in data["stiff"]))
    cells = list(dict.fromkeys((run["mesh"], run["dt_s"]) for run in data["stiff"]))

    def row(cell):
        runs = (find(data["stiff"], mesh=cell[0], dt_s=cell[1], young_modulus_pa=e, poisson_ratio=nu) for e, nu in materials)
        return [cell[0], f"{1e3 * cell[1]:g} ms", *(str(run["iterations_most"]) for run in runs)]
    return table(["mesh", "dt", *(f"E = {1e-3 * e:g} kPa, nu = {nu:g}" for e, nu in materials)], map(row, cells))


def pairs(data):
    """(cell at 1 ms, cell at 5 ms) of each mesh."""
    for cell in data["cells"]:
        if cell["dt_s"] == 0.001:
            yield cell, find(data["cells"], mesh=cell["mesh"], dt_s=0.005)


def short(data):
    """The table for pages that only need the main figures."""
    def row(pair):
        one, five = pair
        return [str(one["tetrahedra"]), ms(timed(one)["step_s"]["median"]), error_cell(one),
                ms(timed(five)["step_s"]["median"]), error_cell(five), f'{five["oracle_over_step"]["median"]:.1f}']
    return table(["tetrahedra", "step of 1 ms [ms]", "error", "step of 5 ms [ms]", "error", "reference / step of 5 ms"],
                 map(row, pairs(data)))


def sentence(data):
    one, five = next(pair for pair in pairs(data) if pair[0]["mesh"] == "3004")
    worst = max(error(cell) for cell in data["cells"])
    return wrapped(f'On one core, a step of 1 ms of a body of {one["tetrahedra"]:,} tetrahedra takes '
                   f'{ms(timed(one)["step_s"]["median"])} ms, and a step of 5 ms {ms(timed(five)["step_s"]["median"])} ms. '
                   f'That is {five["oracle_over_step"]["median"]:.0f} times as fast as the assembled solver in double. '
                   f'The error against a converged solution is at most {worst:.1e} of the displacement.')


TABLES = {"steps": steps, "bound": bound, "errors": errors, "threads": threads, "stiff": stiff, "short": short,
          "sentence": sentence}
