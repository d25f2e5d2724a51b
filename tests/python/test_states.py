"""Saved states."""

import gc
import threading

import numpy as np
import pytest

import filasofia as fs
from scenes import block, poke


def cutting(threads=1):
    """A block that may be cut, and a blade."""
    sim = fs.Simulation(threads=threads)
    tissue = sim.add(block(dynamic_topology=True))
    blade = fs.TriangleMesh(
        vertices=[[0, 0, -0.1], [0, 0, 0.1], [0, 0.05, 0.1], [0, 0.05, -0.1]], triangles=[[0, 1, 2], [0, 2, 3]]
    )
    knife = sim.add(
        fs.RigidBodyDef(
            name="knife", elements=[(0.001, 0.02, 0)], collision=[fs.CollisionDef(mesh=blade, cutting=True)]
        )
    )
    return sim, tissue, knife


def press(sim, knife, steps):
    """The hashes of the steps in which the knife goes down."""
    hashes = []
    for _ in range(steps):
        sim.set_pose(knife, (0.001, 0.02 - 0.5 * (sim.time + sim.dt), 0))
        sim.step()
        hashes.append(sim.state_hash)
    return hashes


def test_a_cut_goes_on_with_the_same_bits_after_it_was_undone():
    sim, tissue, knife = cutting()
    press(sim, knife, 20)
    state = sim.save_state()
    before = sim.frame[tissue].positions.copy()
    first = press(sim, knife, 30)
    assert sim.frame[tissue].revision > 0
    assert sim.report().cut_area > 1e-4
    sim.restore(state)
    assert (sim.steps, sim.time) == (state.steps, state.time) == (20, pytest.approx(0.02))
    assert np.array_equal(sim.frame[tissue].positions, before)
    assert press(sim, knife, 30) == first
    sim.restore(state)
    sim.reset()  # a state is no reset
    sim.step()
    assert sim.steps == 21


def test_a_blade_that_is_switched_off_cuts_nothing_until_it_is_switched_on():
    sim, tissue, knife = cutting()
    sim.set_cutting(knife, False)
    press(sim, knife, 25)
    assert sim.report().cut_area == 0
    report = sim.step()
    assert report.iterations == report.solves[0].iterations > 0
    assert report.solves[0].together == tissue
    sim.apply(fs.SetCutting(id=knife))
    press(sim, knife, 25)
    assert sim.report().cut_area > 1e-4
    with pytest.raises(fs.Error, match="must be a rigid body to have its blades switched"):
        sim.set_cutting(tissue, False)


def test_a_state_continues_in_many_simulations_at_once():
    sim, _, knife = cutting()
    press(sim, knife, 25)
    state = sim.save_state()
    expected = press(sim, knife, 25)
    found = [None] * 4

    def work(i):
        other, _, same = cutting(threads=1 + i % 2)
        other.step()
        other.restore(state)
        found[i] = press(other, same, 25)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert found == [expected] * 4


def test_one_settled_state_serves_many_materials():
    """A state has material, friction and gravity, too: those of the simulation come back by commands."""

    def settled(material, gravity=(0, -9.81, 0)):
        sim = fs.Simulation(threads=1, gravity=gravity)
        held = [fs.AttachmentDef(box=fs.Box((-1, -1, -1), (-0.0199, 1, 1)))]
        shape = fs.shapes.block((0.04, 0.02, 0.04), (4, 2, 4))
        body = sim.add(fs.SoftBodyDef(name="bar", mesh=shape, material=material, attachments=held))
        sim.step()
        return sim, body

    soft, stiff = fs.FemMaterial(young_modulus=1e4), fs.FemMaterial(young_modulus=4e4)
    one, body = settled(soft)
    one.run(1)
    state = one.save_state()

    def tip(sim):
        sim.run(2)
        return sim.frame[body].positions[:, 1].min()

    as_saved, hangs = tip(one), {}
    for name, material, gravity in (("stiff", stiff, (0, -9.81, 0)), ("light", soft, (0, -2, 0))):
        own, _ = settled(material, gravity)
        other, _ = settled(material, gravity)
        other.restore(state)
        plain = tip(other)
        assert plain == as_saved  # of the state, whatever `other` was made with
        other.restore(state)
        other.set_material(body, material)
        other.set_gravity(gravity)
        hangs[name] = tip(other), tip(own)
        assert hangs[name][0] == pytest.approx(hangs[name][1], abs=2e-6)
        assert hangs[name][0] > as_saved + 1e-4


def test_a_picture_follows_a_state():
    sim, _, knife = cutting()
    press(sim, knife, 20)
    state = sim.save_state()
    before = sim.render(96, 72)
    press(sim, knife, 40)
    after = sim.render(96, 72)
    assert np.abs(before.astype(int) - after).max() > 20
    for _ in range(2):
        sim.restore(state)
        for _ in range(20):  # meshes of cut bodies are made in the background
            picture = sim.render(96, 72)
        assert np.abs(picture.astype(int) - before).mean() < 0.5
        press(sim, knife, 40)


def test_what_cannot_be_restored_is_an_error():
    sim, block_id, _ = poke()
    with pytest.raises(fs.Error, match="save_state: make a step first"):
        sim.save_state()
    sim.step()
    state = sim.save_state()
    with pytest.raises(TypeError, match="restore: the state must be a SavedState, got 5"):
        sim.restore(5)
    sim.add(block(name="second"))
    with pytest.raises(fs.Error, match="bodies were added or removed since the state was saved"):
        sim.restore(state)
    with pytest.raises(fs.Error, match="the last AddBody has not taken effect"):
        sim.save_state()
    slower, _, _ = poke(rate=500)
    slower.step()
    with pytest.raises(fs.Error, match="steps of 0.001 s, but here they take 0.002 s"):
        slower.restore(state)
    arrays = [slower.frame[block_id].positions]
    for _ in range(12):
        slower.step()
        try:
            arrays.append(slower.frame[block_id].positions)
        except fs.Error:
            break
    mine = slower.save_state()
    with pytest.raises(fs.Error, match="release them first"):
        slower.restore(mine)
    arrays.clear()
    gc.collect()
    slower.restore(mine)
    slower.close()
    with pytest.raises(fs.Error, match="restore: the simulation is closed"):
        slower.restore(mine)
