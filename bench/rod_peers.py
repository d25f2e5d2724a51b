"""A heavy rod that is clamped at one end and let go, in Filasofia, MuJoCo and Newton: time per step, and error.

    python3 bench/rod_peers.py [--cable]     (the packages filasofia, mujoco 4 and newton; with --cable mujoco 3)

Without damping the tip swings through nine tenths of the length of 2 m. The error is that of the tip at ten times in
the first second, root mean square, relative to the length, against Filasofia with four times as many edges and steps of
0.01 ms. MuJoCo and Newton are given the masses of the rod and their own clamps: in MuJoCo two pinned nodes, in Newton a
body without motion.
"""

import argparse
import math
import statistics
import time

LENGTH, RADIUS, DENSITY, GRAVITY = 2.0, 1e-2, 1000.0, 9.81  # m, m, kg/m^3, m/s^2
AREA = math.pi * RADIUS**2
BEND = DENSITY * AREA * GRAVITY * LENGTH**3 / 10.0  # N m^2: w L^3 / B = 10
YOUNG = BEND / (AREA * RADIUS**2 / 4.0)
POISSON = 0.4
SPAN, SAMPLES = 1.0, 10
EDGES = 50


def swing(step, tip, dt):
    """Tips at the times of the samples, and the median time of a step."""
    steps = round(SPAN / dt)
    tips, costs = [], []
    for i in range(1, steps + 1):
        begun = time.perf_counter()
        step()
        costs.append(time.perf_counter() - begun)
        if (i * SAMPLES) % steps == 0:
            tips.append(tip())
    return tips, statistics.median(costs)


def ours(edges, dt):
    import filasofia as fs

    sim = fs.Simulation(rate=1.0 / dt, gravity=(0, 0, -GRAVITY))
    edge = LENGTH / edges
    rod = sim.add(
        fs.RodBodyDef(
            points=[(-edge, 0, 0), (LENGTH, 0, 0)],
            spacing=edge,
            radius=RADIUS,
            young_modulus=YOUNG,
            poisson_ratio=POISSON,
            density=DENSITY,
            rayleigh=fs.Rayleigh(mass=0.0, stiffness=0.0),
            attachments=[fs.AttachmentDef(nodes=[0, 1])],
        )
    )
    return swing(sim.step, lambda: tuple(sim.frame[rod].positions[-1]), dt)


def mujoco(edges, dt):
    import mujoco as mj

    edge = LENGTH / edges
    nodes = edges + 2
    model = mj.MjModel.from_xml_string(f"""<mujoco>
<option timestep="{dt}" integrator="discrete" gravity="0 0 {-GRAVITY}"/>
<worldbody><body name="base"><flexcomp name="rod" type="grid" count="{nodes} 1 1" spacing="{edge} {edge} {edge}" dim="1"
  radius="{RADIUS}" mass="{DENSITY * AREA * edge * nodes}"><elasticity young="{YOUNG}" poisson="{POISSON}" damping="0"/>
  <edge equality="true" solref="{2.0 * dt} 1" solimp="0.9999 0.9999 0.001"/><contact selfcollide="none" contype="0" conaffinity="0"/><pin id="0 1"/></flexcomp></body></worldbody></mujoco>""")
    data = mj.MjData(model)
    mj.mj_forward(model, data)
    start = data.flexvert_xpos[1].copy()
    return swing(lambda: mj.mj_step(model, data), lambda: tuple(data.flexvert_xpos[-1] - start), dt)


def mujoco_cable(edges, dt):
    """The cable of MuJoCo up to 3.x: a chain of bodies with ball joints, whose stiffness is explicit."""
    import mujoco as mj

    edge = LENGTH / edges
    model = mj.MjModel.from_xml_string(f"""<mujoco>
<option timestep="{dt}" integrator="implicitfast" gravity="0 0 {-GRAVITY}"/><size memory="8M"/>
<extension><plugin plugin="mujoco.elasticity.cable"/></extension>
<worldbody><composite prefix="rod" type="cable" curve="s" count="{edges + 2} 1 1" size="{LENGTH + edge}" initial="none">
<plugin plugin="mujoco.elasticity.cable"><config key="bend" value="{YOUNG}"/>
<config key="twist" value="{YOUNG / (2.0 + 2.0 * POISSON)}"/></plugin><joint kind="main" damping="0"/>
<geom type="cylinder" size="{RADIUS}" density="{DENSITY}" contype="0" conaffinity="0"/></composite></worldbody></mujoco>""")
    data = mj.MjData(model)
    mj.mj_forward(model, data)

    def tip():
        body = model.nbody - 1
        return tuple(data.xpos[body] + edge * data.xmat[body].reshape(3, 3)[:, 0] - start)

    start = (edge, 0.0, 0.0)
    return swing(lambda: mj.mj_step(model, data), tip, dt)


def newton(edges, dt, iterations):
    import newton as nt
    import numpy as np
    import warp as wp

    wp.config.quiet = True
    edge = LENGTH / edges
    with wp.ScopedDevice("cpu"):
        builder = nt.ModelBuilder(gravity=(0.0, 0.0, -GRAVITY))
        rod = nt.Rod.create_straight(
            start=wp.vec3(-edge, 0.0, 0.0),
            direction=wp.vec3(1.0, 0.0, 0.0),
            length=LENGTH + edge,
            segment_count=edges + 1,
            radius=RADIUS,
            youngs_modulus=YOUNG,
            poissons_ratio=POISSON,
        )
        bodies, _ = builder.add_rod(rod=rod, wrap_in_articulation=True)
        mass = DENSITY * AREA * edge
        across = mass * (edge**2 / 12.0 + RADIUS**2 / 4.0)
        for i, body in enumerate(bodies):  # its capsules have caps, which lie in each other
            fixed = i == 0
            builder.body_mass[body] = 0.0 if fixed else mass
            builder.body_inv_mass[body] = 0.0 if fixed else 1.0 / mass
            turn = np.diag([across, across, 0.5 * mass * RADIUS**2])
            builder.body_inertia[body] = wp.mat33(0.0) if fixed else wp.mat33(turn)
            builder.body_inv_inertia[body] = wp.mat33(0.0) if fixed else wp.mat33(np.linalg.inv(turn))
        builder.color()
        model = builder.finalize()
        solver = nt.solvers.SolverVBD(model, iterations=iterations)
        states = [model.state(), model.state()]
        control = model.control()

        def step():
            states[0].clear_forces()
            solver.step(states[0], states[1], control, None, dt)
            states.reverse()

        def tip():
            x, y, z, qx, qy, qz, qw = states[0].body_q.numpy()[bodies[-1]].astype(float)
            along = (2 * (qx * qz + qw * qy), 2 * (qy * qz - qw * qx), 1 - 2 * (qx * qx + qy * qy))
            return tuple(p + 0.5 * edge * a for p, a in zip((x, y, z), along))

        return swing(step, tip, dt)


def error(tips, reference):
    return math.sqrt(sum(math.dist(a, b) ** 2 for a, b in zip(tips, reference)) / len(reference)) / LENGTH


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cable", action="store_true", help="MuJoCo's cable instead, with a MuJoCo before 4.0")
    args = parser.parse_args()
    large, small = (5e-3, 2e-3, 1e-3, 5e-4), (2e-4, 1e-4)
    runs = [("Filasofia", ours, large + small)]
    if args.cable:
        runs.append(("MuJoCo's cable", mujoco_cable, large + small))
    else:
        runs.append(("MuJoCo", mujoco, large + small))
        runs += [(f"Newton, {n} iterations", lambda edges, dt, n=n: newton(edges, dt, n), large) for n in (10, 50)]
    reference, _ = ours(4 * EDGES, 1e-5)
    for name, run, sizes in runs:
        for dt in sizes:
            tips, cost = run(EDGES, dt)
            print(f"{name:24} {1e3 * dt:6.2f} ms   {1e3 * cost:8.3f} ms   error {error(tips, reference):.2e}", flush=True)


if __name__ == "__main__":
    main()
