"""Clips on a duct, and what flows in it."""
import math

import filasofia as fs
import pytest

PATH = [(x * 1e-3 - 10e-3, 0, 0) for x in range(21)]


def stage():
    sim = fs.Simulation(physics=fs.PhysicsDef(rate=1000, gravity=(0, 0, 0)))
    ends = [fs.AttachmentDef(box=fs.Box((-1, -1, -1), (-9.5e-3, 1, 1))), fs.AttachmentDef(box=fs.Box((9.5e-3, -1, -1), (1, 1, 1)))]
    duct = sim.add(fs.SoftBodyDef(name="duct", mesh=fs.shapes.vessel(PATH, 1.2e-3, 0.8e-3, (8, 1)),
                                  material=fs.FemMaterial(young_modulus=20e3, poisson_ratio=0.4), attachments=ends))
    clip = sim.add(fs.RigidBodyDef(name="clip", mesh=fs.shapes.box((1e-3, 1e-3, 8e-3)), dynamic=True, mass=fs.TotalMass(1e-4),
                                   linear_damping=5, angular_damping=5))
    sim.add_duct(duct, fs.DuctDef(name="bile", path=[PATH[0], PATH[-1]], radius=1.2e-3, inlet_pressure=1e3, inlet_resistance=1e9))
    return sim, duct, clip


def test_a_clip_stops_what_flows_in_a_duct():
    sim, duct, clip = stage()
    sim.step()
    whole = 8 * 1e-3 * 0.02 / (math.pi * 1.2e-3**4) + 1e9
    assert sim.duct(duct).flow == pytest.approx(1e3 / whole, rel=0.05)
    assert sim.duct(duct).state == "open"
    sim.clip(clip, duct)
    begun = sim.step().clips
    assert (begun.applied, begun.missed, begun.slipped) == (1, 0, 0)
    sim.step(599)
    row = sim.frame.clips[0]
    assert row["tissue"] == duct and row["clip"] == clip and row["closed"]
    assert 0 < row["force"] < 5
    now = sim.duct(duct)
    assert now.state == "clipped" and now.flow == 0 and now.clips_before == 1
    report = sim.report()
    assert (report.clips.applied, report.clips.missed, report.clips.slipped) == (1, 0, 0)
    assert [(each.body, each.duct, each.balance.state) for each in report.ducts] == [("duct", "bile", "clipped")]


def test_an_applier_closes_its_clips_and_states_know_how_many_are_left():
    sim, duct, _ = stage()
    tool = sim.add(fs.RigidBodyDef(name="tool", elements=[(0, 0, 0)], mesh=fs.shapes.box((1e-3, 1e-3, 1e-3))))
    with pytest.raises(fs.Error, match="targets must name at least one soft body, got none"):
        fs.ClipApplier(sim, tool, fs.ClipApplierDef())
    applier = fs.ClipApplier(sim, tool, fs.ClipApplierDef(targets=[duct], clips=2, place=(0, 0, 0)))
    changes = []
    sim.on(fs.ClipEvent, lambda event: changes.append((event.change.kind, event.change.partial)))
    with pytest.raises(fs.Error, match="close.. needs a step before it"):
        applier.close()
    sim.step(2)
    before = sim.save_state()
    applier.close()
    sim.step(400)
    assert (applier.left, applier.applied, applier.missed, applier.slipped) == (1, 1, 0, 0)
    assert sim.duct(duct).state == "clipped" and changes == [("applied", False)]
    assert sim.frame.clips[0]["clip"] == applier.bodies[0] and not sim.frame.clips[0]["partial"]
    sim.step(10, moves={tool: (0, 0.1, 0)})
    applier.close()
    sim.step(3)
    assert (applier.left, applier.missed) == (0, 1) and changes[-1] == ("missed", False)
    sim.restore(before)
    assert (applier.left, applier.applied) == (2, 0)


def test_blood_of_a_duct_is_one_number():
    sim, duct, _ = stage()
    sim.bleed(duct, fs.BleedingDef(flux=1e-4))
    sim.step()
    sim.treat(duct, fs.Pour(place=(0, 0, 0), volume=1e-9))
    sim.step(100)
    assert sim.blood(duct).welled == pytest.approx(1e-9)


def test_a_clip_is_released_and_misuse_is_one_line():
    sim, duct, clip = stage()
    with pytest.raises(fs.Error, match="must be a rigid body to be a clip"):
        sim.clip(duct, duct)
    with pytest.raises(fs.Error, match=r"duct must be in \[0, 1\), got 1"):
        sim.duct(duct, 1)
    with pytest.raises(fs.Error, match="path must have at least two points, got 0"):
        sim.add_duct(duct, fs.DuctDef(name="none"))
    made = sim.clip(clip, duct, fs.ClipDef(closing_force=2.0))
    sim.step(50)
    assert len(sim.frame.clips) == 1
    sim.release(made)
    sim.step()
    assert len(sim.frame.clips) == 0
