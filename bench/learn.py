"""A policy learns a task of filasofia.gym from state observations, with SAC of stable-baselines3.

    python bench/learn.py [--task Reach] [--minutes 30] [--seed 0]     (the package with [gym], stable-baselines3)

Prints JSON: the learning curve (steps, minutes, success in 50 episodes of seeds that training does not use) until 90 %
succeed twice in a row, and whether the trained policy's episodes repeat with the same state hashes.
"""

import argparse
import json
import sys
import time

import stable_baselines3
import torch
from stable_baselines3 import SAC

import filasofia as fs
from filasofia import gym


def evaluate(model, env, episodes=50):
    """The fraction of episodes that succeed, and the hashes of their last states."""
    won, hashes = 0, []
    for seed in range(10_000, 10_000 + episodes):
        seen, info = env.reset(seed=seed)
        ended = False
        while not ended:
            action, _ = model.predict(seen, deterministic=True)
            seen, _, terminated, truncated, info = env.step(action)
            ended = terminated or truncated
        won += info["is_success"]
        hashes.append(info["state_hash"])
    return won / episodes, hashes


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--task", default="Reach", choices=[task.__name__ for task in gym.TASKS])
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--every", type=int, default=2500, help="steps between two evaluations")
    parser.add_argument("--seed", type=int, default=0, help="of the learning; that of the test is always the same")
    given = parser.parse_args()
    torch.set_num_threads(1)  # faster than two for networks as small as these
    task = getattr(gym, given.task)
    env, test = task(max_steps=100), task(max_steps=100)
    network = {"net_arch": [128, 128]}
    settings = {"learning_rate": 1e-3, "gamma": 0.95, "ent_coef": "auto_0.1", "learning_starts": 500}
    model = SAC("MlpPolicy", env, seed=given.seed, device="cpu", policy_kwargs=network, **settings)
    curve, begin, last = [], time.perf_counter(), 0.0
    while time.perf_counter() - begin < 60 * given.minutes:
        model.learn(given.every, reset_num_timesteps=False)
        success, hashes = evaluate(model, test)
        minutes = (time.perf_counter() - begin) / 60
        curve.append({"steps": model.num_timesteps, "minutes": round(minutes, 2), "success": success})
        print(curve[-1], file=sys.stderr, flush=True)
        if min(success, last) >= 0.9:
            break
        last = success
    again, repeated = evaluate(model, task(max_steps=100))
    print(
        json.dumps(
            {
                "task": given.task,
                "filasofia": fs.__version__,
                "stable_baselines3": stable_baselines3.__version__,
                "algorithm": "SAC",
                "seed": given.seed,
                "curve": curve,
                "success": again,
                "repeats_bit_for_bit": repeated == hashes,
            },
            indent=2,
        )
    )


if __name__ == "__main__":
    main()
