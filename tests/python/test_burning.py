"""Heat and burns."""

import numpy as np
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
    assert sim.damage(tissue) is None
    told = []
    sim.on(fs.BurnEvent, told.append)
    sim.treat(tissue, fs.Heat(place=(0, 0.006, 0), radius=0.003, power=60.0))
    sim.step(600)
    heat = sim.heat(tissue)
    assert heat.burnt > 5e-6 and heat.peak > 340
    damage = sim.damage(tissue)
    places = sim.frame[tissue].positions
    assert damage.shape == (len(places),)
    burnt = damage >= 1
    assert burnt.any() and (np.linalg.norm(places[burnt] - (0, 0.006, 0), axis=1) < 0.01).all()
    spent = heat.stored + heat.perfused + heat.lost + heat.boiled + heat.carried_off
    assert heat.delivered == pytest.approx(spent, rel=1e-6)
    assert told[0].body == tissue and told[0].balance.burnt == 0 and not told[0].injury
    assert told[-1].injury and told[-1].balance.burnt > 0


def test_heat_shrinks_tissue_if_told_so():
    def width(tissue):
        sim, body = burning(depth=0.002, tissue=tissue)
        sim.treat(body, fs.Heat(place=(0, 0.006, 0), radius=0.008, power=100.0, limit=363.0))
        sim.step(1000)
        x = sim.frame[body].positions
        top = x[x[:, 1] > 0.003][:, 0]
        return top.max() - top.min()

    cold = width(None)
    assert width(fs.HeatedTissueDef(shrinkage=0.3)) < cold - 3e-4
    assert width(fs.HeatedTissueDef(shrinkage=0)) > cold - 1e-4


def test_wrong_heat_is_an_error():
    sim, tissue = burning()
    with pytest.raises(fs.Error, match="burns already"):
        sim.burn(tissue)
    with pytest.raises(fs.Error, match="power"):
        sim.treat(tissue, fs.Heat(power=-1))
    with pytest.raises(fs.Error, match="depth"):
        burning(depth=0)
    with pytest.raises(fs.Error, match=r"strength must be in \[0.01, 100\], got 0"):
        burning(tissue=fs.HeatedTissueDef(strength=0))


def touching(electrode):
    """A block that keeps its shape, and a stick whose tip is on it."""
    sim = fs.Simulation(rate=500)
    fixed = fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, 1, 1)))
    tissue = sim.add(block(mesh=fs.shapes.block((0.04, 0.012, 0.03), (16, 4, 12)), attachments=[fixed]))
    sim.burn(tissue, fs.BurningDef(rate=50))
    stick = sim.add(fs.RigidBodyDef(name="stick", elements=[(0, 0.006, 0)]))
    return sim, tissue, stick, sim.add_electrode(stick, electrode)


def test_an_electrode_gives_its_power_while_its_pedal_is_pressed_and_it_touches():
    sim, tissue, stick, index = touching(fs.ElectrodeDef(mode="coagulate", power=2.0, radius=0.003))
    told = []
    sim.on(fs.EnergyEvent, told.append)
    assert index == 0
    sim.activate(stick)
    sim.step(250)
    sim.activate(stick, on=False)
    sim.step(50)
    sim.set_pose(stick, (0, 0.05, 0))
    sim.step(50)
    sim.activate(stick, True, electrode=0)
    sim.step(100)
    energy = sim.energy(stick)
    assert energy.active == pytest.approx(0.7)
    assert energy.in_air == pytest.approx(0.2)
    assert energy.delivered == pytest.approx(1.0, rel=1e-9)
    assert sim.heat(tissue).delivered == pytest.approx(1.0, rel=1e-9)
    assert [each.active for each in told[:3]] == [True, False, True]
    assert told[0].body == stick and told[0].electrode == 0
    assert told[-1].balance.active > 0


def test_wrong_electrodes_are_errors():
    sim, tissue, stick, _ = touching(fs.ElectrodeDef(mode="coagulate"))
    with pytest.raises(ValueError, match="'cut', 'coagulate' or 'bipolar'"):
        fs.ElectrodeDef(mode="fry")
    with pytest.raises(fs.Error, match="needs a rigid body"):
        sim.add_electrode(tissue)
    with pytest.raises(fs.Error, match="mode cut needs a blade"):
        sim.add_electrode(stick)
    with pytest.raises(fs.Error, match="power must be in"):
        sim.add_electrode(stick, fs.ElectrodeDef(mode="coagulate", power=0))
    with pytest.raises(fs.Error, match="other must be given"):
        sim.add_electrode(stick, fs.ElectrodeDef(mode="bipolar"))
    with pytest.raises(fs.Error, match=r"electrode must be in \[0, 1\), got 1"):
        sim.activate(stick, electrode=1)
    with pytest.raises(fs.Error, match="has none"):
        sim.energy(tissue)
