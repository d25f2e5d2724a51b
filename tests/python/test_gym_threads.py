"""filasofia.gym: instruments that turn, threads, stitches."""

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium", reason="pip install filasofia[gym]")

import filasofia as fs  # noqa: E402
from filasofia import gym  # noqa: E402
from filasofia.gym.scripted import scripted  # noqa: E402
from filasofia.gym.tool import turned  # noqa: E402


def solved(env, seed):
    """Runs the policy of the task; returns the last info."""
    env.reset(seed=seed)
    act = scripted(env)
    for _ in range(300):
        *_, terminated, truncated, info = env.step(act())
        if terminated or truncated:
            break
    assert info["is_success"], info["measures"]
    return info


class Probe(gym.SurgicalEnv):
    """An instrument in a port, with two joints."""

    port = (0.02, 0.2, 0.05)

    def build(self):
        start = (0.0, 0.05, 0.0)
        joints = (gym.Joint(-0.5, 1.0, 2.0, (0.0, 1.0, 0.0)), gym.Joint(0.0, 0.03, 0.1, start=0.01))
        box = (-0.03, 0.02, -0.03), (0.03, 0.08, 0.03)
        return [gym.Tool(self.tip("tip", start), start, *box, port=self.port, joints=joints)]

    def judge(self):
        return gym.Judgement({}, False, {})


@pytest.mark.parametrize("action", ["box", "discrete"])
def test_an_instrument_turns_about_its_port_and_its_shaft(action):
    env = Probe(action=action)
    seen, _ = env.reset(seed=0)
    assert seen.shape == (5,) and seen[3:] == pytest.approx([-1 / 3, -1 / 3])
    if action == "box":
        assert env.action_space.shape == (5,)
        moves = [np.array(each) for each in ([1, -1, 0.5, 0, 0], [0, 0, 0, 1, -1])]
    else:
        assert env.action_space.n == 11
        moves = [2, 3, 6, 8, 9]  # +x, -y, +z, the first joint on, the second one back
    for move in moves * 8:
        seen, *_ = env.step(move)
    tool = env.tools[0]
    place, turn = env.sim.frame[tool.body].poses[0, :3], env.sim.frame[tool.body].poses[0, 3:]
    assert place == pytest.approx(tool.place) and tool.place[0] == pytest.approx(0.016)
    shaft = np.subtract(env.port, place)
    assert turned(turn, (0, 1, 0)) == pytest.approx(shaft / np.linalg.norm(shaft))
    assert tool.values == pytest.approx([0.32, 0.0])  # 8 x 20 ms x 2 rad/s; the end of the slide
    upright = gym.Tool(tool.body, tool.start, tool.low, tool.high, port=env.port)
    upright.place = tool.place
    across = turned(turn, (1, 0, 0))
    assert across @ turned(upright.turn(), (1, 0, 0)) == pytest.approx(np.cos(0.32))
    for _ in range(60):
        seen, *_ = env.step(moves[1] if action == "box" else 8)
    assert tool.values[0] == 1.0 and seen[3] == 1.0
    env.reset(seed=0)
    assert tool.values == pytest.approx([0.0, 0.01])
    env.close()


def test_depth_in_a_hole_is_where_the_thread_is():
    env = gym.ThreadInHole(difficulty=1)
    info = solved(env, 3)
    places = env.sim.frame[env.string].positions
    assert info["measures"]["depth"] == pytest.approx(0.03 - places[-1, 1], abs=1e-9)
    below = places[places[:, 1] < 0.03] - env.middle
    assert len(below) >= 5 and np.hypot(below[:, 0], below[:, 2]).max() < env.inner - 0.8e-3 + 1e-4  # within the wall
    env.close()


def test_a_thread_beside_the_hole_is_not_in_it():
    env = gym.ThreadInHole()
    env.reset(seed=0)
    tool = env.tools[0]
    for _ in range(100):  # down beside the cylinder
        step = 0.06 * 0.02
        _, _, _, _, info = env.step(np.clip((np.array([-0.045, 0.05, 0.0]) - tool.place) / step, -1, 1))
    assert env.sim.frame[env.string].positions[-1, 1] < 0.02 and info["measures"]["depth"] == 0.0
    env.close()


def test_a_rope_is_through_an_eyelet_as_far_as_it_is_and_graspers_do_not_fit_through():
    env = gym.RopeThreading(difficulty=1)
    info = solved(env, 2)
    places = env.sim.frame[env.rope].positions
    along = (places - env.places[0]) @ env.axis(0)
    behind = int(np.flatnonzero(along < 0)[0])
    length = np.linalg.norm(np.diff(places[:behind], axis=0), axis=1).sum()
    assert length <= info["measures"]["through"] <= length + 4.1e-3  # the eyelet is within the next edge
    tool = env.tools[0]
    env.step(np.array([0, 0, 0, 0, -1, 0, 0, 0, 0, 0]))
    tool.place = env.places[0] - 0.02 * env.axis(0)
    for _ in range(30):
        env.step(np.append(env.axis(0), np.zeros(7)))
        assert (tool.place - env.places[0]) @ env.axis(0) < -0.003
    env.close()


def test_a_vessel_that_is_let_go_gets_wide_again():
    env = gym.LigatingLoop(difficulty=1)
    info = solved(env, 1)
    tight = info["measures"]
    assert tight["constriction"] > 0.15 and tight["tension"] > 0.05
    for _ in range(25):
        _, _, _, _, info = env.step(np.array([0, 0, 0, 0, -1.0]))
    assert info["measures"]["constriction"] < 0.03 and info["measures"]["tension"] < 0.5 * tight["tension"]
    assert not info["is_success"]
    env.close()


def test_a_needle_that_is_let_go_stays_in_tissue_and_falls_in_air():
    env = gym.Suture()
    env.reset(seed=0)
    act = scripted(env)
    for _ in range(200):
        action = act()
        if action[-1] < 0:
            break
        env.step(action)
    assert len(env.sim.frame.channels) == 2
    before = env.needle_at(90)
    for _ in range(15):
        env.step(np.array([0, 0, 0, 0, -1.0]))
    assert not env.holds(env.tools[0]) and np.linalg.norm(env.needle_at(90) - before) < 1e-3
    env.reset(seed=0)
    before = env.needle_at(90)
    for _ in range(10):
        env.step(np.array([0, 0, 0, 0, -1.0]))
    assert before[1] - env.needle_at(90)[1] > 3e-3
    env.close()


def test_wrong_joints_and_far_grips_change_nothing():
    env = gym.Suture()
    env.reset(seed=0)
    with pytest.raises(fs.Error, match="Suture: the action must be 5 finite numbers"):
        env.step(np.zeros(4))
    env.step(np.array([0, 0, 0, 0, -1.0]))
    for _ in range(10):  # away from the needle, which falls: there is nothing to clamp
        env.step(np.array([0, 1.0, 0, 0, 0]))
    env.step(np.array([0, 0, 0, 0, 1.0]))
    assert not env.holds(env.tools[0])
    env.close()


def test_a_catheter_is_as_deep_as_it_is_and_the_grasper_keeps_off_the_duct():
    env = gym.Cannulation(difficulty=2)
    info = solved(env, 1)
    tip = env.sim.frame[env.catheter].positions[-1] - env.middle
    assert 0.015 <= info["measures"]["depth"] <= 0.02
    assert info["measures"]["depth"] == pytest.approx(tip @ env.axis(), abs=1e-3)
    assert abs(np.hypot(*(tip - tip @ env.axis() * env.axis() - (0, env.height, 0))[1:])) < env.inner
    for _ in range(60):  # towards the duct
        *_, info = env.step(np.array([1.0, -1.0, 0.0, -1.0]))
        out = env.tools[0].place - env.middle - (0, env.height, 0)
        along = np.clip(out @ env.axis(), -env.before, env.length - env.before)
        assert np.linalg.norm(out - along * env.axis()) > env.clearance - 1e-9
    assert info["measures"]["depth"] > 0.015
    env.close()


def test_a_catheter_that_is_pushed_past_the_duct_is_not_in_it():
    env = gym.Cannulation()
    env.reset(seed=0)
    tool, act = env.tools[0], scripted(env)
    while not env.holds(tool):
        env.step(act())
    for _ in range(120):  # above it
        wanted = env.hole() + (0.02, 0.012, 0.0) - env.sim.frame[env.catheter].positions[-1]
        _, _, _, _, info = env.step(np.append(np.clip(wanted / (0.06 * 0.02), -1, 1), 1.0))
    assert env.sim.frame[env.catheter].positions[-1] @ env.axis() > 0.01 and info["measures"]["depth"] == 0.0
    env.close()


@pytest.mark.parametrize("name", ["ThreadInHole", "RopeThreading", "LigatingLoop", "Suture", "Cannulation"])
def test_a_vector_of_them_has_the_hashes_of_single_ones(name):
    envs = gym.VectorEnv(getattr(gym, name), 2, threads=2, difficulty=2)
    _, infos = envs.reset(seed=3)
    found = [list(infos["state_hash"])]
    envs.action_space.seed(1)
    actions = [envs.action_space.sample() for _ in range(4)]
    for action in actions:
        found.append(list(envs.step(action)[4]["state_hash"]))
    envs.close()
    for i in (1, 0):
        env = getattr(gym, name)(difficulty=2)
        assert env.reset(seed=3 + i)[1]["state_hash"] == found[0][i]
        for k, action in enumerate(actions):
            assert env.step(action[i])[4]["state_hash"] == found[k + 1][i]
        env.close()


@pytest.mark.parametrize("task", [gym.LigatingLoop, gym.Suture])
def test_a_rate_at_which_threads_go_through_walls_is_an_error(task, monkeypatch):
    monkeypatch.setattr(task, "rate", 500)
    with pytest.raises(fs.Error, match=rf"{task.__name__}: rate must be a whole number in \[1000, 100000\], got 500"):
        task()
