"""Sessions and their measures."""
import json
import os

import pytest

import filasofia as fs
from scenes import poke


def test_the_path_of_a_tool_is_measured_as_it_was_moved(tmp_path):
    file = tmp_path / "session.jsonl"
    sim, tissue, tool = poke()
    sim.measure(bodies=[fs.TrackedBody(body=tool, role="tool")], file=file, trainee="A. B.", task="poke",
                steps=["there", "back"], watched=["perforation"])
    sim.step()
    start = sim.frame[tool].poses[0, :3].copy()
    sim.step(400, {tool: start + (0.03, 0, 0)})
    sim.mark("step", "there")
    sim.step(200, {tool: start})
    sim.close()
    measures = fs.measures(file)
    assert measures["path_length"] == pytest.approx(0.06, rel=0.03)  # the filter of 20 Hz rounds the turn
    assert measures["duration"] == pytest.approx(0.6, rel=0.02)
    assert measures["steps_done"] == 0.5 and measures["perforations"] == 0.0 and measures["mistakes"] == 0.0
    assert set(measures) >= {"path_length", "duration"} and None in measures.values()
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    assert lines[0]["trainee"] == "A. B." and lines[0]["case"] == "poke"
    assert any("there" in json.dumps(line) for line in lines[1:])


def test_a_task_that_is_left_before_its_end_is_unfinished_in_the_session(tmp_path):
    scene = os.path.join(os.environ["FILASOFIA_ROOT"], "examples/scenes/biopsy.json")
    found = []
    for steps in (1000, 2600):
        file = tmp_path / f"{steps}.jsonl"
        sim = fs.load(scene, measures=file)
        sim.step(steps)
        sim.close()
        lines = [json.loads(line) for line in file.read_text().splitlines()]
        found.append([line["what"] for line in lines if line.get("event") == "unfinished"])
    assert found == [["the run ended: 1 of 3 steps done, next 'grasp'"], []]


def test_the_task_of_a_scene_tells_how_far_it_is():
    scene = os.path.join(os.environ["FILASOFIA_ROOT"], "examples/scenes/biopsy.json")
    sim = fs.load(scene)
    assert (sim.task.state, sim.task.step, sim.task.time) == ("running", 0, 0.0)
    sim.step(1000)
    state = sim.save_state()
    early = sim.task
    assert (early.name, early.state, early.step) == ("biopsy", "running", 1) and len(early.steps) == 3
    assert early.instruction and early.steps[early.step] == "grasp" and early.target.shape == (3,)
    assert 0 < early.done_at[0] < early.time == pytest.approx(sim.time - 2 * sim.dt, abs=1e-9)  # it began with a state
    sim.step(1600)
    done = sim.task
    assert (done.state, done.step, done.instruction, done.target) == ("done", 3, "", None)
    assert done.done_at == sorted(done.done_at) and len(done.done_at) == 3
    assert repr(done).startswith("TaskProgress(name='biopsy', state='done', step=3 of 3, time=")
    assert early.step == 1  # what was asked for is a copy
    sim.restore(state)
    sim.step()
    assert sim.task.step == 1 and sim.task.done_at == early.done_at
    sim.close()
    assert sim.task.step == 1
    assert fs.Simulation().task is None


def test_a_task_whose_time_is_over_has_failed(tmp_path):
    scene = tmp_path / "scene.json"
    wait = {"name": "wait", "done": {"type": "Waited", "seconds": "1 s"}}
    scene.write_text(json.dumps({"bodies": [], "task": {"name": "hold on", "timeLimit": "50 ms", "steps": [wait]}}))
    sim = fs.load(scene)
    sim.step(30)
    assert sim.task.state == "running"
    sim.step(30)
    assert sim.task.state == "failed" and sim.task.step == 0 and sim.task.done_at == []


def test_a_scene_is_measured_by_its_task(tmp_path):
    scene = os.path.join(os.environ["FILASOFIA_ROOT"], "examples/scenes/biopsy.json")
    file = tmp_path / "biopsy.jsonl"
    sim = fs.load(scene, measures=file)
    assert len(sim.bodies) == 4
    sim.step(1600)
    state = sim.save_state()  # the jaws hold the polyp, and the task is done
    sim.step(300)
    last = sim.state_hash
    sim.restore(state)
    sim.step(300)
    assert sim.state_hash == last
    other = fs.load(scene, threads=1)  # without measures
    other.step()
    other.restore(state)
    other.step(300)
    assert other.state_hash == last
    sim.close()
    measures = fs.measures(file)
    assert measures["steps_done"] == 1.0 and measures["tears_unintended"] == 0.0
    assert 0.01 < measures["path_length"] < 0.04


def test_what_is_measured_goes_back_with_a_state(tmp_path):
    measured = {}
    for detour in (False, True):
        file = tmp_path / f"{detour}.jsonl"
        sim, _, tool = poke()
        sim.measure(bodies=[fs.TrackedBody(body=tool)], file=file, steps=["there"])
        sim.step()
        start = sim.frame[tool].poses[0, :3].copy()
        if detour:
            state = sim.save_state()
            sim.step(300, {tool: start + (0, 0.03, 0)})
            sim.mark("step", "there")
            sim.restore(state)
        sim.step(400, {tool: start + (0.03, 0, 0)})
        sim.close()
        measured[detour] = fs.measures(file)
    assert measured[True] == measured[False]
    assert measured[True]["path_length"] == pytest.approx(0.03, rel=0.03) and measured[True]["steps_done"] == 0.0
    sim, _, tool = poke()
    sim.measure(bodies=[fs.TrackedBody(body=tool)], file=tmp_path / "a.csv")
    sim.step()
    with pytest.raises(fs.Error, match="a.csv', where time only goes on"):
        sim.restore(sim.save_state())


def test_measures_that_are_wrong_are_errors(tmp_path):
    sim, _, tool = poke()
    with pytest.raises(fs.Error, match="mark: nothing is measured"):
        sim.mark("step", "x")
    with pytest.raises(fs.Error, match="file must name"):
        sim.measure(bodies=[fs.TrackedBody(body=tool)])
    with pytest.raises(fs.Error, match="bodies"):
        sim.measure(file=tmp_path / "a.jsonl")
    with pytest.raises(fs.Error):
        sim.measure(bodies=[fs.TrackedBody(body=99)], file=tmp_path / "a.jsonl")
    sim.step()
    with pytest.raises(fs.Error, match="before the first step"):
        sim.measure(bodies=[fs.TrackedBody(body=tool)], file=tmp_path / "a.jsonl")
    with pytest.raises(fs.Error, match="mark: kind must be one of"):
        fs.Simulation().mark("jump")
    with pytest.raises(fs.Error, match="load: measures must name a .jsonl or .csv file, got ''"):
        fs.load(os.path.join(os.environ["FILASOFIA_ROOT"], "examples/scenes/biopsy.json"), measures="")
    with pytest.raises(fs.Error, match="file must be a text without NUL characters, got 'a"):
        fs.measures("a\0b")
    with pytest.raises(fs.Error, match="nothing.jsonl"):
        fs.measures(tmp_path / "nothing.jsonl")
