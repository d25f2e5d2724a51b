"""filasofia.gym: a polyp, and a myoma, in the cavity of a uterus."""

import numpy as np
import pytest

pytest.importorskip("gymnasium", reason="pip install filasofia[gym]")

from filasofia import gym  # noqa: E402
from filasofia.gym.scripted import scripted  # noqa: E402


def test_each_seed_turns_the_uterus_and_the_polyp_with_it():
    env = gym.HysteroscopicPolypectomy()
    places = []
    for seed in range(4):
        env.reset(seed=seed)
        pelvis = env.moves()[env.pelvis]
        assert np.allclose(env.sim.frame[env.pelvis].poses[0][:3], pelvis.position, atol=1e-6)
        places.append(env.root())
    spread = np.ptp(places, axis=0)
    assert spread.max() > 1e-3 and spread.max() < 0.02
    env.close()


def test_the_polyp_comes_out_and_its_root_stays():
    env = gym.HysteroscopicPolypectomy(difficulty=2)
    env.reset(seed=1)
    root, act = env.root(), scripted(env)
    for _ in range(env.max_steps):
        _, _, terminated, _, info = env.step(act())
        if terminated:
            break
    assert info["is_success"] and info["measures"]["way"] == 0
    assert np.linalg.norm(env.root() - root) < 2e-3
    env.close()


def test_forceps_stay_in_the_cavity_and_what_presses_the_wall_is_no_success():
    env = gym.HysteroscopicPolypectomy()
    env.reset(seed=0)
    env.step([0, 0, 0, -1])
    for _ in range(120):
        _, _, _, _, info = env.step([1.0, -1.0, 0.0, 0.0])  # to the side, and on to the fundus
    tool = env.tools[0]
    assert np.allclose(env.limit(tool, tool.place), tool.place, atol=1e-9)
    assert tool.place[1] < -0.05 and abs(tool.place[0]) < 0.014
    env.hurt = True  # as a force above the limit makes it
    assert not env.judge().success
    env.close()


def test_forceps_take_nothing_that_is_out_of_their_reach():
    env = gym.HysteroscopicPolypectomy()
    env.reset(seed=0)
    for _ in range(5):
        env.step([0.0, 0.0, 0.0, 1.0])
    assert not env.holds(env.tools[0])
    env.close()


def test_what_chips_take_is_what_is_left_less():
    env = gym.HysteroscopicMyomectomy()
    env.reset(seed=0)
    act = scripted(env)
    for _ in range(110):  # the first stroke, until a chip comes off
        _, _, _, _, info = env.step(act())
        if env.floating:
            break
    assert 0.0 < env.removed < 0.2 * env.whole
    assert info["measures"]["left"] == 1.0 - env.removed / env.whole
    chips = sum(each.mass for cut in env.cuts for each in cut.rupture.detached)
    assert np.isclose(chips, env.removed * env.density)
    for _ in range(env.floats + 1):
        env.step([0, 0, 0, 0, -1])
    assert env.floating == []
    env.close()


def test_a_loop_without_current_cuts_nothing():
    env = gym.HysteroscopicMyomectomy()
    env.reset(seed=0)
    act = scripted(env)
    for _ in range(110):
        action = act()
        action[-1] = -1.0
        env.step(action)
    assert env.removed == 0.0 and env.cuts == [] and env.left() == 1.0
    env.close()


def test_a_loop_that_cuts_the_wall_is_no_success():
    env = gym.HysteroscopicMyomectomy()
    env.reset(seed=0)
    tool = env.tools[0]
    for _ in range(40):  # beside the myoma, and down into the wall
        env.step(np.append(np.clip((np.array([0.004, -0.035, -0.006]) - tool.place) / 6e-4, -1, 1), (0, -1)))
    for _ in range(60):
        _, _, _, _, info = env.step([0.0, -1.0, -0.2, 0.0, 1.0])
    assert info["measures"]["wall"] > 5e-6
    env.removed = env.whole
    env.wall = 31e-6
    assert not env.judge().success
    env.close()


def test_the_pedal_goes_back_with_a_state():
    env = gym.HysteroscopicMyomectomy()
    env.reset(seed=3)
    env.step([0, 0, 0, 0, 1])
    assert env.pressed
    state = env.save_state()
    ahead = env.step([0, -1, 0, 0.5, 1])[4]["state_hash"]
    env.step([0, 0, 0, 0, -1])
    assert not env.pressed
    env.restore_state(state)
    assert env.pressed and env.step([0, -1, 0, 0.5, 1])[4]["state_hash"] == ahead
    env.close()
