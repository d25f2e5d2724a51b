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
        (lambda sim: sim.step(m=3), "step has no argument 'm'"),
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
    ],
)
def test_a_wrong_call_is_one_line_with_function_argument_and_value(act, line):
    sim, _, _ = poke()
    with pytest.raises(TypeError) as caught:
        act(sim)
    assert str(caught.value).startswith(line) and "\n" not in str(caught.value)


def test_errors_of_callbacks_stay_what_they_are():
    sim, _, _ = poke()
    sim.every_step(lambda time: "a" + 1)
    with pytest.raises(TypeError, match="can only concatenate str"):
        sim.step()
