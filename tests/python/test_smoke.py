"""Smoke and steam of burning tissue."""

import math

import pytest

import filasofia as fs
from scenes import block

ROOM = fs.Box((-0.06, -0.02, -0.06), (0.06, 0.08, 0.06))


def smoking(**fields):
    sim = fs.Simulation(rate=500)
    pinned = fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, -0.0059, 1)))
    tissue = sim.add(block(mesh=fs.shapes.block((0.04, 0.012, 0.03), (16, 4, 12)), attachments=[pinned]))
    sim.burn(tissue, fs.BurningDef(depth=0.0005))
    sim.add_smoke(fs.SmokeDef(room=ROOM, **fields))
    sim.treat(tissue, fs.Heat(place=(0, 0.006, 0), radius=0.003, power=60.0))
    return sim, tissue


def test_what_burns_smokes_and_all_of_it_is_accounted_for():
    sim, tissue = smoking(inflow=1e-4)
    sim.extract(fs.Extract(place=(0, 0.03, 0), flow=1e-4))
    sim.step(600)
    now = sim.smoke()
    assert now.smoke.emitted == pytest.approx(fs.SmokeDef().yield_ * sim.heat(tissue).fuming, rel=1e-9)
    for each in (now.smoke, now.steam):
        assert each.emitted > 0 and each.extracted > 0 and each.vented > 0
        spent = each.in_air + each.extracted + each.vented + each.settled
        assert each.emitted == pytest.approx(spent, rel=1e-9)
    depth = sim.smoke_between((0, 0.07, 0), (0, 0.007, 0))
    assert 0 < math.exp(-depth) < 1


def test_an_opening_that_is_closed_takes_no_more():
    sim, _ = smoking()
    sim.extract(fs.Extract(place=(0, 0.02, 0), flow=1e-4))
    sim.step(300)
    taken = sim.smoke().smoke.extracted
    assert taken > 0
    sim.extract(fs.Extract(flow=0))
    sim.step(10)
    after = sim.smoke().smoke.extracted
    sim.step(100)
    assert sim.smoke().smoke.extracted == after


def test_wrong_smoke_is_an_error():
    sim = fs.Simulation(rate=500)
    with pytest.raises(fs.Error, match="no room"):
        sim.smoke()
    with pytest.raises(fs.Error, match=r"add_smoke: smoke: room\.low\[0\] must be finite"):
        sim.add_smoke(fs.SmokeDef())
    with pytest.raises(fs.Error, match="albedo"):
        sim.add_smoke(fs.SmokeDef(room=ROOM, albedo=2))
    sim.add_smoke(fs.SmokeDef(room=ROOM))
    with pytest.raises(fs.Error, match="the simulation has a room for it already"):
        sim.add_smoke(fs.SmokeDef(room=ROOM))
    with pytest.raises(fs.Error, match="extract: place must be in the room of the smoke"):
        sim.extract(fs.Extract(place=(0, 1, 0), flow=1e-4))
    with pytest.raises(fs.Error, match=r"smoke_between: begin\[0\] must be finite, got nan"):
        sim.smoke_between((math.nan, 0, 0), (0, 0, 0))
