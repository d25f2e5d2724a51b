"""filasofia.gym: the gall bladder, off its bed and out."""

import numpy as np
import pytest

pytest.importorskip("gymnasium", reason="pip install filasofia[gym]")

from filasofia import gym  # noqa: E402
from filasofia.gym.scripted import scripted  # noqa: E402


@pytest.fixture(scope="module")
def dissection():
    env = gym.GallbladderDissection(difficulty=1)
    yield env
    env.close()


def test_each_episode_has_its_own_anatomy(dissection):
    env, places, firm = dissection, [], []
    for seed in (0, 1, 0):
        env.reset(seed=seed)
        places.append(np.concatenate([env.neck(), env.holding(1).mean(axis=0)]))
        firm.append(env.sim.state_hash)
    assert np.linalg.norm(places[0] - places[1]) > 5e-4
    assert np.array_equal(places[0], places[2]) and firm[0] == firm[2] != firm[1]
    assert env.share(0) > 0.85 and env.share(1) > 0.85


@pytest.mark.parametrize("pedal", [1.0, -1.0])
def test_the_hook_parts_the_bed_only_while_its_pedal_is_pressed(dissection, pedal):
    env = dissection
    env.reset(seed=2)
    act = scripted(env)
    for _ in range(40):
        action = act()
        _, _, _, _, info = env.step([*action[:-1], min(action[-1], pedal)])
    assert (info["measures"]["bed"] < 0.8) == (pedal > 0)
    assert env.sim.energy(env.hook).active == pytest.approx(0) or pedal > 0


def test_a_bed_that_is_torn_off_is_no_success(dissection):
    env = dissection
    env.reset(seed=1)
    for _ in range(60):
        _, _, terminated, _, info = env.step([-1, 1, 1, 0, 0, 0, 0, 0])
    assert info["measures"]["bed"] == 0 and info["measures"]["torn"] > 40
    assert not info["is_success"] and not terminated


def test_a_hook_that_lingers_burns_the_liver_and_costs(dissection):
    env = dissection
    env.reset(seed=1)
    deep = np.array([0.0, 0.012, -0.009])
    rewards = []
    for _ in range(90):
        away = deep - env.tools[1].place
        _, _, _, _, info = env.step([0, 0, 0, 0, *np.clip(away / 0.0024, -1, 1), float(np.linalg.norm(away) < 0.02)])
        rewards.append(info["reward_terms"]["burnt"] + info["reward_terms"]["lost"])
    assert info["measures"]["burnt"] + info["measures"]["lost"] > 0
    assert sum(rewards) < -0.1


def test_a_clip_before_anything_is_dissected_is_no_critical_view():
    env = gym.Cholecystectomy(difficulty=2)
    env.reset(seed=0)
    tube, tool = env.duct, env.tools[1]
    for _ in range(120):
        place = tube.at(0.8)
        near = np.linalg.norm(place - tool.place) < 5e-4 and env.chosen == 1
        move = np.clip((place - tool.place) / 0.0024, -1, 1)
        _, _, _, _, info = env.step([0, 0, 0, 0, *move, 0.5, np.clip(1 - tool.values[1], -1, 1), 1.0 if near else -1.0])
    assert tube.clips() == (0, 1) and env.clips.left == env.count - 1
    assert info["measures"]["clips"] == 1 and info["measures"]["viewed"] == 0
    assert tube.missing() == 2 and not tube.is_cut() and env.begun
    env.close()


def test_the_scripted_operation_leaves_two_clips_and_one_on_each_tube():
    env = gym.Cholecystectomy()
    env.reset(seed=0)
    act, stages = scripted(env), []
    for _ in range(env.max_steps):
        _, _, terminated, _, info = env.step(act())
        now = info["measures"]
        stages.append([now["parted"], -now["bed"], now["clips"], now["cut"]])
        if terminated:
            break
    assert info["is_success"] and now["viewed"] == 1
    assert [tube.clips() for tube in env.tubes] == [(1, 2), (1, 2)]
    assert all(tube.is_cut() and env.sim.duct(tube.body).leak == 0 for tube in env.tubes)
    assert (np.diff(np.array(stages), axis=0) >= 0).all()  # nothing that was done is undone
    assert now["lost"] < 1e-6 and now["burnt"] < 60e-6
    env.close()
