"""Cavities: what fills a hollow body, in and out."""
import filasofia as fs
import pytest

ATMOSPHERE = 101325.0


def bladder(**cavity):
    return fs.SoftBodyDef(
        name="bladder",
        mesh=fs.shapes.bladder((0.02, 0.02, 0.02), 2e-3, (5, 1)),
        gravity=False,
        cavities=[fs.CavityDef(**cavity)],
    )


def test_gas_keeps_its_pressure_times_its_volume():
    sim = fs.Simulation(physics=fs.PhysicsDef(rate=1000))
    body = sim.add(bladder(pressure=500.0))
    sim.step()
    start = sim.frame.cavities[0].copy()
    assert start["body"] == body and start["cavity"] == 0 and not start["open"]
    sim.set_pressure(body, 2000.0)  # from outside
    sim.step(500)
    now = sim.frame.cavities[0]
    assert now["volume"] < start["volume"] and now["pressure"] > start["pressure"]
    content = [(each["pressure"] + ATMOSPHERE) * each["volume"] for each in (start, now)]
    assert content[1] == pytest.approx(content[0], rel=1e-12)


def test_inflow_fills_a_liquid_cavity():
    sim = fs.Simulation(physics=fs.PhysicsDef(rate=1000))
    body = sim.add(bladder(fill="liquid"))
    sim.step()
    before = sim.frame.cavities[0]["volume"]
    sim.set_cavity(body, inflow=1e-6)
    sim.step(1000)
    assert sim.frame.cavities[0]["volume"] - before == pytest.approx(1e-6, rel=0.02)


def test_what_cannot_be_is_one_error():
    sim = fs.Simulation()
    body = sim.add(bladder(fill="source"))
    with pytest.raises(fs.Error, match=r"soft body 'bladder': cavity must be in \[0, 1\), the number of its cavities, got 3"):
        sim.set_cavity(body, 3, pressure=0)
    with pytest.raises(fs.Error, match="soft body 'solid': has no cavities, got cavity 0"):
        sim.set_cavity(sim.add(fs.SoftBodyDef(name="solid", mesh=fs.shapes.block((0.02, 0.02, 0.02), (2, 2, 2)))), pressure=0)
    with pytest.raises(fs.Error, match="inflow cannot be set for cavities.0.: its pressure is that of a source"):
        sim.set_cavity(body, inflow=1e-6)
    with pytest.raises(fs.Error, match="SetCavity must give a pressure or an inflow"):
        sim.set_cavity(body)
    with pytest.raises(fs.Error, match="soft body 'x': cavities.0.: the mesh has no closed inner surfaces"):
        sim.add(fs.SoftBodyDef(name="x", mesh=fs.shapes.block((0.1, 0.1, 0.1)), cavities=[fs.CavityDef()]))
