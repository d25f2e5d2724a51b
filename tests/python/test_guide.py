"""The programs of the guide do what it says."""
import os
import re

import numpy as np
import pytest

import filasofia as fs


def test_the_programs_of_the_guide_run(capsys):
    with open(os.path.join(os.environ["FILASOFIA_ROOT"], "docs/guide/python.md")) as page:
        blocks = re.findall(r"```python\n(.*?)```", page.read(), flags=re.S)
    assert len(blocks) >= 6
    names = {}
    for block in blocks:  # each continues where the one before ended
        exec(compile(block, "docs/guide/python.md", "exec"), names)
    assert "after 0.300 s the lowest point hangs at" in capsys.readouterr().out
    assert names["sim"].frame.step == names["sim"].steps


def test_every_name_in_the_guide_exists():
    with open(os.path.join(os.environ["FILASOFIA_ROOT"], "docs/guide/python.md")) as page:
        text = page.read()
    for name in set(re.findall(r"\bfs\.(\w+)", text)):
        assert hasattr(fs, name), name
    for name in set(re.findall(r"\bsim\.(\w+)", text)):
        assert hasattr(fs.Simulation, name), name


def test_the_errors_in_the_guide_are_what_is_said():
    lines = []
    for act in (
        lambda: fs.Simulation(threads=1).add(bad),
        lambda: fs.FemMaterial(youngs_modulus=1),
    ):
        try:
            bad = fs.SoftBodyDef(name="liver", mesh=fs.shapes.block((1, 1, 1)))
            object.__setattr__(bad.material, "poisson_ratio", 0.5)
            act()
        except (fs.Error, TypeError) as problem:
            lines.append(str(problem))
    with open(os.path.join(os.environ["FILASOFIA_ROOT"], "docs/guide/python.md")) as page:
        text = page.read()
    assert len(lines) == 2 and all(f"    {line}\n" in text for line in lines), lines


def environment():
    with open(os.path.join(os.environ["FILASOFIA_ROOT"], "docs/guide/python.md")) as page:
        (block,) = [each for each in re.findall(r"```python\n(.*?)```", page.read(), flags=re.S) if "class PressEnv" in each]
    names = {"fs": fs}
    exec(compile(block, "docs/guide/python.md", "exec"), names)
    return names["PressEnv"]


def test_the_environment_of_the_guide_repeats_its_episodes_and_feels_the_tissue():
    env = environment()()

    def episode(seed):
        seen = [env.reset(seed=seed)[0]]
        for _ in range(60):
            observation, reward, terminated, truncated, info = env.step(np.array([-1.0]))
            assert observation.dtype == np.float32 and np.isfinite(reward) and info == {}
            assert type(terminated) is bool and type(truncated) is bool and not terminated
            seen.append(observation)
        return np.array(seen)

    first, other, again = episode(1), episode(2), episode(1)
    assert np.array_equal(first, again) and not np.array_equal(first, other)
    assert first[0, 2] == 0 and first[-1, 2] > 0.1
    assert first[0, 0] - first[-1, 0] == pytest.approx(60 * env.tick * env.sim.dt * env.speed, rel=1e-3)
    assert env.render().shape == (240, 320, 3)
    env.close()


def test_the_environment_of_the_guide_is_one_of_gymnasium():
    gymnasium = pytest.importorskip("gymnasium")
    checker = pytest.importorskip("gymnasium.utils.env_checker")

    class Registered(environment(), gymnasium.Env):
        observation_space = gymnasium.spaces.Box(-1e6, 1e6, (3,), np.float32)
        action_space = gymnasium.spaces.Box(-1, 1, (1,), np.float32)

        def reset(self, *, seed=None, options=None):
            gymnasium.Env.reset(self, seed=seed)  # its generator of random numbers
            return super().reset(seed=seed, options=options)

    checker.check_env(Registered(), skip_render_check=True)
