"""filasofia.gym: environments."""

import importlib
import os
import pathlib

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium", reason="pip install filasofia[gym]")
from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode  # noqa: E402

import filasofia as fs  # noqa: E402
from filasofia import gym  # noqa: E402
from filasofia.gym.scripted import scripted  # noqa: E402

NAMES = [task.__name__ for task in gym.TASKS]
SLOW = ["LigatingLoop", "Suture", "Cholecystectomy"]  # their steps take as long as those of the other tasks together


def episode(env, seed, policy, most=None):
    """The observations, rewards and hashes of an episode, and its last info."""
    seen, info = env.reset(seed=seed)
    rows = [(seen.tobytes(), 0.0, info["state_hash"])]
    act = policy(env)
    for _ in range(most or env.max_steps):
        seen, reward, terminated, truncated, info = env.step(act())
        rows.append((seen.tobytes(), reward, info["state_hash"]))
        if terminated or truncated:
            break
    return rows, info


def at_random(seed):
    """A policy that draws its actions from the action space."""

    def policy(env):
        env.action_space.seed(seed)
        return env.action_space.sample

    return policy


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("action", ["box", "discrete"])
def test_gymnasium_accepts_every_environment(name, action):
    env = gymnasium.make(f"filasofia/{name}-v0", action=action, render_mode="rgb_array", image_size=(32, 24))
    check_env(env.unwrapped)
    env.close()


@pytest.mark.parametrize("name", NAMES)
def test_observations_are_of_the_order_of_one(name):
    env = getattr(gym, name)()
    act = at_random(5)(env)
    largest = np.abs(env.reset(seed=3)[0])
    for _ in range(20):
        largest = np.maximum(largest, np.abs(env.step(act())[0]))
    assert largest.max() < 3
    env.close()


@pytest.mark.parametrize("name", ["Reach", "PrecisionCutting"])
def test_pictures_are_observations_too(name):
    env = gymnasium.make(f"filasofia/{name}-v0", observation="rgb", image_size=(48, 32))
    check_env(env.unwrapped, skip_render_check=True)
    seen, _ = env.reset(seed=1)
    assert seen.shape == (32, 48, 3) and seen.dtype == np.uint8 and seen.max() > 60
    env.close()


def test_pictures_of_low_quality_show_the_same_depth():
    seen = []
    for quality in ("high", "low"):
        env = gym.GraspLift(observation="rgbd", image_size=(48, 32), quality=quality)
        seen.append(env.reset(seed=1)[0])
        env.close()
    assert np.array_equal(seen[0]["depth"], seen[1]["depth"])
    assert 1 < np.abs(seen[0]["rgb"].astype(int) - seen[1]["rgb"]).mean() < 40


@pytest.mark.parametrize("name", ["SearchForPoint", "GraspLift"])
def test_depth_is_an_observation_too(name):
    env = gymnasium.make(f"filasofia/{name}-v0", observation="rgbd", image_size=(48, 32))
    check_env(env.unwrapped, skip_render_check=True)
    seen, _ = env.reset(seed=1)
    assert seen["rgb"].shape == (32, 48, 3) and seen["depth"].shape == (32, 48)
    assert 0.001 < seen["depth"].min() < 0.3 and seen["depth"].max() <= env.unwrapped.lens.far
    env.close()
    envs = gym.VectorEnv(getattr(gym, name), 2, observation="rgbd", image_size=(48, 32))
    both, _ = envs.reset(seed=1)
    assert both in envs.observation_space
    assert all(np.array_equal(both[part][0], seen[part]) for part in ("rgb", "depth"))
    later, *_ = envs.step(envs.action_space.sample())
    assert not np.shares_memory(later["depth"], both["depth"])
    envs.close()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("difficulty", [0, 2])
def test_a_scripted_policy_solves_every_task_and_an_idle_one_none(name, difficulty):
    env = getattr(gym, name)(difficulty=difficulty)
    for seed in range(1 if name in [*SLOW, "ClipAndCut"] else 3):
        _, info = episode(env, seed, scripted)
        assert info["is_success"], info["measures"]
        _, info = episode(env, seed, lambda env: lambda: np.zeros(env.action_space.shape), 100)
        assert not info["is_success"], info["measures"]
    env.close()


@pytest.mark.parametrize("name", NAMES)
def test_the_same_seed_gives_the_same_bits_also_after_cuts_and_grasps(name):
    first, second = getattr(gym, name)(), getattr(gym, name)(threads=2)
    most = 90 if name in SLOW else None  # a needle is through, then, and let go
    expected, _ = episode(first, 5, scripted, most)
    assert episode(first, 5, scripted, most)[0] == expected  # what was cut is whole again
    episode(second, 6, at_random(1), 40)
    assert episode(second, 5, scripted, most)[0] == expected
    assert episode(second, 7, scripted, 20)[0] != expected[:21]
    first.close()
    second.close()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("policy", [scripted, at_random(3)])
def test_no_state_short_of_success_is_worth_waiting_in(name, policy):
    env = getattr(gym, name)()
    rows, info = episode(env, 4, policy, 80 if name in SLOW and policy is not scripted else 220)
    rewards = [reward for _, reward, _ in rows]
    if info["is_success"]:
        assert rewards.pop() > 5
    if name == "PrecisionCutting":  # what is new of the line is paid once
        assert sum(max(each, 0) for each in rewards) <= 1
    else:
        assert max(rewards) <= 0
    env.close()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("difficulty", [0, 2])
def test_what_is_knocked_about_costs_a_bounded_reward(name, difficulty):
    """A ring that fell off the board fell for ever: its reward came to -220 in a step."""
    env = getattr(gym, name)(difficulty=difficulty)
    for seed in range(3 if name == "PegTransfer" else 1):
        random = np.random.default_rng(seed)
        env.reset(seed=seed)
        for i in range(60 if name in SLOW else 200):
            if i % 12 == 0:
                action = random.choice([-1.0, 1.0], env.action_space.shape)
            seen, reward, terminated, _, info = env.step(action)
            pushing = info["reward_terms"].get("force", 0.0) + info["reward_terms"].get("wall", 0.0)
            assert -12 < reward - pushing <= 10.5, info
            if terminated:
                break
        if name == "PegTransfer":
            assert np.abs(seen).max() < 10 and min(env.ring(i)[1] for i in range(len(env.rings))) > -0.02
    env.close()


@pytest.mark.parametrize("apart", [None, [-1, 0, 0, 1, 1, 0, 0, 1], [0, -1, 0, 1, 0, 1, 0, 1]])
def test_hands_that_both_hold_a_ring_do_not_fight(apart):
    """A hard grip pressed the ring onto the board with 316 N, and both hands strained it with 38 N while it was given."""
    env = gym.PegTransfer()
    breaks, most, both = [], 0.0, 0
    env.sim.on(fs.BreakEvent, breaks.append)
    env.reset(seed=0)
    act = scripted(env)
    for _ in range(130):
        action = act()
        both += env.has(0, 0) and env.has(1, 0)
        *_, terminated, _, info = env.step(np.array(apart, float) if apart and both else action)
        most = max(most, *(float(np.linalg.norm(env.force(tool))) for tool in env.tools))
        if terminated:
            break
    print(f"a hand feels at most {most:.1f} N")
    assert both > 20 if apart else both > 0
    assert most < env.bears and not breaks  # hands do not pull on, so no grip gives way
    assert info["is_success"] == (apart is None)
    env.close()


def test_a_hand_of_finite_strength_does_not_move_against_a_larger_force():
    deepest = []
    for strength in (float("inf"), 0.05):
        env = type("Weak", (gym.Reach,), {})()
        env.tools[0].strength = strength
        env.reset(seed=0)
        for _ in range(60):
            env.step([0, -1, 0])
        deepest.append(env.tools[0].place[1])
        low = env.tools[0].place[1]
        env.step([0, 1, 0])  # away from what it presses
        assert env.tools[0].place[1] > low
        env.close()
    assert deepest[1] > deepest[0] + 0.001


def test_a_lost_ring_is_out_of_reach_and_never_pays():
    env = gym.PegTransfer()
    env.reset(seed=0)
    env.sim.set_pose(env.rings[0], (0.2, 0.1, 0))  # thrown off the board
    rewards = []
    for _ in range(60):
        seen, reward, terminated, _, info = env.step(np.zeros(env.action_space.shape))
        rewards.append(reward)
        assert not terminated
    assert info["measures"]["lost"] == 1 and -0.011 < env.ring(0)[1] < 0
    assert rewards[-1] == pytest.approx(-7) == min(rewards)
    assert np.abs(seen).max() < 4
    env.reset(seed=0)
    assert env.step(np.zeros(env.action_space.shape))[4]["measures"]["lost"] == 0
    env.close()


def test_make_vec_makes_a_vector_env():
    envs = gymnasium.make_vec("filasofia/Reach-v0", num_envs=2, difficulty=1)
    assert isinstance(envs.unwrapped, gym.VectorEnv) and envs.unwrapped.envs[0].difficulty == 1
    seen, _ = envs.reset(seed=0)
    one = gym.Reach(difficulty=1)
    assert np.array_equal(seen[1], one.reset(seed=1)[0])
    one.close()
    envs.close()
    with pytest.raises(AttributeError, match="has no attribute 'Walk'"):
        importlib.import_module("filasofia.gym.vectors").Walk


def test_a_reset_returns_the_tissue_that_was_cut():
    env = gym.PrecisionCutting()
    env.reset(seed=0)
    whole = env.sim.frame[env.sheet].revision
    _, info = episode(env, 0, scripted)
    assert info["measures"]["cut"] >= 0.9 and env.sim.frame[env.sheet].revision > whole and env.cuts
    env.reset(seed=0)
    assert env.sim.frame[env.sheet].revision == whole and not env.cuts
    env.close()


def test_a_line_is_cut_along_its_length_and_not_by_cutting_one_place_of_it_again():
    env = gym.PrecisionCutting(difficulty=2)
    for seed in range(2):
        env.reset(seed=seed)
        for i in range(120):  # sideways across the front of the line, as far as counts as on it
            x, _, z = env.tools[0].place
            aim = env.x + (0.0039 if i // 10 % 2 else -0.0039), max(0.025 - 0.0015 * (i // 20), 0.019)
            move = np.clip(((aim[0] - x) / 2e-3, 0, (aim[1] - z) / 2e-3), -1, 1)
            _, _, terminated, _, info = env.step(move)
            assert not terminated
        assert 0.1 < info["measures"]["cut"] < 0.7
    env.close()


def test_a_line_that_is_cut_takes_no_piece_off_the_sheet():
    env = gym.PrecisionCutting()
    _, info = episode(env, 0, scripted)
    assert info["is_success"] and info["measures"]["pieces"] == 0 and len(env.cuts) > 3
    env.close()


def test_triangles_of_a_plane_cover_their_points_and_without_area_none():
    triangles = np.array([[(0, 0), (1, 0), (0, 1)], [(2, 0), (3, 0), (4, 0)], [(1, 0), (1, 1), (0, 1)]], dtype=float)
    points = np.array([(0.2, 0.2), (3.0, 0.0), (0.9, 0.9), (0.5, 0.5), (1.1, 0.2)])
    assert gym.bodies.covered(triangles, points).tolist() == [True, False, True, True, False]
    assert not gym.bodies.covered(triangles[:0], points).any()


def test_rewards_and_measures_are_physical():
    env = gym.GraspLift()
    _, info = episode(env, 2, scripted)
    assert 0.012 < info["measures"]["lift"] < 0.03
    env.close()
    env = gym.PolypRemoval()
    _, info = episode(env, 2, scripted)
    head = 1000.0 * 0.012 * 0.008 * 0.012  # [kg]
    assert info["measures"]["removed"] == pytest.approx(head, rel=0.35)
    env.close()
    env = gym.Reach()
    env.reset(seed=0)
    _, reward, _, _, info = env.step(np.zeros(3))
    assert reward == pytest.approx(-10 * info["measures"]["distance"] - 0.1 * info["measures"]["force"])
    env.close()


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_a_vector_is_a_loop_of_single_environments(mode):
    count, steps, options = 4, 25, dict(max_steps=10, difficulty=1)
    draw = np.random.default_rng(0)
    actions = draw.uniform(-1, 1, (steps, count, 3)).astype(np.float32)

    def loop():
        envs = [gym.Reach(**options) for _ in range(count)]
        rows, ended = [[env.reset(seed=10 + i)[0] for i, env in enumerate(envs)]], [False] * count
        for step in range(steps):
            row = []
            for i, env in enumerate(envs):
                if ended[i] and mode != AutoresetMode.SAME_STEP:
                    row.append((env.reset()[0], 0.0, False, False))
                    ended[i] = False
                    if mode == AutoresetMode.NEXT_STEP:
                        continue
                    row.pop()
                seen, reward, terminated, truncated, _ = env.step(actions[step, i])
                ended[i] = terminated or truncated
                if ended[i] and mode == AutoresetMode.SAME_STEP:
                    seen, _ = env.reset()
                row.append((seen, reward, terminated, truncated))
            rows.append(row)
        return rows

    expected = loop()
    for threads in (1, 3):
        envs = gym.VectorEnv(gym.Reach, count, threads=threads, autoreset_mode=mode, **options)
        seen, infos = envs.reset(seed=10)
        assert seen.shape == (count, 6) and envs.metadata["autoreset_mode"] == mode
        assert np.array_equal(seen, np.array(expected[0]))
        assert len(infos["state_hash"]) == count
        for step in range(steps):
            if mode == AutoresetMode.DISABLED and step > 0 and (ended := terminated | truncated).any():
                with pytest.raises(fs.Error, match="has ended: reset it first"):
                    envs.step(actions[step])
                envs.reset(options={"reset_mask": ended})
            seen, rewards, terminated, truncated, infos = envs.step(actions[step])
            for i, row in enumerate(expected[step + 1]):
                assert np.array_equal(seen[i], row[0])
                assert (rewards[i], terminated[i], truncated[i]) == row[1:]
            if mode == AutoresetMode.SAME_STEP and (terminated | truncated).any():
                assert infos["final_obs"][int((terminated | truncated).argmax())].shape == (6,)
        envs.close()


def test_a_vector_without_copies_is_one_array_and_pictures_come_from_all():
    envs = gym.VectorEnv(gym.TissueRetraction, 2, copy=False, render_mode="rgb_array", image_size=(32, 24))
    first, _ = envs.reset(seed=0)
    second, *_ = envs.step(envs.action_space.sample())
    assert np.shares_memory(first, second)
    assert [picture.shape for picture in envs.render()] == [(24, 32, 3)] * 2
    with pytest.raises(fs.Error, match=r"actions must have the shape \(2, 4\), got \(3, 4\)"):
        envs.step(np.zeros((3, 4)))
    with pytest.raises(fs.Error, match="TissueRetraction: the action must be 4 finite numbers"):
        envs.step([np.zeros(4), np.zeros(5)])
    envs.close()


@pytest.mark.parametrize("wrong", [[0, np.nan, 0], [0, 1j, 0], ["0", "0", "0"]])
def test_if_one_action_of_a_vector_is_wrong_no_environment_steps(wrong):
    envs = gym.VectorEnv(gym.Reach, 2)
    with pytest.raises(fs.Error, match="^VectorEnv: environment 0: Reach: step: no episode has begun"):
        envs.step(np.zeros((2, 3)))
    envs.reset(seed=0)
    before = [env.sim.state_hash for env in envs.envs]
    with pytest.raises(fs.Error, match="^VectorEnv: environment 1: Reach: the action must be 3 finite numbers"):
        envs.step([[1, 0, 0], wrong])
    assert [env.sim.state_hash for env in envs.envs] == before
    envs.step(np.zeros((2, 3)))
    envs.close()


def test_a_vector_calls_and_has_the_attributes_of_its_environments():
    envs = gym.VectorEnv(gym.Reach, 2)
    assert envs.get_attr("difficulty") == envs.call("difficulty") == (0, 0)
    envs.set_attr("max_steps", 7)
    assert envs.get_attr("max_steps") == (7, 7)
    envs.set_attr("max_steps", [5, 1])
    assert [env.max_steps for env in envs.envs] == [5, 1]
    envs.reset(seed=0)
    assert envs.step(np.zeros((2, 3)))[3].tolist() == [False, True]
    assert len(envs.call("save_state")) == 2
    seen = envs.call("reset", seed=3)
    assert np.array_equal(seen[0][0], seen[1][0])
    with pytest.raises(fs.Error, match="^VectorEnv: set_attr: values of 'max_steps' must be 2, got 3"):
        envs.set_attr("max_steps", [1, 2, 3])
    with pytest.raises(AttributeError, match="nothing"):
        envs.get_attr("nothing")
    envs.close()


def test_a_closed_environment_says_which_it_is():
    env = gym.Reach(render_mode="rgb_array")
    env.reset(seed=0)
    env.close()
    for what, act in (("step", lambda: env.step([0, 0, 0])), ("reset", env.reset), ("render", env.render)):
        with pytest.raises(fs.Error, match=f"^Reach: {what}: the environment is closed"):
            act()
    envs = gym.VectorEnv(gym.Reach, 2)
    envs.reset(seed=0)
    envs.envs[1].close()
    before = envs.envs[0].sim.state_hash
    with pytest.raises(fs.Error, match="^VectorEnv: environment 1: Reach: step: the environment is closed"):
        envs.step(np.zeros((2, 3)))
    assert envs.envs[0].sim.state_hash == before
    envs.close()


@pytest.mark.parametrize(
    "action", [[0, 0], "up", [np.nan, 0, 0], None, ["0", "0", "0"], np.zeros(3, complex), np.ma.zeros(3)]
)
def test_a_wrong_action_is_one_clear_error_and_changes_nothing(action):
    env = gym.Reach()
    env.reset(seed=0)
    before = env.sim.state_hash
    with pytest.raises(fs.Error, match="Reach: the action must be 3 finite numbers, got"):
        env.step(action)
    assert env.sim.state_hash == before
    env.step([0, 0, 0])
    env.close()
    env = gym.Reach(action="discrete")
    env.reset(seed=0)
    for choice in (7, -1, 1.5, "up", None):
        with pytest.raises(fs.Error, match=r"the action must be a whole number in \[0, 6\], got"):
            env.step(choice)
    env.close()


def test_a_vector_takes_a_registered_name():
    envs = gym.VectorEnv("filasofia/Reach-v0", 2, difficulty=1)
    assert [env.difficulty for env in envs.envs] == [1, 1]
    assert envs.reset(seed=0)[0].shape == (2, 6)
    envs.close()


@pytest.mark.parametrize(
    "options, message",
    [
        ({"observation": "depth"}, "Reach: observation must be one of 'state', 'rgb', 'rgbd', got 'depth'"),
        ({"action": "joint"}, "action must be one of 'box', 'discrete', got 'joint'"),
        ({"difficulty": 3}, r"difficulty must be a whole number in \[0, 2\], got 3"),
        ({"max_steps": 0}, "max_steps must be a whole number in"),
        ({"frame_skip": 1.5}, "frame_skip must be a whole number in"),
        ({"quality": "best"}, "quality must be one of 'low', 'medium', 'high', got 'best'"),
        ({"render_mode": "human"}, "render_mode must be one of None, 'rgb_array', got 'human'"),
        ({"image_size": (0, 5)}, r"image_size must be two whole numbers in \[1, 8192\], got \(0, 5\)"),
        ({"threads": 0}, "threads must be a whole number in"),
        ({"difficulty": True}, r"Reach: difficulty must be a whole number in \[0, 2\], got True"),
        ({"image_size": (True, 5)}, r"image_size must be two whole numbers in \[1, 8192\], got \(True, 5\)"),
        ({"max_steps": np.float64(5)}, "Reach: max_steps must be a whole number in"),
    ],
)
def test_wrong_options_are_one_clear_error(options, message):
    with pytest.raises(fs.Error, match=message):
        gym.Reach(**options)


def test_whole_numbers_of_numpy_are_options_too():
    one, size = np.int64(1), np.array([8, 9])
    env = gym.Reach(difficulty=one, max_steps=np.uint8(9), frame_skip=np.int32(5), image_size=size, threads=one)
    assert (env.difficulty, env.max_steps, env.frame_skip, env.image_size) == (1, 9, 5, (8, 9))
    assert type(env.difficulty) is int and type(env.image_size[0]) is int
    env.close()
    envs = gym.VectorEnv(gym.Reach, np.int64(2), threads=np.int64(1), image_size=[np.int64(8), 9])
    assert envs.reset(seed=0)[0].shape == (2, 6)
    envs.close()


def test_the_spec_says_when_an_episode_is_truncated():
    env = gymnasium.make("filasofia/Reach-v0", max_steps=3)
    assert env.spec.max_episode_steps == 3 and gym.Reach().spec is None
    again = gymnasium.make(env.spec)  # has a TimeLimit, too, of the same number
    for each in (env, again):
        each.reset(seed=0)
        assert [each.step(np.zeros(3))[3] for _ in range(3)] == [False, False, True]
        assert each.spec.max_episode_steps == 3
        each.close()
    for more, steps in (({}, 300), ({"max_steps": 400}, 400), ({"max_episode_steps": 5}, 5)):
        env = gymnasium.make("filasofia/Reach-v0", **more)
        assert env.spec.max_episode_steps == steps and gymnasium.make(env.spec).spec.max_episode_steps == steps
        env.close()
    for more in ({"max_episode_steps": 7}, {"max_steps": 7}):
        envs = gymnasium.make_vec(gymnasium.make("filasofia/Reach-v0", max_steps=7).spec, num_envs=2, **more)
        assert [each.max_steps for each in envs.envs] == [7, 7]
        envs.close()


def test_an_unknown_option_of_reset_is_an_error():
    env = gym.Reach()
    env.reset(seed=1, options={})
    with pytest.raises(fs.Error, match="Reach: reset: unknown option 'difficulty'; options are arguments of"):
        env.reset(seed=1, options={"difficulty": 2})
    with pytest.raises(fs.Error, match="Reach: reset: options must be a dict, got 5"):
        env.reset(options=5)
    env.close()


def test_wrong_options_of_vectors_are_one_clear_error():
    with pytest.raises(fs.Error, match="VectorEnv: num_envs must be a whole number in .1, 10000., got 0"):
        gym.VectorEnv(gym.Reach, 0)
    with pytest.raises(fs.Error, match="num_envs must be a whole number in .1, 10000., got 1000000000"):
        gym.VectorEnv(gym.Reach, 10**9)
    with pytest.raises(fs.Error, match="num_envs must be a whole number in .1, 10000., got True"):
        gym.VectorEnv(gym.Reach, True)
    with pytest.raises(fs.Error, match="autoreset_mode must be one of 'NextStep', 'SameStep', 'Disabled', got 'never'"):
        gym.VectorEnv(gym.Reach, 1, autoreset_mode="never")
    envs = gym.VectorEnv(gym.Reach, 2)
    with pytest.raises(fs.Error, match="seed must be a number or 2 of them, got 3"):
        envs.reset(seed=[1, 2, 3])
    for act, words in (
        (lambda: envs.reset(seed="a"), "seed must be a number or 2 of them, got 'a'"),
        (lambda: envs.reset(options=5), "options must be a dict, got 5"),
        (lambda: envs.reset(options={"difficulty": 2}), "reset: unknown option 'difficulty'"),
        (lambda: envs.step(5), r"actions must have the shape \(2, 3\), got 5"),
        (lambda: envs.step(None), r"actions must have the shape \(2, 3\), got None"),
        (lambda: envs.step([[0, 0, 0]]), r"actions must have the shape \(2, 3\), got a list of 1"),
        (lambda: envs.step(np.zeros((2, 4))), r"actions must have the shape \(2, 3\), got \(2, 4\)"),
        (lambda: envs.step(np.zeros(6)), r"actions must have the shape \(2, 3\), got \(6,\)"),
        (lambda: envs.step(np.zeros(())), r"actions must have the shape \(2, 3\), got \(\)"),
        (lambda: gym.VectorEnv(5, 1), "task must be a class or the name of an environment, got 5"),
    ):
        with pytest.raises(fs.Error, match=f"^VectorEnv: {words}"):
            act()
    envs.close()
    with pytest.raises(fs.Error, match="Reach: image_size must be two whole numbers"):
        gym.Reach(image_size=5)


@pytest.mark.parametrize(
    "mask", [[True, False, True], True, [1, 0], [0.0, 1.0], [False, False], None, "on", [[True], [True]]]
)
def test_a_mask_of_a_reset_has_a_flag_for_each_environment_and_one_that_is_true(mask):
    envs = gym.VectorEnv(gym.Reach, 2)
    first, _ = envs.reset(seed=0)
    with pytest.raises(fs.Error, match="^VectorEnv: reset_mask must have 2 flags, True or False, at least one"):
        envs.reset(seed=7, options={"reset_mask": mask})
    later, _ = envs.reset(seed=7, options={"reset_mask": np.array([False, True])})
    assert np.array_equal(first[0], later[0]) and not np.array_equal(first[1], later[1])
    envs.close()


def test_a_closed_vector_says_so():
    envs = gym.VectorEnv(gym.Reach, 2, threads=1)
    envs.close()
    envs.close()
    for act in (envs.reset, envs.render, lambda: envs.step(np.zeros((2, 3)))):
        with pytest.raises(gymnasium.error.ClosedEnvironmentError, match="^VectorEnv: it is closed"):
            act()


def test_the_guide_is_true():
    text = (pathlib.Path(os.environ["FILASOFIA_ROOT"]) / "docs" / "guide" / "environments.md").read_text()
    for block in text.split("```python\n")[1:]:
        exec(compile(block.split("```")[0], "environments.md", "exec"), {})
    for name in NAMES:
        assert f"`{name}`" in text


class Press(gym.SurgicalEnv):
    """A task of a user, whose answers a test replaces."""

    start, low, high = (0.0, 0.025, 0.0), (-0.02, 0.005, -0.02), (0.02, 0.04, 0.02)
    joints = ()
    strength = float("inf")
    more = {}
    answer = gym.Judgement({"force": 0.0}, False, {})
    seen = (0.5,)

    def build(self):
        tip = self.tip("tip", (0.0, 0.025, 0.0))
        named = {"low": self.low, "high": self.high, "joints": self.joints, "strength": self.strength, **self.more}
        return [gym.Tool(tip, self.start, **named)]

    def features(self):
        return self.seen

    def judge(self):
        return self.answer


@pytest.mark.parametrize(
    "fields, message",
    [
        ({"low": (1, 1, 1)}, r"tools\[0\].low must be <= high along each axis, \(0.02, 0.04, 0.02\), got \(1, 1, 1\)"),
        ({"low": (0, 0)}, r"tools\[0\].low must be three finite numbers \[m\], got \(0, 0\)"),
        ({"high": (np.inf, 1, 1)}, r"tools\[0\].high must be three finite numbers \[m\], got \(inf, 1, 1\)"),
        ({"start": (5, 5, 5)}, r"tools\[0\].start must be between low, .*, got \(5, 5, 5\)"),
        ({"strength": 0}, r"tools\[0\].strength must be > 0 N, got 0"),
        ({"strength": np.nan}, r"tools\[0\].strength must be > 0 N, got nan"),
        ({"strength": "x"}, r"tools\[0\].strength must be > 0 N, got 'x'"),
        ({"more": {"speed": -0.1}}, r"tools\[0\].speed must be a finite number >= 0 m/s, got -0.1"),
        ({"more": {"speed": np.nan}}, r"tools\[0\].speed must be a finite number >= 0 m/s, got nan"),
        ({"more": {"port": (0, np.inf, 0)}}, r"tools\[0\].port must be three finite numbers \[m\], or None, got \(0, inf"),
        ({"more": {"grips": 77}}, r"tools\[0\].grips must be a body of the simulation, or None, got 77"),
        ({"joints": (gym.Joint(-1, 1, np.nan),)}, r"tools\[0\].joints\[0\].speed must be a finite number, got nan"),
        ({"joints": (gym.Joint(-1, 1, -1),)}, r"tools\[0\].joints\[0\].speed must be >= 0, got -1"),
        ({"joints": (gym.Joint(-np.inf, 1, 1),)}, r"tools\[0\].joints\[0\].low must be a finite number, got -inf"),
        ({"joints": (gym.Joint(-1, 1, 1, (0, 0, 0)),)}, r"joints\[0\].axis must be three .*length 1.*, got \(0, 0, 0\)"),
        ({"joints": (gym.Joint(-1, 1, 1, (0, 2, 0)),)}, r"joints\[0\].axis must be three .*length 1.*, got \(0, 2, 0\)"),
        ({"joints": (gym.Joint(1, 1, 1),)}, r"tools\[0\].joints\[0\].low must be < high, 1, got 1"),
        ({"joints": (gym.Joint(1, 2, 1),)}, r"tools\[0\].joints\[0\].start must be in \[1, 2\], got 0.0"),
        ({"answer": 5}, r"judge\(\) must return a Judgement, got 5"),
        ({"answer": gym.Judgement({"force": np.nan}, False, {})}, r"reward\['force'\] must be a finite number, got nan"),
        ({"answer": gym.Judgement({"force": "x"}, False, {})}, r"reward\['force'\] must be a finite number, got 'x'"),
        ({"answer": gym.Judgement([0.0], False, {})}, r"judge\(\): reward must be a dict, got \[0.0\]"),
        ({"answer": gym.Judgement({}, "yes", {})}, r"judge\(\): success must be True or False, got 'yes'"),
        ({"answer": gym.Judgement({}, False, None)}, r"judge\(\): measures must be a dict, got None"),
        ({"seen": (np.nan,)}, r"features\(\) must be numbers, got \(nan,\)"),
        ({"seen": None}, r"features\(\) must be numbers, got None"),
    ],
)
def test_what_a_task_of_a_user_returns_is_checked(fields, message):
    with pytest.raises(fs.Error, match=f"^Wrong: .*{message}"):
        type("Wrong", (Press,), fields)().reset(seed=0)


def test_a_task_of_a_user_returns_tools_and_always_as_many_features():
    for tools, words in ((None, "None"), ([5], r"\[5\]")):
        with pytest.raises(fs.Error, match=rf"^Wrong: build\(\) must return a list of tools, got {words}"):
            type("Wrong", (Press,), {"build": lambda self: tools})()
    with pytest.raises(fs.Error, match=r"^Tool: joints must be a tuple of Joints, got 3"):
        type("Wrong", (Press,), {"joints": 3})()
    with pytest.raises(fs.Error, match=r"^Lost: tools\[0\].body must be a body of the simulation, got 99"):
        type("Lost", (Press,), {"tip": lambda *_: 99})()
    env = Press()
    env.reset(seed=0)
    env.seen = (0.5, 0.5)
    with pytest.raises(fs.Error, match=r"^Press: features\(\) must return as many numbers as at first, got 1 more"):
        env.step([0, 0, 0])
    env.seen = ()
    with pytest.raises(fs.Error, match="at first, got 1 fewer"):
        env.step([0, 0, 0])
    env.close()


def test_a_task_that_adds_or_removes_bodies_in_an_episode_is_told_where_and_what_to_do():
    def ball(env):
        env.sim.add(fs.RigidBodyDef(name="ball", mesh=fs.shapes.sphere(0.01)))

    says = r"must not add or remove bodies, but {}: an episode begins by .* Add bodies in build\(\); arrange\(\) can move"
    with pytest.raises(fs.Error, match="^Wrong: arrange\\(\\) " + says.format("'ball' was added")):
        type("Wrong", (Press,), {"arrange": ball})()
    with pytest.raises(fs.Error, match="^Wrong: arrange\\(\\) " + says.format(r"body \d+ was removed")):
        type("Wrong", (Press,), {"arrange": lambda env: env.sim.remove(env.tools[0].body)})()
    env = Press()
    env.reset(seed=0)
    ball(env)
    with pytest.raises(fs.Error, match="^Press: an episode " + says.format("'ball' was added")):
        env.reset()
    env.close()


def test_a_task_without_its_methods_names_them():
    with pytest.raises(NotImplementedError, match=r"^Empty must override build\(\)"):
        type("Empty", (gym.SurgicalEnv,), {})()
    with pytest.raises(NotImplementedError, match=r"^Mute must override judge\(\)"):
        type("Mute", (Press,), {"judge": gym.SurgicalEnv.judge})().reset()
