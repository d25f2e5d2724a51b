"""filasofia.gym: states of environments, and what pictures show."""

import pickle
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("gymnasium", reason="pip install filasofia[gym]")

import filasofia as fs  # noqa: E402
from filasofia import gym  # noqa: E402
from filasofia.gym.scripted import scripted  # noqa: E402


def go_on(env, actions):
    """What follows: observations, rewards, hashes, measures and the task's own random numbers."""
    rows = []
    for action in actions:
        seen, reward, _, _, info = env.step(action)
        rows.append((seen.tobytes(), reward, info["state_hash"], str(info["measures"])))
    return rows, env.np_random.uniform()


def begun(name, steps, **options):
    """An environment some steps into an episode of its scripted policy, and the next actions."""
    env = getattr(gym, name)(**options)
    env.reset(seed=3)
    act = scripted(env)
    for _ in range(steps):
        env.step(act())
    draw = np.random.default_rng(0)
    return env, draw.uniform(-1, 1, (25, *env.action_space.shape)).astype(np.float32)


# A tip alone, a grasp that holds, cuts, a mask of what is cut, two hands that give a ring, a jaw with clips.
@pytest.mark.parametrize(
    ("name", "steps"),
    [
        ("Reach", 8),
        ("GraspLift", 30),
        ("PrecisionCutting", 40),
        ("PatternCutting", 40),
        ("PegTransfer", 30),
        ("ClipAndCut", 30),
        ("Cholecystectomy", 30),
    ],
)
def test_a_restored_environment_goes_on_with_the_same_bits_also_in_another_one(name, steps):
    env, actions = begun(name, steps)
    state = env.save_state()
    expected = go_on(env, actions)
    env.restore_state(state)
    assert go_on(env, actions) == expected
    env.reset(seed=9)  # another episode between them
    go_on(env, actions)
    env.restore_state(state)
    assert go_on(env, actions) == expected
    other = getattr(gym, name)(observation="state", max_steps=7)
    other.restore_state(state)
    assert go_on(other, actions) == expected and other.max_steps == 7
    env.close()
    other.close()


CONTINUED = """
import pickle, sys
import numpy as np
from filasofia import gym
state, actions = pickle.load(sys.stdin.buffer)
env = getattr(gym, sys.argv[1])(threads=2)
rows = []
for _ in range(2):  # the second time without the steps that led to it
    env.restore_state(state)
    rows.append([env.step(action)[4]["state_hash"] for action in actions] + [float(env.np_random.uniform())])
pickle.dump(rows, sys.stdout.buffer)
"""


@pytest.mark.parametrize(("name", "steps"), [("GraspLift", 30), ("PrecisionCutting", 30)])
def test_a_pickled_state_goes_on_in_another_process_with_the_same_bits(name, steps):
    env, actions = begun(name, steps)
    sent = pickle.dumps((env.save_state(), actions))
    rows, number = go_on(env, actions)
    expected = [row[2] for row in rows] + [number]
    done = subprocess.run([sys.executable, "-c", CONTINUED, name], input=sent, capture_output=True, check=True)
    assert pickle.loads(done.stdout) == [expected, expected]
    env.close()


def test_states_that_do_not_fit_are_refused_by_name():
    env = gym.Reach()
    for early in (env.save_state, lambda: env.step(np.zeros(3))):
        with pytest.raises(fs.Error, match="no episode has begun: call reset\\(\\) before"):
            early()
    env.reset(seed=0)
    with pytest.raises(fs.Error, match="the state must be one of save_state\\(\\), got 3"):
        env.restore_state(3)
    state = env.save_state()
    with pytest.raises(fs.Error, match="the class must be .*PickAndPlace.*Reach"):
        gym.PickAndPlace().restore_state(state)
    with pytest.raises(fs.Error, match="the options must be .*'difficulty': 1.*'difficulty': 0"):
        gym.Reach(difficulty=1).restore_state(state)
    for _ in range(5):
        env.step([0, -1, 0])
    env.sim.apply(fs.SetGravity((0, 5, 0)))  # not by an action
    env.step([0, 0, 0])
    copy = pickle.loads(pickle.dumps(env.save_state()))
    with pytest.raises(fs.Error, match="6 actions must lead to the state .*something else has changed the episode"):
        env.restore_state(copy)
    with pytest.raises(TypeError, match="SavedState: .*cannot be copied or pickled.*SurgicalEnv.save_state"):
        pickle.dumps(env.sim.save_state())
    env.close()


def test_actions_beyond_one_are_clipped():
    hashes = []
    for action in ([0, -1, 0], [0, -7, 0]):
        env = gym.Reach()
        env.reset(seed=0)
        hashes.append(env.step(action)[4]["state_hash"])
        env.close()
    assert hashes[0] == hashes[1]


class Flap(gym.SurgicalEnv):
    """Bodies that build() adds to the simulation itself, beside an instrument."""

    chosen = False

    def build(self):
        self.flap = self.sim.add(fs.SoftBodyDef(name="flap", mesh=fs.shapes.block((0.04, 0.004, 0.03), (4, 1, 3))))
        self.sim.apply(fs.SetGravity((0, 0, 0)))
        self.floor = self.sim.add(
            fs.RigidBodyDef(name="floor", elements=[(0, -0.02, 0)], mesh=fs.shapes.box((0.12, 0.01, 0.12)))
        )
        if self.chosen:
            self.sim.show(self.flap)
        start = (0.0, 0.02, 0.0)
        return [gym.Tool(self.tip("tip", start), start, low=(-0.02, 0.0, -0.02), high=(0.03, 0.04, 0.02))]

    def judge(self):
        return gym.Judgement({}, False, {})


@pytest.mark.parametrize("chosen", [False, True])
def test_pictures_show_all_bodies_unless_a_task_shows_some_itself(chosen):
    env = type("Chosen", (Flap,), {"chosen": chosen})(observation="rgbd", image_size=(96, 64))
    env.reset(seed=1)
    seen = set(np.unique(env.sim.render_depth(96, 64, pose=env.view(), camera=env.lens).bodies)) - {0}
    tip = env.tools[0].body
    assert seen == ({env.flap, tip} if chosen else {env.flap, env.floor, tip})
    env.close()
