"""Bodies, steps, commands, events and reports."""
import logging
import os
import subprocess
import threading

import numpy as np
import pytest

import filasofia as fs
from scenes import ball, block, bunny, poke


def test_the_readmes_bunny_has_the_hash_of_the_same_program_in_cpp():
    program = os.environ["FILASOFIA_BUNNY"]  # scripts/test_python.sh builds it
    done = subprocess.run([program, "--headless", "--steps", "100"], stdout=subprocess.PIPE, text=True, check=True, timeout=300)
    words = done.stdout.split()
    expected = words[words.index("hash") + 1]
    sim = fs.Simulation(rate=1000, slack=2e-3)
    sim.add(bunny())
    for _ in range(100):
        sim.step()
    assert fs.hexadecimal(sim.state_hash) == expected


def test_a_sheet_falls_onto_tissue_and_a_fem_material_for_it_is_an_error():
    sheet = fs.SoftBodyDef(
        name="sheet",
        mesh=fs.shapes.sheet(0.04, 0.04, (8, 8)),
        pose=(0, 0.018, 0),
        material=fs.ShellMaterial(young_modulus=50e3, thickness=0.5e-3),
        collision=[fs.CollisionDef()],
    )
    sim = fs.Simulation(rate=500)
    sim.add(block())
    fallen = sim.add(sheet)
    sim.run(0.4)
    positions = sim.frame[fallen].positions
    assert positions.shape == (81, 3)
    assert 0.0145 < positions[:, 1].min() < positions[:, 1].max() < 0.018
    assert len(sim.frame.contacts) > 10
    with pytest.raises(fs.Error, match="sheet"):
        sim.add(sheet.replace(material=fs.FemMaterial()))


def test_steps_in_one_call_and_one_by_one_with_any_threads_are_the_same():
    hashes = set()
    for threads, calls in ((1, [40]), (2, [40]), (1, [1] * 40), (1, [7, 33])):
        sim, _, tool = poke(threads)
        sim.every_step(lambda t, sim=sim, tool=tool: sim.set_pose(tool, (0, 0.025 - 0.2 * t, 0)))
        for n in calls:
            sim.step(n)
        assert sim.steps == 40 and sim.time == pytest.approx(0.04)
        hashes.add(sim.state_hash)
    assert len(hashes) == 1


def test_bodies_move_straight_while_steps_are_made():
    half = fs.axis_angle((0, 1, 0), 0.5)
    hashes = set()
    for moves in (True, False):
        sim, _, tool = poke()
        sim.step()
        start = sim.frame[tool].poses[0, :3].copy()
        end = np.array([0.001, 0.02, 0.0005])
        seen = []
        sim.on(fs.PhysicsUpdateEvent, lambda e: seen.append(sim.frame[tool].poses[0].copy()))
        if moves:
            sim.step(8, {tool: fs.Pose(end, half)})
        for i in range(0 if moves else 8):
            part = (i + 1) / 8
            place = start + part * (end - start) if i < 7 else end
            sim.set_pose(tool, fs.Pose(place, fs.axis_angle((0, 1, 0), part * 0.5) if i < 7 else half))
            sim.step()
        assert np.array_equal(seen[-1][:3], end) and np.allclose(seen[3][:3], start + 0.5 * (end - start), atol=1e-15)
        assert np.allclose(seen[3][3:], fs.axis_angle((0, 1, 0), 0.25), atol=1e-15)
        sim.step(4, moves={tool: end})  # a position alone: no rotation
        assert np.allclose(seen[-1][3:], (1, 0, 0, 0))
        assert len(sim.frame.contacts) > 0
        hashes.add(sim.frame[tool].poses.tobytes())
    assert len(hashes) == 1


def test_moves_before_the_first_step_begin_where_a_body_starts():
    sim, _, tool = poke()
    start = np.array(sim.definition(tool).elements[0].position)
    seen = []
    sim.on(fs.PhysicsUpdateEvent, lambda e: seen.append(sim.frame[tool].poses[0, :3].copy()))
    sim.step(2, {tool: tuple(start + (0.002, 0, 0))})
    assert np.allclose(seen, [start + (0.001, 0, 0), start + (0.002, 0, 0)], atol=1e-15)


def test_moves_that_are_wrong_move_nothing():
    sim, tissue, tool = poke()
    sim.step()
    stone = sim.add(fs.RigidBodyDef(name="stone", mesh=fs.shapes.box((0.01,) * 3), dynamic=True, elements=[(1, 1, 1)]))
    sim.step()
    before = sim.state_hash
    for moves, kind, words in (
        ({tissue: (0, 0, 0)}, fs.Error, "must have kinematic bodies as keys"),
        ({stone: (0, 0, 0)}, fs.Error, "must have kinematic bodies as keys"),
        ({tool: (0, float("nan"), 0)}, fs.Error, "a pose of moves"),
        ({tool: (0, 0)}, (fs.Error, TypeError), "a pose of moves"),
        ({"tool": (0, 0, 0)}, TypeError, "the key of moves"),
        ([(tool, (0, 0, 0))], TypeError, "must be a dict of poses by bodies"),
    ):
        with pytest.raises(kind, match=words):
            sim.step(3, moves)
        assert sim.state_hash == before


def test_a_step_reports():
    sim, tissue, _ = poke()
    report = sim.step()
    assert (report.step, report.time, report.dt) == (1, pytest.approx(1e-3), pytest.approx(1e-3))
    assert report.flags == fs.StepFlag(0) and isinstance(report.flags, fs.StepFlag)
    assert report.solves[0].body == tissue and report.solves[0].iterations > 0
    assert report.topology.ruptures == [] and report.contacts.active == 0
    assert "StepReport(step=1" in repr(report)
    assert "INVERTED" in repr(fs.StepFlag.INVERTED) and "INVERTED" in str(fs.StepFlag.INVERTED)
    assert fs.StepFlag.DAMPED | fs.StepFlag.UNDONE == fs.StepFlag((1 << 8) | (1 << 3))


def test_flags_tell_of_a_grasp_that_touches_nothing():
    sim, tissue, tool = poke()
    sim.grasp(tool, tissue)
    assert fs.StepFlag.NOTHING_ATTACHED in sim.step().flags


def test_run_makes_the_steps_of_a_time_and_reports():
    sim, _, _ = poke(rate=500)
    assert sim.dt == pytest.approx(2e-3)
    report = sim.run(0.1)
    assert report.steps == sim.steps == 50
    assert report.hash == sim.state_hash
    assert fs.hexadecimal(report.hash) in str(report)
    assert report.undone == 0 and report.wall_seconds > 0
    assert report.warnings == []


def test_a_body_whose_state_is_not_finite_is_named():
    sim, tissue, _ = poke()
    sim.step()
    sim.set_forces(tissue, np.full(sim.frame[tissue].positions.shape, 1e300))
    assert sim.step().undone == [tissue]
    report = sim.report()
    assert report.undone_body == "block"
    assert report.warnings[0].startswith("a new state was not finite and was rolled back in 1 step, first of 'block'")


def test_calls_of_run_lose_no_time():
    """Each was rounded to whole steps: 60 of a sixtieth of a second made 1.02 s."""
    for seconds, calls in ((1 / 60, 60), (0.0014, 100), (0.0003, 50), (0.1, 3)):
        sim = fs.Simulation(rate=1000)
        for _ in range(calls):
            report = sim.run(seconds)
        assert sim.steps == report.steps == round(seconds * calls * 1000)
    sim = fs.Simulation(rate=1000)
    sim.run(0.0014)
    state = sim.save_state()
    for _ in range(2):  # what is owed is a part of the state
        sim.restore(state)
        sim.run(0.0014)
        assert sim.steps == 3
    assert fs.Simulation(rate=1000).run(0.0002).steps == 0
    with pytest.raises(fs.Error, match="run: seconds must be in"):
        sim.run(0)


def test_a_minute_at_any_rate_is_one():
    for rate in (30_000, 1000, 60):
        sim = fs.Simulation(rate=rate)
        sim.step(rate)
        assert sim.dt == 1 / rate and sim.time == pytest.approx(1, abs=1e-10)  # 33,333 ns each made 10 us less


def test_the_net_contact_force_carries_the_weight():
    sim = fs.Simulation(rate=1000, threads=1)
    floor = sim.add(
        fs.RigidBodyDef(elements=[(0, -0.01, 0)], mesh=fs.shapes.box((0.3, 0.02, 0.3)), collision=[fs.CollisionDef()])
    )
    boxes = []
    for x in (-0.05, 0.05):
        box = fs.shapes.box((0.02, 0.02, 0.02))
        boxes.append(
            sim.add(
                fs.RigidBodyDef(
                    elements=[(x, 0.0102, 0)],
                    mesh=box,
                    dynamic=True,
                    mass=fs.TotalMass(0.1 + x),
                    collision=[fs.CollisionDef()],
                )
            )
        )
    sim.run(0.5)
    frame = sim.frame
    for box, mass in zip(boxes, (0.05, 0.15)):
        force = frame.contact_force(box)
        assert force.shape == (3,) and np.allclose(force, (0, 9.81 * mass, 0), atol=2e-3)
        assert np.array_equal(frame.contact_force(floor, by=box), -force)
        # the same by hand, as the guide says
        total = np.zeros(3)
        for each in frame.contacts:
            on_first = each["normal_force"] * each["normal"] + each["friction"]
            total += on_first * ((each["first"] == box) - 1.0 * (each["second"] == box))
        assert np.allclose(total, force, atol=1e-12)
    assert not frame.contact_force(boxes[0], by=boxes[1]).any()
    assert np.allclose(frame.contact_force(floor), (0, -9.81 * 0.2, 0), atol=4e-3)
    with pytest.raises(fs.Error, match="contact_force: by must be a body of the frame of step 500, got 9"):
        frame.contact_force(floor, by=fs.BodyId(9))


def test_nodal_forces_may_be_arrays():
    hashes = []
    forces = np.random.default_rng(0).normal(0, 1e-3, (5, 3))
    nodes = [3, 50, 7, 80, 100]
    for how in ("list", "arrays", "lists", "first", "mask"):
        sim, tissue, _ = poke()
        if how == "list":
            sim.set_forces(tissue, [fs.NodalForce(node=i, force=f) for i, f in zip(nodes, forces)])
        elif how == "arrays":
            sim.set_forces(tissue, forces, np.array(nodes))
        elif how == "lists":
            sim.set_forces(tissue, forces.tolist(), nodes=nodes)
        elif how == "mask":
            mask = np.zeros(144, bool)
            mask[nodes] = True
            sim.set_forces(tissue, forces[np.argsort(nodes)], mask)
        else:
            all_ = np.zeros((101, 3))
            all_[nodes] = forces
            sim.set_forces(tissue, all_)
        sim.step(20)
        hashes.append(sim.state_hash)
        positions = sim.frame[tissue].positions
        sim.set_forces(tissue, np.zeros((0, 3)))
        sim.step()
        assert not np.array_equal(sim.frame[tissue].positions, positions)
    assert hashes[0] == hashes[1] == hashes[2] == hashes[4]
    with pytest.raises(fs.Error, match="set_forces: nodes must be as many as the rows of forces, 5, got 4"):
        sim.set_forces(tissue, forces, nodes[:4])
    with pytest.raises(fs.Error, match="set_forces: forces"):
        sim.set_forces(tissue, forces[:, :2])
    for wrong in (mask[:-1], mask.reshape(12, 12)):
        with pytest.raises(fs.Error, match="a mask with a truth value for each of the body's 144 nodes, got a mask of the shape"):
            sim.set_forces(tissue, forces, wrong)
    with pytest.raises(fs.Error, match="nodes must be as many as the rows of forces, 5, got 144"):
        sim.set_forces(tissue, forces, np.ones(144, bool))
    with pytest.raises(TypeError, match=r"nodes.* must be a whole number \(numpy.flatnonzero\(\) makes indices of a mask\), got False"):
        fs.AttachmentDef(nodes=mask)


def test_the_mechanical_energy_of_a_body():
    sim = fs.Simulation(rate=1000)
    body = sim.add(fs.SoftBodyDef(mesh=fs.shapes.block((0.02, 0.03, 0.04)), rayleigh=fs.Rayleigh(mass=0), pose=(0, 0.5, 0)))
    with pytest.raises(fs.Error, match="mechanical_energy: body 1 is there only after the next step"):
        sim.mechanical_energy(body)
    with pytest.raises(fs.Error, match="9"):
        sim.mechanical_energy(fs.BodyId(9))
    sim.step(200)
    energy, mass = sim.mechanical_energy(body), 1000 * 0.02 * 0.03 * 0.04
    assert energy.kinetic == pytest.approx(0.5 * mass * (9.81 * 0.2) ** 2, rel=1e-5)
    assert energy.gravitational == pytest.approx(mass * 9.81 * sim.frame[body].positions[:, 1].mean(), rel=1e-2)
    assert abs(energy.elastic) < 1e-6 * energy.kinetic
    assert repr(energy).startswith("MechanicalEnergy(kinetic=")
    with pytest.raises(fs.Error, match="mechanical_energy"):  # a callback of a step asks
        sim.every_step(lambda time: sim.mechanical_energy(body))
        sim.step()


def test_a_spring_draws_a_joint_with_bounded_force():
    sim = fs.Simulation(rate=1000)
    spring = fs.JointSpring(value=0.2, stiffness=0.05, damping=1e-3, strength=0.01)
    link = fs.JointDef(command=spring, mass=fs.GivenInertia(mass=0.02, moments=(2e-5, 2e-5, 2e-5)))
    jaw = sim.add(fs.RigidBodyDef(name="jaw", gravity=False, articulation=fs.ArticulationDef(joints=[link])))
    sim.step(1000)
    assert sim.frame[jaw].joints["position"][0] == pytest.approx(0.2, abs=1e-6)
    sim.set_joint(jaw, 0, fs.JointSpring(value=-50, stiffness=0.05, strength=0.002))
    sim.step()
    assert sim.frame[jaw].joints["force"][0] == pytest.approx(-0.002)
    with pytest.raises(fs.Error, match="JointSpring: stiffness must be >= 0 N m/rad or N/m, got -1"):
        sim.set_joint(jaw, 0, fs.JointSpring(stiffness=-1))


def test_bodies_and_joints_start_with_velocities(tmp_path):
    def scene():
        sim = fs.Simulation(rate=1000, gravity=(0, 0, 0))
        free = dict(rayleigh=fs.Rayleigh(mass=0, stiffness=0), velocity=(0.3, 0, -0.1))
        sim.add(fs.SoftBodyDef(mesh=fs.shapes.block((0.02, 0.02, 0.02)), **free))
        sim.add(fs.SoftBodyDef(mesh=fs.shapes.sheet(0.04, 0.04, (4, 4)), material=fs.ShellMaterial(), **free))
        sim.add(fs.RodBodyDef(points=[(0, 1, 0), (0.1, 1, 0)], spacing=0.01, **free))
        link = fs.JointDef(command=fs.JointForce(), velocity=2.0, mass=fs.GivenInertia())
        sim.add(fs.RigidBodyDef(articulation=fs.ArticulationDef(joints=[link])))
        return sim

    sim = scene()
    sim.record(tmp_path / "run.rec")
    for _ in range(2):
        sim.step()
        for body in sim.bodies[:3]:
            assert np.allclose(sim.frame[body].velocities, (0.3, 0, -0.1), atol=1e-6)
        assert sim.frame[sim.bodies[3]].joints["velocity"][0] == pytest.approx(2.0)
        sim.step(50)
        sim.set_forces(sim.bodies[0], [fs.NodalForce(node=0, force=(1, 0, 0))])
        sim.step(5)
        sim.set_forces(sim.bodies[0], [])
        sim.reset()
    sim.close()
    assert fs.replay(file=tmp_path / "run.rec", check=True).different_step is None


def test_lines_of_the_log_go_where_they_are_sent(capfd, caplog):
    def lonely():
        sim = fs.Simulation()
        sim.add(fs.RigidBodyDef(name="floor", mesh=fs.shapes.box((1, 0.1, 1))))
        sim.add(
            fs.RigidBodyDef(name="box", mesh=fs.shapes.box((0.1,) * 3), dynamic=True, collision=[fs.CollisionDef()])
        )
        sim.step()

    words = "rigid body 'box': no other body has collision group 0: it collides with nothing"
    lines = []
    try:
        fs.log_to(lambda level, line: lines.append((level, line)))
        lonely()
        assert lines == [(logging.WARNING, words)]
        fs.log_to(logging.getLogger("filasofia"))
        thread = threading.Thread(target=lonely)
        thread.start()
        thread.join()
        assert caplog.record_tuples == [("filasofia", logging.WARNING, words)]
        assert capfd.readouterr().err == ""
    finally:
        fs.log_to(None)
    lonely()
    assert words in capfd.readouterr().err and len(lines) == 1

    def broken(level, line):
        raise ValueError("no room")

    try:
        fs.log_to(broken)
        lonely()
    finally:
        fs.log_to(None)
    said = capfd.readouterr().err
    assert said.startswith("filasofia: log_to: <function ") and said.endswith(f" raised ValueError: no room; the line was: {words}\n")
    with pytest.raises(TypeError, match="log_to: the receiver must be a logging.Logger, a function or None, got 5"):
        fs.log_to(5)


def test_tools_that_do_not_collide_are_not_told_so(capfd):
    """A vessel that a clip is for, and a knife for a body without collision models, were said to collide with nothing."""
    for gravity in ((0, -9.81, 0), (0, 0, 0)):
        sim = fs.Simulation(gravity=gravity)
        sim.add(block(collision=[], dynamic_topology=True))
        sheet = fs.TriangleMesh(vertices=[[0, 0, 0], [0, 0, 0.1], [0, 0.05, 0]], triangles=[[0, 1, 2]])
        cutting = [fs.CollisionDef(mesh=sheet, cutting=True)]
        sim.add(fs.RigidBodyDef(name="knife", elements=[(0, 0.1, 0)], mesh=sheet, collision=cutting))
        sim.step()
    sim = fs.Simulation()
    sim.add(block(collision=[]))
    sim.add(ball())
    sim.step()
    assert capfd.readouterr().err == ""


def test_reports_print_their_fields():
    sim, _, _ = poke()
    report = sim.step()
    assert repr(report.solves[0]).startswith("BodySolve(body=BodyId(1), together=")
    assert repr(report.contacts).startswith("ContactReport(found=")
    assert repr(sim.frame) == "Frame(step=1, time=0.001)"
    assert repr(sim.save_state()).startswith("SavedState(time=0.001, steps=1")
    assert repr(fs.tissue("liver")).startswith("Tissue(name='liver'")
    kinds = [each for each in vars(fs._core).values() if isinstance(each, type) and each not in fs._log._LIVE]
    assert all(each.__repr__ is not object.__repr__ for each in kinds)


def test_contacts_come_as_events_and_in_the_report():
    sim, tissue, tool = poke()
    touches, updates = [], []
    sim.on(fs.ContactEvent, touches.append)
    observer = sim.on(fs.PhysicsUpdateEvent, updates.append)
    sim.every_step(lambda t: sim.set_pose(tool, (0, 0.025 - min(0.1 * t, 0.02 - 0.1 * t), 0)))
    sim.step(100)
    sim.off(observer)
    sim.step(100)
    assert [e.kind for e in touches if e.kind != "persist"] == ["begin", "end"]
    assert {touches[0].first, touches[0].second} == {tissue, tool}
    deepest = max(touches, key=lambda e: e.normal_force)
    assert deepest.normal_force > 0.1 and deepest.contacts > 0
    assert abs(deepest.force[1]) == pytest.approx(deepest.normal_force, rel=0.2)
    assert len(updates) == 100 and updates[-1].step == 100
    (pair,) = sim.report().contacts
    assert {pair.first, pair.second} == {"block", "ball"}
    assert pair.max_normal_force == pytest.approx(deepest.normal_force)
    with pytest.raises(fs.Error, match="no observer"):
        sim.off(observer)


def test_commands_given_in_a_callback_reach_the_next_step():
    sim, tissue, tool = poke()
    sim.on(fs.PhysicsUpdateEvent, lambda e: sim.set_pose(tool, (0, 0.025 + 0.001 * e.step, 0)))
    sim.step(3)
    assert sim.frame[tool].poses[0, 1] == pytest.approx(0.027)  # of step 2's event


def test_a_blade_cuts_and_the_event_says_how_much():
    sim = fs.Simulation(threads=1, gravity=(0, 0, 0))
    skin = sim.add(
        fs.SoftBodyDef(
            name="skin",
            mesh=fs.shapes.block((0.04, 0.01, 0.02), (8, 2, 4)),
            attachments=[fs.AttachmentDef(box=fs.Box((-1, -1, -1), (-0.0199, 1, 1)))],
            dynamic_topology=True,
        )
    )
    plane = fs.TriangleMesh([[0, -0.02, -0.02], [0, -0.02, 0.02], [0, 0.005, 0.02], [0, 0.005, -0.02]], [[0, 1, 2], [0, 2, 3]])
    knife = sim.add(
        fs.RigidBodyDef(name="knife", elements=[(0.0011, 0.03, 0)], mesh=plane, collision=[fs.CollisionDef(cutting=True)])
    )
    cuts = []
    sim.on(fs.CutEvent, cuts.append)
    sim.every_step(lambda t: sim.set_pose(knife, (0.0011, 0.03 - t, 0)))
    sim.step(60)
    assert sum(cut.rupture.area for cut in cuts) == pytest.approx(2e-4, rel=0.2)  # 10 mm x 20 mm
    assert all(cut.rupture.kind == "cut" and cut.rupture.body == skin for cut in cuts)
    pieces = [piece for cut in cuts for piece in cut.rupture.detached]
    assert len(pieces) == 1 and pieces[0].mass == pytest.approx(8e-3 / 2, rel=0.2) and not pieces[0].held
    body = sim.frame[skin]
    assert body.revision > 0 and body.boundary.max() < len(body.positions)
    sim.remove_piece(skin, pieces[0].piece)
    sim.step()


COMMANDS = [
    lambda sim, tissue, tool: sim.set_gravity((0, 0, 0)),
    lambda sim, tissue, tool: sim.set_pose(tool, fs.Pose((0, 0.1, 0))),
    lambda sim, tissue, tool: sim.set_material(tissue, fs.FemMaterial(young_modulus=50e3)),
    lambda sim, tissue, tool: sim.set_tissue(tissue, fs.TissueRegion(where=fs.Ball(radius=0.05), young_modulus=90e3)),
    lambda sim, tissue, tool: sim.set_forces(tissue, [fs.NodalForce(node=140, force=(1, 0, 0))]),
    lambda sim, tissue, tool: sim.set_pressure(tissue, 100.0),
    lambda sim, tissue, tool: sim.attach(tissue, fs.AttachmentDef(nodes=[140], to=tool, stiffness=10)),
    lambda sim, tissue, tool: sim.release(sim.attachments(tissue)[0]),
    lambda sim, tissue, tool: sim.remove(tissue),
    lambda sim, tissue, tool: sim.apply(fs.SetPressure(tissue, 100.0)),
    lambda sim, tissue, tool: sim.apply(fs.SetGravity((0, -1, 0))),
    lambda sim, tissue, tool: sim.apply(fs.RemoveBody(tool)),
    lambda sim, tissue, tool: sim.apply(fs.SetMaterial(tissue, fs.FemMaterial(young_modulus=50e3))),
    lambda sim, tissue, tool: sim.apply(fs.Release(sim.attachments(tissue)[0])),
]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_changes_the_state(command):
    def after(act):
        sim, tissue, tool = poke()
        sim.step(3)
        act(sim, tissue, tool)
        sim.step(3)
        return sim.state_hash

    assert after(command) != after(lambda *_: None)


def test_commands_and_their_defs_do_the_same():
    def after(act):
        sim, tissue, tool = poke()
        act(sim, tissue, tool)
        sim.step(5)
        return sim.state_hash

    pin = fs.AttachmentDef(nodes=[9])
    pairs = [
        (lambda s, a, b: s.set_pose(b, (0, 0.02, 0)), lambda s, a, b: s.apply(fs.SetPose(b, pose=(0, 0.02, 0)))),
        (lambda s, a, b: s.attach(a, pin), lambda s, a, b: s.apply(fs.Attach(body=a, def_=pin))),
        (lambda s, a, b: s.pause(), lambda s, a, b: s.apply(fs.Pause())),
        (lambda s, a, b: s.reset(), lambda s, a, b: s.apply(fs.Reset())),
        (lambda s, a, b: s.grasp(b, a), lambda s, a, b: s.apply(fs.Grasp(None, b, a))),
    ]
    for method, def_ in pairs:
        assert after(method) == after(def_)


def test_joints_wrenches_and_hands():
    sim = fs.Simulation(threads=1, gravity=(0, 0, 0))
    arm = sim.add(fs.RigidBodyDef(name="arm", articulation=fs.ArticulationDef(joints=[fs.JointDef(lower=-1, upper=1)])))
    cube = sim.add(fs.RigidBodyDef(name="cube", dynamic=True, mesh=fs.shapes.box((0.01, 0.01, 0.01)), elements=[(1, 0, 0)]))
    held = sim.add(fs.RigidBodyDef(name="held", dynamic=True, mesh=fs.shapes.box((0.01, 0.01, 0.01)), elements=[(2, 0, 0)]))
    sim.set_joint(arm, 0, fs.JointPosition(0.3))
    sim.set_wrench(cube, (0, 1e-3, 0))
    sim.set_haptic(held, fs.HapticTarget(pose=(2, 0.01, 0)))
    sim.step(200)
    frame = sim.frame
    assert frame[arm].joints["position"][0] == pytest.approx(0.3, abs=1e-6)
    assert frame[cube].velocities[0, 1] == pytest.approx(0.2, rel=1e-3)  # 1 mN on 1 g for 0.2 s
    assert frame[held].poses[0, 1] > 1e-3
    sim.apply(fs.SetJoint(arm, 0, fs.JointPosition(0.0)))
    sim.apply(fs.SetWrench(cube))
    sim.step(500)
    assert sim.frame[arm].joints["position"][0] == pytest.approx(0.0, abs=1e-6)


def test_fibres_contract():
    sim = fs.Simulation(threads=1, gravity=(0, 0, 0))
    muscle = sim.add(block(material=fs.FemMaterial(fibres=[fs.FibreFamily(direction=fs.Along((0, 1, 0)))]), collision=[]))
    sim.step()
    before = sim.frame[muscle].positions[:, 1].max()
    sim.set_fibre_stress(muscle, 0, 5e3)
    sim.step(100)
    assert sim.frame[muscle].positions[:, 1].max() < before - 1e-3


def test_a_body_is_known_by_its_def():
    sim, tissue, tool = poke()
    assert sim.bodies == [tissue, tool]
    assert repr(tissue) == "BodyId(1)" and tissue == 1
    again = sim.definition(tissue)
    assert again.name == "block" and again.attachments == block().attachments
    assert len(again.mesh.tetrahedra) == 5 * 3 * 5 * 6
    other = fs.Simulation(threads=1)
    other.add(again)
    with pytest.raises(fs.Error):
        sim.definition(99)


def test_errors_of_the_engine_have_pythons_names():
    sim = fs.Simulation(threads=1)
    with pytest.raises(fs.Error, match=r"soft body 'x': .*to_nodes"):
        sim.add(block(name="x", attachments=[fs.AttachmentDef(nodes=[1], to_nodes=[2, 3])]))
    with pytest.raises(fs.Error, match=r"soft body 'poissonRatio': material\.poisson_ratio must be in \[0, 0\.5\), got 0\.7"):
        body = block(name="poissonRatio")
        object.__setattr__(body.material, "poisson_ratio", 0.7)
        sim.add(body)
    with pytest.raises(fs.Error):
        sim.add(fs.SoftBodyDef(mesh="no/such.msh"))
    assert sim.bodies == []


def test_a_recording_replays_bit_for_bit(tmp_path):
    sim, tissue, tool = poke()
    sim.record(tmp_path / "poke.rec", log=tmp_path / "poke.csv", session="test")
    sim.every_step(lambda t: sim.set_pose(tool, (0, 0.025 - 0.1 * t, 0)))
    sim.step(50)
    expected = sim.state_hash
    with pytest.raises(fs.Error, match="before the first step"):
        sim.record(tmp_path / "late.rec")
    sim.close()
    replayed = fs.replay(file=str(tmp_path / "poke.rec"), check=True)
    assert (replayed.made, replayed.hash, replayed.different_step, replayed.damage) == (50, expected, None, "")
    assert len((tmp_path / "poke.csv").read_text().splitlines()) >= 51
    with pytest.raises(fs.Error, match="nothing.rec"):
        fs.replay(file="nothing.rec")
    with pytest.raises(fs.Error):
        poke()[0].record("x.txt")


def test_a_closed_simulation_keeps_its_frames_and_refuses_the_rest():
    with fs.Simulation(threads=1) as sim:
        tissue = sim.add(block())
        sim.step(5)
        frame, expected = sim.frame, sim.state_hash
    assert frame[tissue].positions.shape[1] == 3
    assert sim.report().hash == sim.state_hash == expected
    sim.close()
    for act in (sim.step, lambda: sim.add(block()), lambda: sim.frame, lambda: sim.set_gravity((0, 0, 0)), sim.render):
        with pytest.raises(fs.Error, match="the simulation is closed"):
            act()


def test_the_library_of_tissues():
    liver = fs.tissue("liver")
    assert liver.material.young_modulus > 100 and liver.source and 0 < liver.lowest < liver.highest
    assert {"liver"} <= {each.name for each in fs.tissues()}
    with pytest.raises(fs.Error, match="liver"):
        fs.tissue("livr")


def test_the_report_says_what_of_a_body_fell_out_of_the_scene():
    sim = fs.Simulation(gravity=(0, 0, 0))
    tissue = sim.add(
        block(mesh=fs.shapes.block((0.06, 0.02, 0.02), (6, 2, 2)), dynamic_topology=True, attachments=[
            fs.AttachmentDef(box=fs.Box((-1, -1, -1), (-0.029, 1, 1)))]))
    plane = fs.TriangleMesh(vertices=[[0, 0, -0.03], [0, 0, 0.03], [0, 0.05, 0.03], [0, 0.05, -0.03]],
                            triangles=[[0, 1, 2], [0, 2, 3]])
    knife = sim.add(
        fs.RigidBodyDef(name="knife", elements=[(0.011, 0.03, 0)], mesh=plane, collision=[fs.CollisionDef(cutting=True)])
    )
    sim.step()
    sim.step(60, {knife: (0.011, -0.03, 0)})
    assert not sim.report().lost and "lost by" not in str(sim.report())
    mass = 1000 * 0.06 * 0.02 * 0.02  # [kg]
    away = np.flatnonzero(sim.frame[tissue].positions[:, 0] > 0.012)
    sim.apply(fs.SetForces(id=tissue, forces=[fs.NodalForce(int(node), (0.0, -0.3, 0.0)) for node in away]))
    lost = []
    for _ in range(1000):
        lost += sim.step().topology.lost_pieces
        if lost:
            break
    assert len(lost) == 1 and lost[0].body == tissue and lost[0].piece > 0
    assert lost[0].mass == pytest.approx(mass / 3, rel=0.15) and lost[0].share == pytest.approx(1 / 3, rel=0.15)
    report = sim.report()
    assert [(each.body, each.pieces, each.mass) for each in report.lost] == [("block", 1, lost[0].mass)]
    assert "lost by 'block': 1 piece, " in str(report) and " fallen farther than 10 m and removed" in str(report)
    assert repr(report) == str(report)


def test_paused_steps_move_nothing():
    sim, tissue, _ = poke()
    sim.step(3)
    before = sim.frame[tissue].positions.copy()
    calls = []
    sim.every_step(calls.append)
    sim.pause()
    sim.step(3)
    assert np.array_equal(before, sim.frame[tissue].positions)
    paused = len(calls)
    sim.pause(False)
    sim.step(3)
    assert paused <= 1 and len(calls) >= paused + 2  # the server learns of it in the step
    assert not np.array_equal(before, sim.frame[tissue].positions)


def test_what_is_under_a_mask_is_no_number():
    sim, tissue, _ = poke()
    hidden = np.ma.array(np.full((1, 3), 1e3), mask=True)
    with pytest.raises(TypeError, match="set_forces: forces must be an array without a mask"):
        sim.set_forces(tissue, hidden, [0])
    with pytest.raises(TypeError, match="TetMesh: nodes must be an array without a mask"):
        fs.TetMesh(np.ma.zeros((4, 3)), [[0, 1, 2, 3]])
    with pytest.raises(fs.Error, match="forces must have at most 100000000 rows, got 1000000000"):
        sim.set_forces(tissue, np.broadcast_to(np.zeros(3), (10**9, 3)))


def test_a_refused_recording_leaves_the_simulation_as_it_was(tmp_path):
    sizes = []
    for refused in ((), ("", "no/such/folder/a.rec", "a.txt", "/dev/full/a.rec", str(tmp_path / "locked.rec"))):
        sim, tissue, _ = poke()
        sim.show(tissue)
        holder = poke()[0]
        if refused:
            holder.record(tmp_path / "locked.rec")  # a file that is being written cannot be opened
        for file in refused:
            with pytest.raises(fs.Error):
                sim.record(file)
        sim.record(tmp_path / "good.rec")
        sim.step(5)
        expected = sim.state_hash
        sim.close()
        sizes.append((tmp_path / "good.rec").stat().st_size)
        replayed = fs.replay(file=str(tmp_path / "good.rec"), check=True)
        assert (replayed.made, replayed.hash, replayed.different_step) == (5, expected, None)
        holder.close()
    assert abs(sizes[0] - sizes[1]) < 100  # with what was shown before
    sim, _, _ = poke()
    with pytest.raises(fs.Error, match="no such folder"):
        sim.record("no/such/folder/a.rec")
    sim.step()
    assert sim.report().steps == 1


def test_a_report_before_the_first_step_does_not_begin_the_run(tmp_path):
    sim, _, _ = poke()
    report = sim.report()
    assert (report.steps, report.time, report.finished, report.hash) == (0, 0.0, "not yet", sim.state_hash)
    sim.record(tmp_path / "late.rec")
    sim.step()
    assert sim.report().steps == 1


def test_a_hash_outlives_the_simulation_also_without_a_step():
    sim, _, _ = poke()
    before = sim.state_hash
    sim.close()
    assert before != 0 and sim.state_hash == sim.report().hash == before
    assert sim.report().finished == "made 0 steps"


def test_repr_never_raises_and_bodies_of_a_closed_simulation_are_an_error():
    sim, tissue, _ = poke()
    sim.step()
    assert repr(sim) == "<Simulation of 2 bodies at 0.001 s>"
    sim.close()
    assert repr(sim) == "<closed Simulation at 0.001 s>"
    for act in (lambda: sim.bodies, lambda: sim.definition(tissue)):
        with pytest.raises(fs.Error, match="the simulation is closed"):
            act()


def test_observers_that_come_and_go_get_what_happens_while_they_are_there():
    sim, _, _ = poke()
    first, second = [], []
    a = sim.on(fs.PhysicsUpdateEvent, lambda e: first.append(e.step))
    b = sim.on(fs.PhysicsUpdateEvent, lambda e: second.append(e.step))
    sim.step(2)
    sim.off(a)
    sim.step(2)
    sim.off(b)
    sim.step(2)
    sim.on(fs.PhysicsUpdateEvent, lambda e: first.append(e.step))
    sim.step(2)
    assert (first, second) == ([1, 2, 7, 8], [1, 2, 3, 4])


def test_words_of_the_user_stay_as_they_are_in_errors(tmp_path, monkeypatch):
    sim = fs.Simulation(threads=1)
    for name in ("o'brien's liverName", "liverName", "a 'liverName' b"):
        with pytest.raises(fs.Error) as caught:
            sim.add(block(name=name, attachments=[fs.AttachmentDef(nodes=[1], to_nodes=[2, 3])]))
        assert name in str(caught.value) and "to_nodes" in str(caught.value)
    for file in ("noSuchMesh.msh", "my scans/liverMesh 2.msh", "liverMesh 2.msh", "someFolder/x.msh"):
        with pytest.raises(fs.Error) as caught:
            fs.load_tet_mesh(file)
        assert file in str(caught.value)

    written = tmp_path / "cubeDof.msh"
    written.write_text("$MeshFormat\n9 0 8\n")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(fs.Error, match="^cubeDof.msh:2: the Gmsh format"):  # a name without a folder, and a line
        fs.load_tet_mesh("cubeDof.msh")
    points = '<Points><DataArray type="Float32" format="binary">AAAA</DataArray></Points>'
    piece = f'<Piece NumberOfPoints="4" NumberOfCells="1">{points}</Piece>'
    head = '<VTKFile type="UnstructuredGrid" compressor="vtkLZMADataCompressor">'
    (tmp_path / "dofGrid.vtu").write_text(f"{head}<UnstructuredGrid>{piece}</UnstructuredGrid></VTKFile>")
    with pytest.raises(fs.Error, match="compressed by vtkZLibDataCompressor or not at all"):  # a word of a file's format
        fs.load_tet_mesh("dofGrid.vtu")

    class camelCase:
        def __repr__(self):
            return "camelCase of theUser"

    with pytest.raises(fs.Error, match="got 'camelCase'"):
        fs.JointDef(kind="camelCase")
    with pytest.raises(TypeError, match="got camelCase of theUser"):
        fs.Ball(radius=camelCase())
