"""A program that uses the package as its users do; test_types.py gives it to mypy, and nobody runs it."""
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import filasofia as fs
from filasofia import batch, gym


def scene(stiffness: float) -> tuple[fs.Simulation, fs.BodyId]:
    material = fs.FemMaterial(young_modulus=stiffness, poisson_ratio=0.45, law=fs.Fung(exponent=5))
    sim = fs.Simulation(rate=1000, threads=1, gravity=(0, -9.81, 0))
    body = sim.add(
        fs.SoftBodyDef(
            name="tissue",
            pose=(0, 0.1, 0),
            mesh=fs.shapes.block((0.06, 0.03, 0.06), (5, 3, 5)),
            material=material.replace(young_modulus=2 * stiffness),
            attachments=[fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, -0.0149, 1)))],
            collision=[fs.CollisionDef()],
        )
    )
    return sim, body


def frames() -> NDArray[np.float64]:
    sim, body = scene(10e3)
    ball = sim.add(fs.RigidBodyDef(name="ball", elements=[(0, 0.025, 0)], mesh=fs.shapes.sphere(0.008)))
    touches: list[fs.ContactEvent] = []
    number = sim.on(fs.ContactEvent, touches.append)
    script = sim.every_step(lambda time: sim.set_pose(ball, (0, 0.025 - 0.1 * time, 0)))
    report: fs.StepReport = sim.step(10)
    if fs.StepFlag.INVERTED in report.flags:
        print(report.inverted.count)
    run: fs.RunReport = sim.run(0.01)
    print(run.steps, run.wall_seconds)
    frame: fs.Frame = sim.frame
    soft = frame[body]
    assert isinstance(soft, fs.SoftBodyFrame)
    loads: NDArray[np.float64] = frame.contacts["normal_force"]
    print(loads.sum(), len(touches), soft.velocities.shape)
    sim.off(number)
    sim.off(script)
    state = sim.save_state()
    sim.restore(state)
    grasp = sim.grasp(ball, body)
    sim.release(grasp)
    definition = sim.definition(body)
    print(definition)
    return soft.positions


def arrays(sim: fs.Simulation, tissue: fs.BodyId, ball: fs.BodyId) -> None:
    place = np.zeros(3)
    held = fs.AttachmentDef(nodes=np.arange(3))
    held.nodes = np.arange(4)
    nodes: list[int] = held.nodes
    sim.add(fs.SoftBodyDef(name="second", mesh=fs.shapes.block(np.ones(3)), pose=place, attachments=[held]))
    sim.add(fs.RodBodyDef(points=np.zeros((3, 3))))
    sim.add(fs.RigidBodyDef(elements=[place], mesh=fs.shapes.sphere(0.1), velocity=place))
    sim.add(fs.RigidBodyDef(elements=np.zeros((2, 3)), mesh=fs.shapes.sphere(0.1)))
    sim.set_pose(ball, np.zeros(7))
    sim.set_gravity(np.array([0.0, -9.81, 0.0]))
    sim.set_forces(tissue, np.zeros((1, 3)), [0])
    sim.set_forces(tissue, [[0, 0, 1.0]], np.arange(1))
    sim.step(10, moves={ball: place})
    sim.on(fs.ContactEvent, lambda event: print(event.force[0], event.time))
    print(sim.render(pose=place), fs.look_at(place, np.ones(3)), nodes)


def instruments(sim: fs.Simulation, tissue: fs.BodyId) -> None:
    definition = fs.ArticulatedInstrumentDef(kind="ultrasonicShears", opening=1, pose=fs.Pose((0, 0.1, 0)))
    tool = fs.ArticulatedInstrument(sim, definition)
    shears = fs.UltrasonicShears(sim, tool, fs.UltrasonicShearsDef(parting=0.5))
    tool.move((0, 0.05, 0))
    tool.close(torque=0.02)
    shears.press(True)
    suction = fs.SuctionIrrigator(sim, fs.ArticulatedInstrument(sim))
    suction.rinse(False)
    loop = fs.WireLoop(sim)
    loop.move(tool.pose)
    clips = fs.ClipApplier(sim, tool, fs.ClipApplierDef(targets=[tissue]))
    held: fs.BodyId | None = tool.holding
    line: NDArray[np.float64] = loop.line
    together: bool = tissue in sim.frame and sim.frame.connected(tool.body, tissue)
    grasper = fs.LaparoscopicInstrument(sim, fs.LaparoscopicInstrumentDef(trocar=fs.TrocarDef(friction=1)))
    grasper.move(grasper.pose_at((0, 0, -0.1), roll=0.1))
    scope = fs.Laparoscope(sim)
    scope.soil(mist=0.5)
    force: NDArray[np.float64] = grasper.report.force
    hands = fs.TrocarHands(sim, grasper, fs.LaparoscopicInstrument(sim), scope, fs.TrocarHandsDef(gain=0.001))
    wanted: tuple[fs.TrocarPose, fs.TrocarPose, fs.TrocarPose] = hands.wanted
    hysteroscope = fs.Endoscope(sim, fs.EndoscopeDef(inclination=0.2))
    hysteroscope.roll(0.1)
    print(wanted, hysteroscope.tip.position, hysteroscope.channel, hysteroscope.lens.smear)
    print(force, grasper.tool.opening, scope.lens.mist, scope.camera.position, scope.definition.zoom)
    print(held, line, together, clips.left, shears.parted, suction.irrigated, loop.CUTS, loop.definition.width)


def pictures(sim: fs.Simulation) -> None:
    picture: fs.Picture = sim.render(320, 240, pose=fs.look_at((0, 0.1, 0.2), (0, 0, 0)), camera=fs.CameraDef(near=0.001))
    picture.save("picture.png")
    depth, bodies = sim.render_depth(320, 240)
    print(depth[bodies == 1].min())
    film: fs.Film = sim.film(0.1, fps=50)
    first: fs.Picture = film[0]
    print(first.shape, film[::2].strip(3).shape)
    with fs.viewer.launch_passive(sim) as viewer:
        viewer.sync()


def learn() -> float:
    env = gym.TissueRetraction(difficulty=1, observation="state")
    seen, info = env.reset(seed=0)
    total = 0.0
    for _ in range(10):
        seen, reward, terminated, truncated, info = env.step(env.action_space.sample())
        total += reward
        if terminated or truncated:
            break
    print(seen, info["is_success"])
    env.close()
    envs = gym.VectorEnv(gym.Reach, 2, autoreset_mode="SameStep", difficulty=1)
    envs.reset(seed=0)
    envs.close()
    return total


class Press(gym.SurgicalEnv):
    def build(self) -> list[gym.Tool]:
        self.tissue = self.block("tissue", (0.06, 0.03, 0.06), (5, 3, 5))
        start = (0.0, 0.025, 0.0)
        return [gym.Tool(self.tip("tip", start), start, low=(-0.02, 0.005, -0.02), high=(0.02, 0.04, 0.02))]

    def judge(self) -> gym.Judgement:
        force = float(self.sim.frame.contacts["normal_force"].sum())
        return gym.Judgement({"force": -force}, force < 0.01, {"force": force})


def session(depth: float) -> dict[str, float]:
    sim, body = scene(depth)
    sim.run(0.1)
    soft = sim.frame[body]
    return {"lowest": float(soft.positions[:, 1].min())}


def many() -> None:
    jobs = batch.grid(depth=[0.001, 0.002])
    table = batch.run(session, jobs, "press.parquet", workers=2, retries=1)
    print(table.num_rows)


def tissues() -> None:
    tilted: fs.Pose = fs.RigidBodyDef(elements=[(0, 0, 0)]).elements[0]
    x, y, z = tilted.position
    print(x + y + z, fs.TissueMaterial(base_color=(0.9, 0.6, 0.3)).base_color.red)
    liver = fs.tissue("liver")
    liver.material.regions.append(fs.TissueRegion(where=fs.Ball((0, 0.05, 0), 0.01), young_modulus=60e3))
    mesh = fs.TetMesh(nodes=[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], tetrahedra=[[0, 1, 2, 3]])
    print(mesh.nodes.shape, fs.__version__, fs.asset("meshes/bunny.obj"))
    try:
        fs.load("scene.json", threads=1)
        fs.replay(file="run.rec", check=True)
    except fs.Error as problem:
        print(problem)


if __name__ == "__main__":
    frames()
    instruments(*scene(1e4))
    pictures(scene(1e4)[0])
    learn()
    many()
    tissues()
