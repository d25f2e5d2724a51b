"""Environment steps per second of filasofia.gym, beside MuJoCo's flex bodies.

    python bench/gym_steps.py [--seconds 2] [--envs 8] [--tasks Suture ...]   (the package with [gym]; mujoco, if installed)

Per task: one environment and a vector of N on all cores, random actions, state observations, and one environment with
pictures of 128 x 128. A step is 20 ms: 10 steps of physics of 2 ms, or 20 of 1 ms. MuJoCo: an elastic block with the
tetrahedra of Reach's tissue and a ball that moves above it, with the same steps; it has no gymnasium around it, which
favours it.
"""

import argparse
import json
import platform
import time

import numpy as np

import filasofia as fs
from filasofia import gym


def rate(step, seconds):
    """Calls per second, after a tenth of the time to warm up."""
    end = time.perf_counter() + 0.1 * seconds
    while time.perf_counter() < end:
        step()
    begin, count = time.perf_counter(), 0
    while time.perf_counter() < begin + seconds:
        step()
        count += 1
    return count / (time.perf_counter() - begin)


def single(task, seconds, **options):
    env = task(**options)
    env.reset(seed=0)
    env.action_space.seed(0)

    def step():
        _, _, terminated, truncated, _ = env.step(env.action_space.sample())
        if terminated or truncated:
            env.reset()

    found = rate(step, seconds)
    env.close()
    return found


def vector(task, count, seconds):
    envs = gym.VectorEnv(task, count, copy=False)
    envs.reset(seed=0)
    envs.action_space.seed(0)
    found = rate(lambda: envs.step(envs.action_space.sample()), seconds) * count
    envs.close()
    return found


def resets(task, count=50):
    env = task()
    times = []
    for seed in range(count):
        env.reset(seed=seed)
        env.step(env.action_space.sample())
        begin = time.perf_counter()
        env.reset(seed=seed)
        times.append(time.perf_counter() - begin)
    env.close()
    return float(np.median(times)) * 1e3


FLEX = """
<mujoco>
  <option timestep="0.002" solver="CG" tolerance="1e-6"/>
  <worldbody>
    <flexcomp name="tissue" type="grid" count="9 3 9" spacing="0.0125 0.01 0.0125" dim="3" mass="0.2" radius="0.001">
      <elasticity young="5e3" poisson="0.45" damping="0.001"/>
      <contact selfcollide="none"/>
      <pin id="{pins}"/>
    </flexcomp>
    <body name="tip" mocap="true" pos="0 0.05 0"><geom type="sphere" size="0.004"/></body>
  </worldbody>
</mujoco>
"""


def mujoco_flex(seconds):
    try:
        import mujoco
    except ImportError:
        return None
    pins = " ".join(str(i) for i in range(9 * 3 * 9) if (i // 9) % 3 == 0)
    found = {"version": mujoco.__version__}
    for steps in (10, 20, 50, 100, 200):  # of physics per environment step of 20 ms, until none is unstable
        model = mujoco.MjModel.from_xml_string(FLEX.format(pins=pins))
        model.opt.timestep = 0.02 / steps
        data = mujoco.MjData(model)
        draw = np.random.default_rng(0)

        def step():
            for _ in range(steps):
                move = 2e-3 / steps * draw.uniform(-1, 1, 3)
                data.mocap_pos[0] = np.clip(data.mocap_pos[0] + move, (-0.04, 0.02, -0.04), 0.06)
                mujoco.mj_step(model, data)

        per_second = rate(step, seconds)
        unstable = int(data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number)
        found["tetrahedra"] = int(model.nflexelem)
        found[f"dt_{20 / steps:g}_ms"] = {"steps_per_second": round(per_second), "unstable_steps": unstable}
        if unstable == 0:
            break
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--envs", type=int, default=8)
    parser.add_argument("--tasks", nargs="*", default=[task.__name__ for task in gym.TASKS])
    parser.add_argument("--machine", default="", help="what the page says about it")
    given = parser.parse_args()
    result = {"machine": given.machine, "filasofia": fs.__version__, "python": platform.python_version()}
    result |= {"envs": given.envs, "tasks": {}}
    for task in (getattr(gym, name) for name in given.tasks):
        env = task()
        env.reset(seed=0)
        soft = [env.sim.definition(body) for body in env.sim.bodies]
        count = sum(len(each.mesh.tetrahedra) for each in soft if isinstance(each, fs.SoftBodyDef))
        env.close()
        result["tasks"][task.__name__] = {
            "tetrahedra": count,
            "one": round(single(task, given.seconds)),
            "vector": round(vector(task, given.envs, given.seconds)),
            "pictures": round(single(task, given.seconds, observation="rgb", image_size=(128, 128))),
            "low": round(single(task, given.seconds, observation="rgb", image_size=(128, 128), quality="low")),
            "depth": round(single(task, given.seconds, observation="rgbd", image_size=(128, 128), quality="low")),
            "reset_ms": round(resets(task), 3),
        }
    if "Reach" in given.tasks:
        result["mujoco_flex"] = mujoco_flex(given.seconds)
    print(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
