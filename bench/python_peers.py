"""Filasofia beside soft bodies that install from PyPI: mujoco, pybullet, newton. Speed and error, one body for all.

    scripts/python_peers.sh [--small]       installs what is needed, measures for at most ten minutes, writes the tables
    python bench/python_peers.py [--out FILE] [--small]
    (the packages filasofia, scipy, mujoco, pybullet, newton; a peer that is not installed is left out, and said)

The body is a cantilever of 768 and of 2,808 tetrahedra (peer_reference.py), without damping, under its weight. Every
engine makes 0.5 s, three swings, with steps of several lengths, on one thread. Its error is the distance of its nodes
from a converged solution of its own law with its own masses, in relation to how far they moved. Then the same body with
damping comes to rest, and 16 bodies are stepped at once on two threads.
"""

import argparse
import concurrent.futures
import datetime
import importlib.util
import json
import math
import os
import pathlib
import platform
import sys
import time

import numpy as np
from peer_engines import Filasofia, MuJoCo, Newton, PyBullet, mujoco_model
from peer_reference import Block

CELLS = ((8, 4, 4), (13, 6, 6))
TIMES = (0.1, 0.5)  # [s]
IMPLICIT, EXPLICIT = (5e-3, 2e-3, 1e-3, 5e-4, 2e-4), (1e-3, 5e-4, 2e-4)  # [s]
RUNS = [
    *((Filasofia, {"law": law, "scheme": "implicit"}, IMPLICIT) for law in Filasofia.LAWS),
    *((Filasofia, {"law": law, "scheme": "explicit"}, EXPLICIT) for law in Filasofia.LAWS),
    (MuJoCo, {"scheme": "implicit"}, IMPLICIT),
    (MuJoCo, {"scheme": "explicit"}, EXPLICIT),
    (PyBullet, {"scheme": "explicit"}, EXPLICIT),
    (Newton, {"scheme": "VBD"}, (5e-3, 2e-3, 1e-3)),
    (Newton, {"scheme": "explicit"}, EXPLICIT[1:]),
]
# To rest: steps, damping and duration [s]. 0.05 s damps the slowest mode almost critically. VBD's ten iterations do not
# carry so much: it gets a tenth of it and twice the time. Newton's explicit solver has damping that is explicit, too, and
# would need steps that are far smaller.
RESTS = [
    *((Filasofia, {"law": law, "scheme": "implicit"}, (5e-3, 0.05, 1.5)) for law in Filasofia.LAWS),
    (MuJoCo, {"scheme": "implicit"}, (5e-3, 0.05, 1.5)),
    (PyBullet, {"scheme": "explicit"}, (5e-4, 0.05, 1.5)),
    (Newton, {"scheme": "VBD"}, (1e-3, 0.005, 3.0)),
]


def block_of(cells):
    """Filasofia's mesh of a block if it is there, for all; it is only a table of nodes and tetrahedra."""
    import filasofia as fs

    mesh = fs.shapes.block(Block.size, cells)
    return Block(mesh.nodes, mesh.tetrahedra)


def engines_here(missing):
    """What is installed, with versions; the others go to `missing`."""
    versions = {}
    for engine in (Filasofia, MuJoCo, PyBullet, Newton):
        if importlib.util.find_spec(engine.package) is None:
            missing[engine.package] = "not installed"
        else:
            versions[engine.package] = engine.version()
    return versions


def finite(value):
    """JSON knows no infinity."""
    return round(value, 6) if math.isfinite(value) and value < 10 else None


def motion(engine, block, dt, references):
    """Seconds of each step, and the errors at TIMES; ends early if the body explodes."""
    marks, taken, errors = [round(each / dt) for each in TIMES], [], []
    for step in range(1, marks[-1] + 1):
        begin = time.perf_counter()
        engine.step()
        taken.append(time.perf_counter() - begin)
        if step in marks:
            errors.append(block.error(engine.nodes(), references[len(errors)]))
            if not errors[-1] < 10:
                break
    return np.array(taken[2:]), errors  # the first two compile, in Newton


def described(engine, options, block, dt):
    """What a row of the results says of a run."""
    return {
        "engine": engine.package,
        "law": engine.law,
        "scheme": options["scheme"],
        "tetrahedra": len(block.tetrahedra),
        "dt_ms": round(dt * 1e3, 6),
    }


def measured(kind, options, dt, block, references):
    """One row. Medians, and of a run that is shorter than a second the fastest of three: other programs disturb."""
    best = None
    for _ in range(3):
        engine = kind(block, dt, **options)
        taken, errors = motion(engine, block, dt, references(engine.law, kind.equal))
        if best is None or taken.mean() < best.mean():
            best = taken
        if taken.sum() > 1:
            break
    stable = len(errors) == len(TIMES) and all(each < 10 for each in errors) and not getattr(engine, "broken", bool)()
    return {
        **described(engine, options, block, dt),
        "median_ms": round(float(np.median(best)) * 1e3, 4),
        "p99_ms": round(float(np.percentile(best, 99)) * 1e3, 4),
        "seconds_per_second": round(float(np.median(best)) / dt, 4),
        "stable": stable,
        "errors": [finite(each) for each in errors] if stable else None,
    }


def references_of(block, cells):
    """A function that gives the converged motion of a law; and how far it is from that with half as many steps."""
    known, dt = {}, 1e-4

    def references(law, equal):
        if (law, equal) not in known:
            known[law, equal] = block.motion(law, TIMES, dt, equal)
        return known[law, equal]

    coarse = block.motion("neo-Hookean", TIMES, 2 * dt)
    fine = references("neo-Hookean", False)
    return references, max(block.error(*pair) for pair in zip(coarse, fine))


def rest(kind, options, how, block):
    """The error of the equilibrium that an engine comes to."""
    dt, damping, duration = how
    engine = kind(block, dt, damping=damping, **options)
    begin = time.perf_counter()
    for _ in range(round(duration / dt)):
        engine.step()
    seconds = time.perf_counter() - begin
    wanted = block.equilibrium(engine.law, kind.equal)
    return {
        **described(engine, options, block, dt),
        "damping_s": damping,
        "simulated_s": duration,
        "sag_mm": round(float((block.nodes - wanted)[:, 1].max()) * 1e3, 3),
        "error": finite(block.error(engine.nodes(), wanted)),
        "seconds": round(seconds, 3),
    }


# Many at once: each function makes `seconds` of `count` simulations and returns how long that took [s].


def many_filasofia(block, dt, count, seconds, **options):
    engines = [Filasofia(block, dt, **options) for _ in range(count)]

    def run(engine):
        for _ in range(round(seconds / dt / 10)):
            engine.sim.step(10)
            engine.nodes()

    begin = time.perf_counter()
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        list(pool.map(run, engines))
    return time.perf_counter() - begin


def many_mujoco(block, dt, count, seconds, scheme):
    from mujoco.batch import Batch

    batch = Batch(mujoco_model(block, dt, 0.0, scheme), count, nthread=2)
    nodes = batch.bind("flexvert_xpos")
    begin = time.perf_counter()
    for _ in range(round(seconds / dt / 10)):
        batch.step(nstep=10)
    assert nodes.shape[0] == count
    return time.perf_counter() - begin


def _bullet_worker(cells, dt, count, seconds, go):
    block = block_of(cells)
    engines = [PyBullet(block, dt) for _ in range(count)]
    go.wait()
    for _ in range(round(seconds / dt / 10)):
        for engine in engines:
            for _ in range(10):
                engine.step()
            engine.nodes()


def many_bullet(cells, dt, count, seconds):
    """It has no batches, and its module holds Python's lock: two processes."""
    import multiprocessing

    context = multiprocessing.get_context("spawn")
    go = context.Barrier(3)
    workers = [
        context.Process(target=_bullet_worker, args=(cells, dt, count // 2, seconds, go)) for _ in range(2)
    ]
    for worker in workers:
        worker.start()
    go.wait(120)
    begin = time.perf_counter()
    for worker in workers:
        worker.join()
    if any(worker.exitcode for worker in workers):
        raise RuntimeError("a worker failed")
    return time.perf_counter() - begin


def many_newton(block, dt, count, seconds):
    """One model of many bodies. Warp's kernels use one thread of the processor."""
    engine = Newton(block, dt, copies=count)
    for _ in range(2):
        engine.step()
    begin = time.perf_counter()
    for i in range(round(seconds / dt)):
        engine.step()
        if i % 10 == 0:
            engine.nodes()
    return time.perf_counter() - begin


def batches(versions, count, cells=CELLS[0]):
    block, rows = block_of(cells), []

    def row(engine, how, law, scheme, dt, seconds, act):
        if engine in versions:
            taken = act(seconds)
            rows.append(
                {
                    "engine": engine,
                    "how": how,
                    "law": law,
                    "scheme": scheme,
                    "dt_ms": round(dt * 1e3, 6),
                    "steps_per_second": round(count * seconds / dt / taken),
                    "simulated_seconds_per_second": round(count * seconds / taken, 2),
                }
            )
            print(rows[-1], file=sys.stderr, flush=True)

    for law in Filasofia.LAWS:
        for scheme, dt in (("implicit", 2e-3), ("explicit", 5e-4)):
            act = lambda s: many_filasofia(block, dt, count, s, law=law, scheme=scheme)  # noqa: B023, E731
            row("filasofia", "2 threads of Python", law, scheme, dt, 0.5, act)
    for scheme, dt in (("implicit", 2e-3), ("explicit", 5e-4)):
        act = lambda s: many_mujoco(block, dt, count, s, scheme)  # noqa: B023, E731
        row("mujoco", "mujoco.batch, 2 threads", MuJoCo.law, scheme, dt, 0.5, act)
    row("pybullet", "2 processes", PyBullet.law, "explicit", 5e-4, 0.25, lambda s: many_bullet(cells, 5e-4, count, s))
    row("newton", "one model, 1 thread", "neo-Hookean", "VBD", 2e-3, 0.2, lambda s: many_newton(block, 2e-3, count, s))
    return rows


def machine():
    names = [line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")]
    name = names[0].replace("(R)", "") if names else platform.machine()
    return f"{os.cpu_count()} cores of {name}, Python {platform.python_version()}; {datetime.date.today()}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", type=pathlib.Path, help="file of the results; without it they are only printed")
    parser.add_argument("--machine", default=machine(), help="what the results say of the machine")
    parser.add_argument("--simulations", type=int, default=16, help="at once")
    parser.add_argument("--small", action="store_true", help="only the smaller body")
    given = parser.parse_args()
    result = {"machine": given.machine, "missing": {}}
    result["versions"] = engines_here(result["missing"])
    result["cannot"] = {each.package: each.cannot for each in (MuJoCo, PyBullet, Newton)}
    result.update(reference_error=0.0, runs=[], rests=[])
    for cells in CELLS[: 1 if given.small else None]:
        block = block_of(cells)
        references, off = references_of(block, cells)
        result["reference_error"] = max(result["reference_error"], round(off, 8))
        for kind, options, steps in RUNS:
            for dt in steps if kind.package in result["versions"] else ():
                result["runs"].append(measured(kind, options, dt, block, references))
                print(result["runs"][-1], file=sys.stderr, flush=True)
        for kind, options, how in RESTS:
            if kind.package in result["versions"]:
                result["rests"].append(rest(kind, options, how, block))
                print(result["rests"][-1], file=sys.stderr, flush=True)
    result["simulations"] = given.simulations
    result["batches"] = batches(result["versions"], given.simulations)
    text = json.dumps(result, indent=2)
    print(text)
    if given.out:
        given.out.write_text(text + "\n")


if __name__ == "__main__":
    main()
