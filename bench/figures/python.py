"""bench/gym_steps.py, python_peers.py, learn.py and batch_clusters.py: what the Python package does in a second, beside peers, learns, and survives."""
from .markdown import table


def steps(data):
    def row(name, cell):
        return [name, *(f'{cell[key]:,}' for key in ("tetrahedra", "one", "vector", "pictures", "low", "depth")), f'{cell["reset_ms"]:.2f}']
    return table(["task", "tetrahedra", "one environment", f'{data["envs"]} in a vector', "one, 128 x 128 RGB", "of low quality", "with depth", "reset [ms]"],
                 [row(*each) for each in data["tasks"].items()])


def peer(data):
    found = data["mujoco_flex"]
    return table(["MuJoCo " + found["version"] + ", step of physics", "tetrahedra", "environment steps per second", "unstable steps"],
                 [[name[3:].replace("_", " "), f'{found["tetrahedra"]:,}', f'{each["steps_per_second"]:,}', str(each["unstable_steps"])]
                  for name, each in found.items() if name.startswith("dt_")])


def learning(data):
    return table(["steps", "minutes", "success in 50 episodes"],
                 [[f'{each["steps"]:,}', f'{each["minutes"]:.2f}', f'{each["success"]:.0%}'] for each in data["curve"]])


def batch(data):
    def row(name):
        cell = data[name]
        yes = {True: "yes", False: "**no**"}
        return [name, f'{cell["seconds_without_kills"]:.1f}', str(cell["done_when_the_driver_was_killed"]), str(cell["rows"]),
                str(cell["errors"]), yes[cell["every_session_once"]], yes[cell["hashes_of_the_serial_run"]]]
    return table(["executor", "without kills [s]", "done when the driver was killed", "rows in the end", "errors", "each session once",
                  "hashes of the serial run"], [row(name) for name in ("processes", "dask", "ray", "mpi", "slurm", "ssh") if name in data])


def _name(row):
    names = {"filasofia": "Filasofia", "mujoco": "MuJoCo", "pybullet": "PyBullet", "newton": "Newton"}
    return [names[row["engine"]], row["law"]]


def _percent(error):
    if error is None:
        return "unstable"
    return "< 0.01%" if error < 1e-4 else f"{error:.2%}" if error < 0.1 else f"{error:.0%}"


SHOWN = {"implicit": (5, 1), "VBD": (2, 1), "explicit": (0.5,)}  # [ms], of all that were measured


def peer_runs(data):
    """A part of the runs: the others are in the file."""
    def row(each):
        errors = each["errors"] or [None, None]
        return [*_name(each), each["scheme"], f'{each["dt_ms"]:g}', f'{each["median_ms"]:.3f}', f'{each["p99_ms"]:.2f}', *map(_percent, errors)]
    rows = [each for each in data["runs"] if each["dt_ms"] in SHOWN[each["scheme"]] and each["tetrahedra"] > 1000]
    return table(["engine", "law", "scheme", "step [ms]", "takes, median [ms]", "p99 [ms]", "error at 0.1 s", "at 0.5 s"], map(row, rows))


def peer_equal(data):
    """The cheapest setting that was tried, for each bound of the error at 0.5 s."""
    sizes = sorted({each["tetrahedra"] for each in data["runs"]})
    bounds = (0.25, 0.05, 0.01)

    def cell(rows, bound):
        good = [each for each in rows if each["errors"] and each["errors"][-1] <= bound]
        if not good:
            return "none"
        best = min(good, key=lambda each: each["seconds_per_second"])
        return f'{best["seconds_per_second"]:.3g} ({best["scheme"]}, {best["dt_ms"]:g} ms)'
    rows = []
    for name in dict.fromkeys(each["engine"] for each in data["runs"]):
        laws = dict.fromkeys(each["law"] for each in data["runs"] if each["engine"] == name)
        for law in laws:
            for size in sizes:
                mine = [each for each in data["runs"] if (each["engine"], each["law"], each["tetrahedra"]) == (name, law, size)]
                rows.append([*_name(mine[0]), f"{size:,}", *(cell(mine, bound) for bound in bounds)])
    return table(["engine", "law", "tetrahedra", *(f"error at most {bound:.0%}" for bound in bounds)], rows) + _missing(data)


def _missing(data):
    return [f"| {name} | {why} |" for name, why in data["missing"].items()]


def peer_rest(data):
    def row(each):
        return [*_name(each), f'{each["tetrahedra"]:,}', f'{each["dt_ms"]:g}', f'{each["simulated_s"]:g}', f'{each["sag_mm"]:.2f}',
                _percent(each["error"]), f'{each["seconds"]:.2f}']
    return table(["engine", "law", "tetrahedra", "step [ms]", "time [s]", "sag of the solution [mm]", "error", "took [s]"], map(row, data["rests"]))


def peer_batch(data):
    def error(each):
        same = ("engine", "law", "scheme", "dt_ms")
        run = next(run for run in data["runs"] if all(run[key] == each[key] for key in same) and run["tetrahedra"] < 1000)
        return _percent(run["errors"] and run["errors"][-1])

    def row(each):
        return [*_name(each), each["how"], each["scheme"], f'{each["dt_ms"]:g}', f'{each["steps_per_second"]:,}',
                f'{each["simulated_seconds_per_second"]:.3g}', error(each)]
    head = ["engine", "law", f'{data["simulations"]} bodies on', "scheme", "step [ms]", "steps per second", "simulated seconds per second", "error at 0.5 s"]
    return table(head, map(row, data["batches"]))


TABLES = {"peer runs": peer_runs, "peer equal": peer_equal, "peer rest": peer_rest, "peer batch": peer_batch, "steps": steps, "peer": peer, "learning": learning, "batch": batch}
