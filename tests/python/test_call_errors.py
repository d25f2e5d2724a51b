"""Wrong arguments of functions."""

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
    for act in (fs.load, fs.measures, lambda name: fs.replay(file=name)):
        with pytest.raises(fs.Error, match="^'': no such file"):
            act("")


def test_errors_of_callbacks_stay_what_they_are():
    sim, _, _ = poke()
    sim.every_step(lambda time: "a" + 1)
    with pytest.raises(TypeError, match="can only concatenate str"):
        sim.step()
