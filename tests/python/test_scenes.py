"""Scene files."""

import json
import os
import pathlib
import re

import numpy as np
import pytest

import filasofia
from scenes import bunny

SCENES = pathlib.Path(os.environ["FILASOFIA_ROOT"]) / "examples" / "scenes"


def test_a_scene_has_the_hash_of_its_program():
    loaded = filasofia.load(SCENES / "bunny.json")
    same = filasofia.Simulation(rate=1000)
    same.add(bunny())
    for simulation in (loaded, same):
        simulation.step(50)
    assert loaded.state_hash == same.state_hash
    assert [loaded.definition(each).name for each in loaded.bodies] == ["bunny"]


def test_physics_and_look_replace_those_of_a_scene():
    physics = filasofia.PhysicsDef(rate=500, threads=1)
    simulation = filasofia.load(SCENES / "bunny.json", physics=physics, look=filasofia.LookDef(quality="low"))
    simulation.step(50)
    assert simulation.time == pytest.approx(0.1)
    with pytest.raises(TypeError, match="give threads or physics"):
        filasofia.load(SCENES / "bunny.json", physics=physics, threads=1)


def test_points_of_a_layer_are_told_as_long_as_they_hold():
    simulation = filasofia.load(SCENES / "dissection.json")
    simulation.step()
    points, attachments = simulation.frame.attached_points, simulation.frame.attachments
    layer = attachments["id"] == points["attachment"][0]
    assert len(points) == attachments["points"][layer].sum() > 10
    places = simulation.frame[int(attachments["body"][layer][0])].positions
    assert points["place"] == pytest.approx(places[points["node"]])
    assert points["to_place"] == pytest.approx(points["place"], abs=1e-3)
    simulation.step(1500)
    assert len(simulation.frame.attached_points) < len(points)


def test_motions_of_a_scene_are_made():
    simulation = filasofia.load(str(SCENES / "poke.json"))
    ball = simulation.bodies[1]
    simulation.step(500)
    assert simulation.frame[ball].poses[0][1] == pytest.approx(0.012)


@pytest.mark.parametrize("choice", ["nothing", "before", "after"])
def test_a_scene_that_shows_nothing_is_drawn_and_what_the_user_chooses_takes_its_place(tmp_path, choice):
    block = {"type": "block", "size": [0.02, 0.02, 0.02], "cells": [1, 1, 1]}
    beside = {"position": [0.05, 0, 0]}
    file = tmp_path / "scene.json"
    file.write_text(json.dumps({"bodies": [{"name": "a", "mesh": block}, {"name": "b", "mesh": block, "pose": beside}]}))
    sim = filasofia.load(file)
    a, b = sim.bodies
    if choice == "after":
        sim.render(96, 64)
    if choice != "nothing":
        sim.show(a)
    drawn = set(np.unique(sim.render_depth(96, 64).bodies)) - {0}
    assert drawn == ({a} if choice == "before" else {a, b})


def test_mistakes_are_errors_with_their_place(tmp_path):
    wrong = tmp_path / "wrong.json"
    wrong.write_text('{"physics": {"rate": 0}}')
    with pytest.raises(filasofia.Error, match=r"wrong.json:1:22: physics.rate must be in \[1, 100000\] Hz, got 0"):
        filasofia.load(wrong)
    wrong.write_text('{"bodies": [{"dynamicTopology": 1}]}')
    with pytest.raises(filasofia.Error, match=r"bodies\[0\].dynamicTopology must be true or false, got 1"):
        filasofia.load(wrong)
    wrong.write_text('{"bodies": [{"mesh": "/etc/hostname"}]}')
    with pytest.raises(filasofia.Error, match="in the folder of the scene"):
        filasofia.load(wrong)
    with pytest.raises(filasofia.Error, match="cube.json"):
        filasofia.load("cube.json")
    with pytest.raises(TypeError, match="load: file must be a text"):
        filasofia.load(5)


def test_a_recording_becomes_a_scene_whose_meshes_are_not_overwritten_unasked(tmp_path):
    with filasofia.load(SCENES / "poke.json") as simulation:
        simulation.record(tmp_path / "poke.rec")
        simulation.step(5)
        last = simulation.state_hash
    scene = tmp_path / "poke.json"
    assert filasofia.save_scene(tmp_path / "poke.rec", scene) == []
    with pytest.raises(filasofia.Error, match="poke_files/.*: is there already"):
        filasofia.save_scene(tmp_path / "poke.rec", scene)
    filasofia.save_scene(tmp_path / "poke.rec", scene, overwrite=True)
    again = filasofia.load(scene)
    again.step(5)
    assert again.state_hash == last


def test_load_reads_a_model_of_mujoco_and_a_robot(tmp_path, capfd):
    flex = filasofia.load(SCENES / "flex.xml")
    flex.run(0.2)
    assert len(flex.bodies) == 6
    assert len(filasofia.load(SCENES / "needle_driver.urdf").bodies) == 1
    assert flex.frame[flex.bodies[4]].positions.shape == (160, 3)
    assert "effort bounds no force" in capfd.readouterr().err
    model = tmp_path / "model.xml"
    model.write_text("<mujoco><worldbody><composite/><geom size='0.1'/></worldbody></mujoco>")
    assert len(filasofia.load(model).bodies) == 1
    assert "model.xml:1:21: <composite> is not read" in capfd.readouterr().err
    with pytest.raises(filasofia.Error, match=r"model.xml:1:21: mujoco/worldbody/composite: <composite> is not read \(strict\)"):
        filasofia.load(model, strict=True)
    with pytest.raises(filasofia.Error, match="model.xml: a unit is for scenes of SOFA"):
        filasofia.load(model, unit=0.001)


def test_a_scene_of_sofa_is_in_the_unit_that_is_given(tmp_path):
    beam = tmp_path / "beam.scn"
    beam.write_text(
        '<Node name="root" gravity="0 -9810 0" dt="0.01"><Node name="Beam"><EulerImplicitSolver/>'
        '<RegularGridTopology n="9 3 3" min="0 0 0" max="400 100 100"/><MechanicalObject/><UniformMass totalMass="4"/>'
        '<HexahedronFEMForceField youngModulus="20" poissonRatio="0.3"/></Node></Node>'
    )
    simulation = filasofia.load(beam, unit=0.001)
    (body,) = simulation.bodies
    assert simulation.definition(body).material.young_modulus == pytest.approx(20e3)
    simulation.step()
    assert simulation.frame[body].positions.max() == pytest.approx(0.4)
    with pytest.raises(filasofia.Error, match="unit"):
        filasofia.load(beam, unit=0)


def test_scenes_and_instruments_find_their_files_in_the_package(tmp_path):
    """A wheel has no source tree: where it is installed, everything comes from its own folder."""
    data = pathlib.Path(filasofia.__file__).parent / "data"
    scene = tmp_path / "none.json"
    scene.write_text('{"bodies": [{"name": "none", "mesh": "asset:meshes/none.msh"}]}')
    with pytest.raises(filasofia.Error, match="asset 'meshes/none.msh' is in none of .*" + re.escape(str(data))):
        filasofia.load(scene)
    assets = pathlib.Path(os.environ["FILASOFIA_ROOT"]) / "assets"
    for folder in ("meshes", "motions", "scenes"):
        files = [each.relative_to(assets) for each in (assets / folder).rglob("*") if each.is_file()]
        assert files and all((data / each).is_file() for each in files)


BALL = """{
  "bodies": [
    {"type": "RigidBodyDef", "name": "floor", "elements": ["0 -50 0 mm"],
     "mesh": {"type": "box", "size": "1 0.1 1"}, "collision": [{}]},
    {"type": "RigidBodyDef", "name": "ball", "elements": ["0 20.5 0 mm"], "dynamic": true,
     "mass": {"type": "TotalMass", "value": "200 g"}, "mesh": {"type": "sphere", "radius": "20 mm"}, "collision": [{}]}
  ],
  "sensorRate": "10 Hz",
  "sensors": [
    {"name": "ball", "body": "ball"},
    {"name": "weight", "type": "ContactForceSensor", "body": "ball", "with": "floor"}
  ]
}"""


def test_the_sensors_of_a_scene_are_read_and_written(tmp_path):
    scene, table = tmp_path / "ball.json", tmp_path / "ball.csv"
    scene.write_text(BALL)
    with filasofia.load(scene, sensors=table) as sim:
        assert sim.sensor_columns["weight"] == ["x [N]", "y [N]", "z [N]", "normal [N]"]
        assert np.isnan(sim.sensors["ball"]).all()
        sim.step(1000)
        now = sim.sensors
        assert now["ball"].shape == (3,) and abs(now["ball"][1] - 0.02) < 1e-3
        assert abs(now["weight"][3] - 0.2 * 9.81) < 2e-3
        with pytest.raises(filasofia.Error, match="where time only goes on"):
            sim.restore(sim.save_state())
    assert np.array_equal(sim.sensors["ball"], now["ball"])  # also after close()
    rows = np.genfromtxt(table, delimiter=",", skip_header=1)
    assert rows.shape == (11, 8) and np.allclose(rows[-1, 1:4], now["ball"])
    with filasofia.load(scene) as again:  # without a table
        again.step(1000)
        again.restore(again.save_state())
        assert np.array_equal(again.sensors["weight"], now["weight"])


def test_wrong_sensors_are_errors(tmp_path):
    scene = tmp_path / "ball.json"
    scene.write_text(BALL)
    for name, why in (("", "must name a .csv file"), (tmp_path / "a.txt", "must end in .csv"), ("no/a.csv", "no/a.csv")):
        with pytest.raises(filasofia.Error, match=why):
            filasofia.load(scene, sensors=name)
    scene.write_text(BALL.replace('"with": "floor"', '"with": "ball"'))
    with pytest.raises(filasofia.Error, match=r"ball.json:11:[0-9]+: sensors\[1\].with must differ from body"):
        filasofia.load(scene)
    with pytest.raises(filasofia.Error, match="there must be a sensor"):
        scene.write_text('{"bodies": []}')
        filasofia.load(scene, sensors=tmp_path / "a.csv")
    with filasofia.Simulation() as sim:
        assert sim.sensors == {} and sim.sensor_columns == {}
