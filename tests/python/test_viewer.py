"""A window in which a person watches."""

import subprocess
import sys
import time

import numpy as np
import pytest

import filasofia as fs
from scenes import poke
from virtual_display import virtual_display


@pytest.fixture
def display(monkeypatch):
    with virtual_display() as name:
        monkeypatch.setenv("DISPLAY", name)
        yield


def test_a_window_shows_the_run_and_changes_nothing(display):
    sim, _, tool = poke()
    alone, _, same = poke()
    usual = sim.render(64, 48)
    with fs.viewer.launch_passive(sim, window=fs.WindowDef(width=320, height=240, title="test")) as viewer:
        assert viewer.is_running()
        with pytest.raises(fs.Error, match="has one already"):
            fs.viewer.launch_passive(sim)
        assert np.array_equal(sim.render(64, 48), usual)
        for i in range(30):
            for each, ball in ((sim, tool), (alone, same)):
                each.set_pose(ball, (0, 0.025 - 2e-4 * i, 0))
                each.step()
            viewer.sync()
        time.sleep(0.1)  # it draws by itself
        assert sim.state_hash == alone.state_hash
        viewer.close()
        assert not viewer.is_running()
        viewer.sync()  # does nothing now
    sim.step()
    assert sim.render(64, 48).std() > 5
    with pytest.raises(fs.Error, match="viewer: the simulation is closed"):
        sim.close()
        fs.viewer.launch_passive(sim)


def test_one_simulation_at_a_time_has_a_window_and_each_may(display):
    first, *_ = poke()
    second, *_ = poke()
    with fs.viewer.launch_passive(first):
        with pytest.raises(fs.Error, match="another thread of this program has a window open"):
            fs.viewer.launch_passive(second)
    with fs.viewer.launch_passive(second) as viewer:
        assert viewer.is_running()
    with fs.viewer.launch_passive(first) as viewer:
        assert viewer.is_running()


def test_the_end_of_a_simulation_closes_its_viewer():
    sim, *_ = poke()
    viewer = fs.viewer.launch_passive(sim, backend="null")
    assert viewer.is_running()
    sim.close()
    assert not viewer.is_running()
    viewer.close()


def test_without_a_display_there_is_one_clear_error(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    sim, *_ = poke()
    with pytest.raises(fs.Error, match="DISPLAY is not set"):
        fs.viewer.launch_passive(sim)
    with pytest.raises(fs.Error, match=r"rate must be in \[1, 1000\] 1/s, got 0"):
        fs.viewer.launch_passive(sim, rate=0)
    with pytest.raises(TypeError, match="ViewerDef has no field 'widht'"):
        fs.viewer.launch_passive(sim, widht=3)
    sim.step()
    assert sim.render(64, 48).std() > 5


def test_an_interpreter_ends_with_an_open_viewer():
    program = (
        "import filasofia as fs, time\n"
        "sim = fs.Simulation(threads=1)\n"
        "sim.add(fs.SoftBodyDef(name='b', mesh=fs.shapes.block((0.1, 0.1, 0.1), (2, 2, 2))))\n"
        "viewer = fs.viewer.launch_passive(sim, backend='null')\n"
        "sim.run(0.1)\n"
        "time.sleep(0.1)\n"
        "print(viewer.is_running())\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "True\n", "")
