"""The Defs: one class for each, from the fields() lists."""
import copy
import inspect
import pydoc
import math
import pickle

import numpy as np
import pytest

import filasofia as fs


def test_defaults_are_those_of_the_structs():
    material = fs.FemMaterial()
    assert material.young_modulus == 10e3
    assert material.poisson_ratio == 0.45
    assert material.law == fs.NeoHookean()
    assert material.tearing_threshold == math.inf
    assert fs.SoftBodyDef().solver.max_iterations == 300
    assert fs.Ogden().terms == [fs.OgdenTerm()]
    assert fs.PhysicsDef().gravity == (0.0, -9.81, 0.0)
    assert fs.RigidBodyDef().elements == [fs.Pose()]
    assert fs.Pose().orientation == (1.0, 0.0, 0.0, 0.0)
    assert fs.JointDef().kind == "revolute"


def test_every_def_can_be_made_shown_copied_and_compared():
    for name in fs._defs.__all__:
        kind = getattr(fs, name)
        if name == "Def" or not issubclass(kind, fs.Def):
            continue
        made = kind()
        assert repr(made) == f"{name}()", name
        assert made == kind() and made is not kind()
        for other in (copy.copy(made), copy.deepcopy(made), pickle.loads(pickle.dumps(made)), made.replace()):
            assert type(other) is kind and other == made, name
        assert all(f"{field}:" in kind.__doc__ for field in made._names), name


def test_the_commands_and_the_tissues_are_among_them():
    assert {"SetPose", "Grasp", "Pause", "SetFibreStress", "VerondaWestmann", "HarmonicField", "PictureDef"} <= set(fs.__all__)
    assert "AddBody" not in fs.__all__ and "Tune" not in fs.__all__


def test_keywords_positions_and_attributes():
    assert fs.FemMaterial(young_modulus=5e3).young_modulus == 5e3
    assert fs.Ball((0, 0, 1), 0.5) == fs.Ball(centre=(0, 0, 1), radius=0.5)
    ball = fs.Ball()
    ball.radius = 2
    assert ball.radius == 2.0 and type(ball.radius) is float
    assert repr(fs.Ball(radius=2)) == "Ball(radius=2.0)"
    assert fs.Ball(radius=2).replace(radius=3) == fs.Ball(radius=3)
    assert list(inspect.signature(fs.Ball).parameters) == ["centre", "radius"]
    assert inspect.signature(fs.FemMaterial).parameters["poisson_ratio"].default == fs.FemMaterial().poisson_ratio
    assert "Ellipsis" not in pydoc.render_doc(fs.SoftBodyDef) and "friction=" in pydoc.render_doc(fs.SoftBodyDef)
    assert fs.CollisionDef(self=True).self is True  # a field of this name is no trap
    assert fs.HarmonicField(from_=fs.Labelled(label=1)).from_ == fs.Labelled(label=1)


def test_a_flag_may_be_left_to_the_engine():
    assert fs.CollisionDef().self_once_cut is None
    for given in (True, False, None):
        assert fs.CollisionDef(self_once_cut=given).self_once_cut is given
    with pytest.raises(TypeError, match="CollisionDef: self_once_cut must be "):
        fs.CollisionDef(self_once_cut="no")


def test_docstrings_say_unit_bound_and_meaning():
    assert "poisson_ratio: float, [-], must be in [0, 0.5)" in fs.FemMaterial.__doc__
    assert "Young's modulus of the tissue" in fs.FemMaterial.__doc__


def test_vectors_may_be_anything_with_three_numbers():
    for given in ((1, 2, 3), [1, 2, 3], np.array([1, 2, 3]), np.array([1, 2, 3], dtype=np.float32), np.arange(1, 4)[::1]):
        assert fs.Ball(centre=given).centre == (1.0, 2.0, 3.0)
    assert fs.SetPose(pose=(1, 2, 3)).pose == fs.Pose((1, 2, 3))
    assert fs.SetPose(pose=np.array([1, 2, 3, 0, 1, 0, 0.0])).pose == fs.Pose((1, 2, 3), (0, 1, 0, 0))
    assert fs.TissueMaterial(base_color=(0.1, 0.2, 0.3)).base_color == fs.Color(0.1, 0.2, 0.3)


def test_numbers_may_be_numpys():
    assert fs.FemMaterial(young_modulus=np.float32(4)).young_modulus == 4.0
    assert fs.NodalForce(node=np.int64(7)).node == 7
    assert fs.SoftBodyDef(gravity=np.bool_(False)).gravity is False
    assert fs.FemMaterial(stiffness_field=np.ones(3)).stiffness_field == [1.0, 1.0, 1.0]
    assert fs.Listed(np.array([3, 1])).tetrahedra == [3, 1]
    assert fs.DirectionField(np.eye(3)).directions == [(1, 0, 0), (0, 1, 0), (0, 0, 1)]


def test_nested_defs_and_lists_may_be_changed_in_place():
    body = fs.SoftBodyDef(material=fs.FemMaterial())
    body.material.young_modulus = 3e3
    body.attachments.append(fs.AttachmentDef(nodes=[1]))
    assert body.material.young_modulus == 3e3
    assert body.attachments[0].nodes == [1]
    assert fs.SoftBodyDef().attachments == []  # nothing is shared


@pytest.mark.parametrize(
    "act, error, says",
    [
        (lambda: fs.FemMaterial(young_modulus=-1), fs.Error, "FemMaterial: young_modulus must be > 0 Pa, got -1"),
        (lambda: fs.FemMaterial(poisson_ratio=0.5), fs.Error, "FemMaterial: poisson_ratio must be in [0, 0.5), got 0.5"),
        (lambda: fs.FemMaterial(young_modulus=math.nan), fs.Error, "young_modulus must be > 0 Pa, got nan"),
        (lambda: fs.FemMaterial(young_modulus=math.inf), fs.Error, "young_modulus must be > 0 Pa and finite, got inf"),
        (lambda: fs.Ball(centre=(0, math.inf, 0)), fs.Error, "Ball: centre[1] must be finite, got inf"),
        (lambda: fs.Ball(centre=(0, 0)), fs.Error, "Ball: centre must be 3 numbers, got (0, 0)"),
        (lambda: fs.Ball(centre="abc"), TypeError, "Ball: centre must be 3 numbers, got 'abc'"),
        (lambda: fs.Ball(centre=None), TypeError, "Ball: centre must be 3 numbers, got None"),
        (lambda: fs.Ball(centre=np.zeros((3, 3))), TypeError, "Ball: centre[0] must be a number"),
        (lambda: fs.Ball(centre={1, 2, 3}), TypeError, "Ball: centre must be 3 numbers"),
        (lambda: fs.Ball(radius="1"), TypeError, "Ball: radius must be a number, got '1'"),
        (lambda: fs.Ball(radius=True), TypeError, "Ball: radius must be a number, got True"),
        (lambda: fs.Ball(radius=10**400), fs.Error, "Ball: radius must be > 0 m, got 1000000"),
        (lambda: fs.Ball(radius=1j), TypeError, "Ball: radius must be a number, got 1j"),
        (lambda: fs.NodalForce(node=1.0), TypeError, "NodalForce: node must be a whole number, got 1.0"),
        (lambda: fs.NodalForce(node=-1), fs.Error, "NodalForce: node must be a whole number >= 0, got -1"),
        (lambda: fs.NodalForce(node=2**40), fs.Error, "node must be a whole number in [-2147483648, 2147483647]"),
        (lambda: fs.SoftBodyDef(gravity=1), TypeError, "SoftBodyDef: gravity must be True or False, got 1"),
        (lambda: fs.SoftBodyDef(name=3), TypeError, "SoftBodyDef: name must be a text, got 3"),
        (lambda: fs.SoftBodyDef(name="\udc80"), fs.Error, "SoftBodyDef: name must be a text that UTF-8 can hold"),
        (lambda: fs.SoftBodyDef(attachments=5), TypeError, "SoftBodyDef: attachments must be a list, got 5"),
        (lambda: fs.SoftBodyDef(attachments=[5]), TypeError, "attachments[0] must be an AttachmentDef, got 5"),
        (lambda: fs.SoftBodyDef(material="x"), TypeError, "material must be one of FemMaterial | MassSpringMaterial | ShellMaterial, got 'x'"),
        (lambda: fs.FemMaterial(law=fs.Fung), TypeError, "(did you mean Fung()?)"),
        (lambda: fs.FemMaterial(law="fung"), TypeError, "(did you mean Fung()?)"),
        (lambda: fs.JointDef(kind="revolut"), fs.Error, "must be 'revolute' or 'prismatic', got 'revolut' (did you mean 'revolute'?)"),
        (lambda: fs.SoftBodyDef(total_mass=1), TypeError, "SoftBodyDef has no field 'total_mass' (did you mean 'mass'?)"),
        (lambda: fs.TotalMass(mass=1), TypeError, "TotalMass has no field 'mass' (it has value)"),
        (lambda: fs.FemMaterial(youngs_modulus=1), TypeError, "FemMaterial has no field 'youngs_modulus' (did you mean 'young_modulus'?)"),
        (lambda: setattr(fs.FemMaterial(), "poisson", 1), AttributeError, "FemMaterial has no field 'poisson'"),
        (lambda: fs.Ball((0, 0, 0), 1, 2), TypeError, "Ball has 2 fields, got 3 values"),
        (lambda: fs.Ball((0, 0, 0), centre=(0, 0, 0)), TypeError, "Ball: centre is given twice"),
        (lambda: fs.SetPose(pose=(1, 2)), fs.Error, "SetPose: pose must be a Pose, 3 numbers (its position) or 7"),
        (lambda: fs.SoftBodyDef(mesh=7), TypeError, "SoftBodyDef: mesh must be one of str | TetMesh | TriangleMesh, got 7"),
    ],
)
def test_one_error_names_def_field_bound_value_and_the_right_word(act, error, says):
    with pytest.raises(error) as caught:
        act()
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_failed_assignment_changes_nothing():
    material = fs.FemMaterial(young_modulus=5e3)
    with pytest.raises(fs.Error):
        material.young_modulus = -1
    assert material.young_modulus == 5e3
    with pytest.raises(AttributeError):
        del material.young_modulus


def test_errors_are_value_errors():
    assert issubclass(fs.Error, ValueError)
    assert fs.Error.__module__ == "filasofia"


def test_what_was_put_into_a_list_is_found_when_the_def_is_used():
    body = fs.SoftBodyDef(name="liver", mesh=fs.shapes.block((1, 1, 1)))
    body.attachments.append("garbage")
    with pytest.raises(TypeError, match=r"soft body 'liver': attachments\[0\] must be an AttachmentDef, got 'garbage'"):
        fs.Simulation(threads=1).add(body)
    body.attachments[:] = [fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, 1, 1)))]
    body.material.regions.append(fs.TissueRegion(where=fs.Listed([0]), young_modulus=1.0))
    fs.Simulation(threads=1).add(body)
