"""What a loop in Python costs: microseconds per call of Simulation.step(), over the same steps made in one call.

    python bench/python_steps.py        (the package must be installed)

The body is one tetrahedron: beside the steps of a large one, a microsecond is lost in the noise.
"""
import statistics
import time

import filasofia as fs

STEPS, ROUNDS = 2000, 15


def seconds(act):
    begin = time.perf_counter()
    act()
    return time.perf_counter() - begin


def loop(sim):
    for _ in range(STEPS):
        sim.step()


def loop_with_state(sim, body):
    for _ in range(STEPS):
        sim.step()
        sim.frame[body].positions


def measured(sim, body):
    """The median over rounds, each with all three ways one after another."""
    sim.step(200)
    inside, called, looked = [], [], []
    for _ in range(ROUNDS):
        inside.append(seconds(lambda: sim.step(STEPS)) / STEPS * 1e6)
        called.append(seconds(lambda: loop(sim)) / STEPS * 1e6)
        looked.append(seconds(lambda: loop_with_state(sim, body)) / STEPS * 1e6)
    one = statistics.median(inside)
    calls = statistics.median(c - i for c, i in zip(called, inside))
    state = statistics.median(s - c for s, c in zip(looked, called))
    print(f"a step {one:.2f} us; a call of step() adds {calls:.2f} us; the positions of its frame {state:.2f} us")


small = fs.Simulation(threads=1)
measured(small, small.add(fs.SoftBodyDef(mesh=fs.TetMesh(
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]]), attachments=[fs.AttachmentDef(nodes=[0, 1, 2])])))


def states(tetrahedra):
    """Saving and restoring a bunny that may be cut, beside a step."""
    sim = fs.Simulation(threads=1)
    sim.add(fs.SoftBodyDef(mesh=fs.asset(f"meshes/bunny_{tetrahedra}.msh"), dynamic_topology=True,
                           attachments=[fs.AttachmentDef(box=fs.Box((-1, 0.105, -1), (1, 1, 1)))]))
    sim.step(20)
    rows = []
    for _ in range(2 * ROUNDS):
        kept = []
        rows.append((seconds(lambda: kept.append(sim.save_state())), seconds(lambda: sim.restore(kept[0])), seconds(sim.step)))
    saved, restored, step = (1e3 * statistics.median(times) for times in zip(*rows))
    print(f"{tetrahedra} tetrahedra: save_state() {saved:.2f} ms, restore() {restored:.2f} ms, a step {step:.2f} ms")


for size in (3004, 10000, 30000):
    states(size)
