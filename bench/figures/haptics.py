"""`filasofia bench haptics`: the servo's clock, and the energy that walls return."""
from .markdown import find, table


def servo(data):
    def row(run):
        late = run["jitter_s"]
        return [run["name"], f'{run["seconds"]:g}', f'{run["rate_hz"]:.1f}',
                *(f"{1e3 * late[key]:.2f}" for key in ("median", "p99", "p999")), f'{1e3 * late["max"]:.1f}',
                f'{run["energy_J"]:.2f}', f'{run["most_force_N"]:.1f}']
    return table(["run", "seconds", "mean rate [1/s]", "late: median [ms]", "p99", "p99.9", "max", "net energy to the user [J]",
                  "highest force [N]"], map(row, data["runs"]))


def walls(data):
    stiffnesses = sorted({wall["stiffness_N_m"] for wall in data["walls"]})

    def row(stiffness):
        cells = (find(data["walls"], stiffness_N_m=stiffness, physics_hz=rate, jitter_s=late)
                 for rate in (1000.0, 20.0) for late in (0.0, 0.0002))
        return [f"{stiffness:g}", *(f'{1e3 * cell["given_by_hand_J"]:.1f}' for cell in cells)]
    return table(["stiffness [N/m]", "physics at 1 kHz", "ticks up to 0.2 ms late", "physics at 20 Hz",
                  "ticks up to 0.2 ms late"], map(row, stiffnesses))


TABLES = {"servo": servo, "walls": walls}
