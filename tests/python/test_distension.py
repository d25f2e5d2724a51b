"""The fluid that distends a cavity."""

import pytest

import filasofia as fs

ROOM = fs.Box((-0.02, -0.02, -0.02), (0.02, 0.02, 0.02))


def test_a_cavity_fills_and_all_of_it_is_accounted_for():
    sim = fs.Simulation(rate=500)
    told = []
    sim.on(fs.DistensionEvent, told.append)
    sim.add_distension(fs.DistensionDef(room=ROOM, pressure=10e3, outflow=1.0))
    sim.step(500)
    now = sim.distension()
    assert 0 < now.pressure < 10e3
    assert now.at_start + now.in_ + now.bled == pytest.approx(now.out + now.lost + now.volume, rel=1e-9)
    assert now.deficit == pytest.approx(now.in_ - now.out)
    assert now.blood_share == 0 and not now.beyond_limit
    sim.distend(fs.Distend(pressure=0.0))
    sim.step(100)
    assert sim.distension().inflow == 0
    assert told and told[-1].balance.in_ > 0


def test_wrong_fluids_are_refused():
    sim = fs.Simulation()
    with pytest.raises(fs.Error, match="there is none"):
        sim.distension()
    with pytest.raises(fs.Error, match="room"):
        sim.add_distension(fs.DistensionDef())
    sim.add_distension(fs.DistensionDef(room=ROOM))
    with pytest.raises(fs.Error, match="outflow must be in"):
        sim.distend(fs.Distend(outflow=2))
