"""bench/gym_steps.py, learn.py and batch_clusters.py: what the Python package does in a second, learns, and survives."""
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
                  "hashes of the serial run"], [row(name) for name in ("processes", "dask", "ray")])


TABLES = {"steps": steps, "peer": peer, "learning": learning, "batch": batch}
