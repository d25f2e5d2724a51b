"""Wrong arguments of functions."""

import math

import pytest

import filasofia as fs
from scenes import poke


class Odd:
    def __repr__(self):
        raise RuntimeError


@pytest.mark.parametrize(
    "act, line",
    [
        (lambda sim: sim.step(1.5), "step: n must be a whole number, got 1.5"),
        (lambda sim: sim.step("a\nb" * 50), r"step: n must be a whole number, got 'a\nba\nba\nb"),
        (lambda sim: sim.step(Odd()), "step: n must be a whole number, got a Odd"),
        (lambda sim: sim.step(1, None, 3), "step: takes at most 2 arguments, got 3"),
        (lambda sim: sim.step(count=3), "step has no argument 'count' (it has n, moves)"),
        (lambda sim: sim.step(move={}), "step has no argument 'move' (did you mean 'moves'?)"),
        (lambda sim: sim.step(1, n=2), "step: n is given twice"),
        (lambda sim: sim.step(2**70), "step: n must be a whole number that C++ can hold, got 1180591620717411303424"),
        (lambda sim: sim.mark("step", 5), "mark: what must be a text, got 5"),
        (lambda sim: sim.mark("step", "a", "b"), "mark: amount must be a number or None, got 'b'"),
        (lambda sim: sim.run("x"), "run: seconds must be a number, got 'x'"),
        (lambda sim: sim.run(), "run: seconds is missing: it takes (seconds: float)"),
        (lambda sim: sim.close(3), "close: takes no arguments, got 1"),
        (lambda sim: sim.pause("yes"), "pause: paused must be True or False, got 'yes'"),
        (lambda sim: sim.measure(steps=[5]), "measure: steps must be a list of texts, got [5]"),
        (lambda sim: fs.save_scene("a"), "save_scene: scene is missing: it takes (recording: str | os.PathLike[str], "),
        (lambda sim: fs.shapes.sphere("a"), "sphere: radius must be a number, got 'a'"),
        (lambda sim: fs.TetMesh(), "TetMesh: nodes is missing: it takes (nodes: ArrayLike, "),
        (lambda sim: fs.Simulation.step(5), "step: takes (n: int=1, "),
        (lambda sim: sim.off(-1), "off: observer must be a whole number that C++ can hold, got -1"),
        (lambda sim: fs.shapes.block((1, 1, 1), (1.5, 1, 1)), "block: cells must be whole numbers, got (1.5, 1, 1)"),
        (lambda sim: fs.load(None), "load: file must be a text, got None"),
        (lambda sim: sim.film("a"), "film: seconds must be a number, got 'a'"),
        (lambda sim: sim.film(0.1, fps=None), "film: fps must be a number, got None"),
        (lambda sim: fs.Film(5), "film: pictures must be a list of them, got 5"),
        (lambda sim: fs.Film([], fps="x"), "film: fps must be a number, got 'x'"),
        (lambda sim: fs.viewer.launch_passive(5), "launch_passive: sim must be a Simulation, got 5"),
    ],
)
def test_a_wrong_call_is_one_line_with_function_argument_and_value(act, line):
    sim, _, _ = poke()
    with pytest.raises(TypeError) as caught:
        act(sim)
    assert str(caught.value).startswith(line) and "\n" not in str(caught.value)


def test_an_empty_name_of_a_file_is_seen():
    for act in (fs.load, fs.measures):
        with pytest.raises(fs.Error, match="^'': no such file"):
            act("")
    for call in (fs.replay, lambda: fs.replay(file=""), lambda: fs.replay(fs.ReplayDef(check=True))):
        with pytest.raises(fs.Error, match="^replay: file must name a recording, got ''$"):
            call()


def test_errors_of_callbacks_stay_what_they_are():
    sim, _, _ = poke()
    sim.every_step(lambda time: "a" + 1)
    with pytest.raises(TypeError, match="can only concatenate str"):
        sim.step()


def test_what_a_stranger_types_is_one_clear_line():
    sim = fs.Simulation(rate=1000)
    body = sim.add(fs.RigidBodyDef(elements=[(0, 0, 0)]))
    sim.step()
    for act, says in [
        # Copied, these would fill the memory.
        (lambda: fs.SoftBodyDef(pose=range(10**12)), "SoftBodyDef: pose must be a Pose, 3 numbers .*, got range"),
        (lambda: fs.Box(range(10**12), (1, 1, 1)), "Box: low must be 3 numbers, got range"),
        (lambda: fs.axis_angle((0, 1, 0), math.nan), "axis_angle: angle must be finite, got nan"),
        (lambda: fs.shapes.block((1, 1, 1), (2**31, 1, 1)), r"block: cells must have whole numbers below 2\^31, got"),
        (lambda: fs.shapes.block((1, 1, 1), (1, 1)), r"block: cells must be 3 numbers, got \(1, 1\)"),
        (lambda: fs.load("none.json", physics=3), "none.json: no such file"),
        (lambda: fs.load(fs.asset("scenes/box_trainer.json"), physics=3), "load: physics must be a PhysicsDef, got 3"),
        (lambda: fs.load_tet_mesh(""), "^a file of a mesh must have a name, got ''"),
        (lambda: fs.Simulation(3), "Simulation: physics must be a PhysicsDef, got 3"),
        (lambda: fs.replay("run.rec"), "replay: definition must be a ReplayDef, got 'run.rec'"),
        (lambda: sim.add_electrode(body, 5), "add_electrode: electrode must be an ElectrodeDef, got 5"),
        (lambda: sim.extract(None), "extract: command must be an Extract, got None"),
        (lambda: sim.show(None), "show: body must be a BodyId, got None"),
        (lambda: sim.set_pose(None, (0, 0, 0)), "set_pose: body must be a BodyId, got None"),
        (lambda: sim.release(None), "release: attachment must be an AttachmentId, got None"),
        (lambda: sim.measure(file="x.jsonl", steps="abc"), "measure: steps must be a list of texts, got 'abc'"),
        (lambda: sim.measure(file="x.jsonl", targets=3), "measure: targets must be a list of texts, got 3"),
        (lambda: sim.frame[None], "frame: body must be a BodyId, got None"),
        (lambda: list(sim.frame), "'Frame' object is not iterable"),
        (lambda: fs.FemMaterail, r"has no attribute 'FemMaterail' \(did you mean 'FemMaterial'\?\)"),
    ]:
        with pytest.raises((fs.Error, TypeError, AttributeError), match=says) as caught:
            act()
        assert "\n" not in str(caught.value)
    assert body in sim.frame and 99 not in sim.frame
