"""The page that has one line for each thing measured."""
from .contact import timed as contact_run
from .markdown import find, ms, table, verdict
from .solver import error, pairs, timed as solver_run


def listed(values):
    return "; ".join(values)


def solver(data):
    meshes = {one["mesh"]: (one, five) for one, five in pairs(data)}
    one, five = meshes["3004"]
    large = [meshes[mesh] for mesh in ("10000", "30000", "95680")]
    names = listed(f'{pair[0]["tetrahedra"]:,}' for pair in large)
    errors = [error(cell) for cell in data["cells"]]

    def speed_up(cell):
        return f'{solver_run(cell, 2)["times_as_fast_as_one_thread"]["median"]:.2f}'
    return [
        [f'{one["tetrahedra"]:,} tetrahedra hanging, no contact, step of 1 ms', f'{ms(solver_run(one)["step_s"]["median"])} ms', ""],
        ["the same, step of 5 ms", f'{ms(solver_run(five)["step_s"]["median"])} ms', ""],
        ["the same, times as fast as the assembled solver in double", f'{five["oracle_over_step"]["median"]:.1f}',
         verdict(data, "times as fast as", "at 3004")],
        [f"{names} tetrahedra, step of 1 ms", listed(ms(solver_run(pair[0])["step_s"]["median"]) for pair in large) + " ms", ""],
        ["the same with two threads, times as fast, steps of 1 ms", listed(speed_up(pair[0]) for pair in large),
         verdict(data, "two threads are")],
        ["the same, steps of 5 ms", listed(speed_up(pair[1]) for pair in large), ""],
        ["error against the converged solution, over the displacement", f"{min(errors):.1e} to {max(errors):.1e}",
         verdict(data, "error at the default tolerance")],
    ]


def contact(data):
    def rows(body, at_median, at_p99):
        cells = [find(data["cells"], body=body, scene=f"scraped at {speed} m/s") for speed in ("0.1", "1")]
        steps = [contact_run(cell)["step_s"] for cell in cells]
        what = f'{cells[0]["tetrahedra"]:,} tetrahedra scraped at 0.1 and 1 m/s with friction'
        found = listed(f'{cell["found"]["median"]:.0f}' for cell in cells)
        return [[f"{what}, {found} contacts", listed(ms(step["median"]) for step in steps) + " ms", verdict(data, *at_median)],
                ["the same, p99", listed(ms(step["p99"]) for step in steps) + " ms", verdict(data, *at_p99)]]
    plate = find(data["cells"], body="slab 30240", scene="plate, 1000 contacts")
    return [
        *rows("bunny 3004", ("3004", "median"), ("3004", "p99")),
        *rows("bunny 10000", ("10000", "median"), ("10000", "p99")),
        [f'{plate["pushing"]["median"]:,.0f} pushing contacts on {plate["tetrahedra"]:,} tetrahedra',
         f'{ms(contact_run(plate)["step_s"]["median"])} ms', verdict(data, "1000 contacts on")],
        ["the same without contact", f'{ms(contact_run(plate, contacts=False)["step_s"]["median"])} ms', ""],
        *(row for body, scene, what, words in REST for row in rest(data, body, scene, what, words)),
    ]


REST = [
    ("64 boxes", "four layers", "64 rigid boxes at rest, close together", ("64 rigid boxes",)),
    ("heap", "50 soft blocks", "50 soft blocks of 480 tetrahedra in a heap, step of 5 ms", ("50 soft blocks",)),
    ("grip", "held by 400 N/m", "an organ between jaws at rest, over the organ alone", ("a grip at rest",)),
    ("three blocks", "tied by 60 N/m", "three blocks tied by springs, over one mesh of their tissues", ("three tied blocks",)),
]


def rest(data, body, scene, what, words):
    """A row of a scene at rest: its time, or where the limit is a ratio, that."""
    cell = find(data["cells"], body=body, scene=scene)
    if cell is None:
        return []
    step, free = (contact_run(cell, contacts=contacts)["step_s"]["median"] for contacts in (True, False))
    measured = f"{step / free:.2f}" if " over " in what else f"{ms(step)} ms"
    return [[what, measured, verdict(data, *words)]]


def cut(data):
    cells = [find(data["cells"], scene=f"alone, {depth}") for depth in ("half", "through")]

    def of(key):
        return listed(ms(cell["topology_s"][key]) for cell in cells) + " ms"
    return [
        [f'blade through {cells[0]["tetrahedra"]:,} tetrahedra, half and through: mean cost of the edit per step', of("mean"),
         verdict(data, "mean of the topology")],
        ["the same, p99", of("p99"), verdict(data, "p99 of the topology")],
    ]


def visual(data):
    levels = [find(data["frames"], backend="null", map="barycentric", vertices=50176, level=level) for level in (0, 1, 2)]
    fresh = [find(data["topology"], vertices=vertices, level=1) for vertices in (5184, 50176)]
    clock = {each["beside"]: each["steps_per_s"] for each in data["physics"] if each["pace"] != "free"}
    return [
        ["50,176 vertices that all move, levels 0, 1, 2: main thread without the driver",
         listed(ms(each["main_s"]["median"], 2) for each in levels) + " ms", verdict(data, "50,000 vertices")],
        ["new triangles of 5,184 and 50,176 vertices at level 1, in a worker thread",
         listed(ms(each["prepare_s"]["median"], 1) for each in fresh) + " ms", ""],
        ["physics at 1 kHz beside a picture, over its rate alone", f'{clock["picture"] / clock["nothing"]:.3f}',
         verdict(data, "physics at 1 ms keeps")],
    ]


def bunny(data):
    rates = [cell["rate_per_s"]["median"] for cell in data["cells"] if cell["pace"] != "free"]
    return [[f"physics at 200/s beside any picture, {len(rates)} cells: lowest median rate", f"{min(rates):.1f}/s",
             verdict(data, "every paced cell")]]


def haptics(data):
    run = data["runs"][0]
    highest = max(wall["most_energy_J"] for wall in data["walls"])
    return [
        [f'haptic servo at 1 kHz, {run["seconds"] / 60:g} minutes: mean rate', f'{run["rate_hz"]:.1f}/s', ""],
        ["the same, late by, median; p99.9", f'{ms(run["jitter_s"]["median"], 2)}; {ms(run["jitter_s"]["p999"], 2)} ms',
         verdict(data, "1 kHz", "p99.9")],
        ["highest net energy that walls up to 10 kN/m give to the user", f"{highest:g} J", verdict(data, "every wall", "at most")],
    ]


def all_of(*results):
    """One table of all results, in their order; the program that measured each stands in the last column."""
    writers = {"solver": solver, "contact": contact, "cut": cut, "visual": visual, "bunny": bunny, "haptics": haptics}
    return table(["What", "Measured", "Limit", "Bench"],
                 [[*row, data["bench"]] for data in results for row in writers[data["bench"]](data)])


TABLES = {"all": all_of}
