"""filasofia.gym: a polyp in the cavity of a uterus."""

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
