"""Blood on tissue."""

import pytest

import filasofia as fs
from scenes import block


def pinned():
    """Its lower side."""
    return fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, -0.0059, 1)))


def bleeding():
    sim = fs.Simulation(rate=500)
    tissue = sim.add(block(mesh=fs.shapes.block((0.04, 0.012, 0.03), (8, 3, 6)), attachments=[pinned()]))
    sim.bleed(tissue, fs.BleedingDef(flux=1e-3))
    return sim, tissue


def test_an_injury_bleeds_until_it_is_sealed():
    sim, tissue = bleeding()
    sim.treat(tissue, fs.Injure(place=(0, 0.006, 0), radius=0.01))
    told = []
    sim.on(fs.BleedingEvent, told.append)
    sim.step(100)
    assert told and told[0].body == tissue and told[0].balance.welled == 0
    blood = sim.blood(tissue)
    assert blood.welled > 0 and blood.rate > 0
    assert blood.welled == pytest.approx(blood.on_tissue + blood.dripped)
    sim.treat(tissue, fs.Seal(place=(0, 0.006, 0), radius=0.02))
    sim.step(40)
    assert sim.blood(tissue).rate == 0
    sim.treat(tissue, fs.Rinse(place=(0, 0, 0)))
    sim.step(40)
    assert sim.blood(tissue).rinsed > 0


def test_suction_goes_where_its_body_goes():
    sim, tissue = bleeding()
    tube = sim.add(fs.RigidBodyDef(name="tube", elements=[(0, 0.05, 0)]))
    sim.treat(tissue, fs.Injure(place=(0, 0.006, 0), radius=0.01))
    sim.treat(tissue, fs.Suck(rate=1e-6, radius=0.008, body=tube))
    sim.step(100)
    assert sim.blood(tissue).sucked == 0
    sim.set_pose(tube, (0, 0.006, 0))
    sim.step(100)
    assert sim.blood(tissue).sucked > 0
    with pytest.raises(fs.Error, match="body must be a rigid one, got soft body"):
        sim.treat(tissue, fs.Suck(rate=1e-6, body=tissue))


def test_wrong_blood_is_an_error():
    sim, tissue = bleeding()
    with pytest.raises(fs.Error, match="bleeds already"):
        sim.bleed(tissue)
    with pytest.raises(fs.Error, match="radius"):
        sim.treat(tissue, fs.Seal(place=(0, 0, 0), radius=-1))
