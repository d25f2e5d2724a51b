"""Heat and burns."""

import pytest

import filasofia as fs
from scenes import block


def burning(**fields):
    sim = fs.Simulation(rate=500)
    pinned = fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, -0.0059, 1)))
    tissue = sim.add(block(mesh=fs.shapes.block((0.04, 0.012, 0.03), (16, 4, 12)), attachments=[pinned]))
    sim.burn(tissue, fs.BurningDef(**fields))
    return sim, tissue


def test_a_source_burns_and_its_heat_is_accounted_for():
    sim, tissue = burning(target=False)
    told = []
    sim.on(fs.BurnEvent, told.append)
    sim.treat(tissue, fs.Heat(place=(0, 0.006, 0), radius=0.003, power=60.0))
    sim.step(600)
    heat = sim.heat(tissue)
    assert heat.burnt > 5e-6 and heat.peak > 340
    spent = heat.stored + heat.perfused + heat.lost + heat.boiled + heat.carried_off
    assert heat.delivered == pytest.approx(spent, rel=1e-6)
    assert told[0].body == tissue and told[0].balance.burnt == 0 and not told[0].injury
    assert told[-1].injury and told[-1].balance.burnt > 0


def test_wrong_heat_is_an_error():
    sim, tissue = burning()
    with pytest.raises(fs.Error, match="burns already"):
        sim.burn(tissue)
    with pytest.raises(fs.Error, match="power"):
        sim.treat(tissue, fs.Heat(power=-1))
    with pytest.raises(fs.Error, match="depth"):
        burning(depth=0)
