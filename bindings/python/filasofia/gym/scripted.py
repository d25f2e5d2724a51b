"""Policies that solve the tasks from what an environment knows, with box actions: for baselines and demonstrations."""

from __future__ import annotations

import typing

import numpy as np

from . import tasks
from .environment import Array, SurgicalEnv, Tool


def scripted(env: SurgicalEnv) -> typing.Callable[[], Array]:
    """A function that returns the next action of a policy for this environment's task; make one for each episode."""
    policy = POLICIES.get(type(env))
    if policy is None:
        raise TypeError(f"scripted: there is no policy for {type(env).__name__}")
    moves = policy(env)
    return lambda: np.asarray(next(moves), dtype=np.float32)


Moves = typing.Iterator[Array]


def _towards(env: SurgicalEnv, tool: Tool, place: Array) -> Array:
    """The action that brings a tool to a place as fast as it can."""
    step = tool.speed * env.frame_skip / env.rate
    return np.clip((np.asarray(place) - tool.place) / step, -1.0, 1.0)


def _go(env: SurgicalEnv, place: typing.Any, grip: float | None = None, near: float = 5e-4) -> Moves:
    """Until the first tool is there; `place` may be a function, for places that move."""
    tool = env.tools[0]
    for _ in range(200):
        there = place() if callable(place) else np.asarray(place)
        if np.linalg.norm(np.clip(there, tool.low, tool.high) - tool.place) < near:
            return
        move = _towards(env, tool, there)
        yield move if grip is None else np.append(move, grip)


def _grasp(env: SurgicalEnv, above: typing.Any) -> Moves:
    """Goes above a place, and down until something is held."""
    tool = env.tools[0]
    yield from _go(env, lambda: above() + (0, 0.008, 0), -1.0)
    for _ in range(100):
        if env.holds(tool):
            return
        yield np.append(_towards(env, tool, above() - (0, 0.002, 0)), 1.0)


def _rise(env: SurgicalEnv, height: float, grip: float) -> Moves:
    """Straight up, or down, to a height [m]."""
    x, _, z = env.tools[0].place
    yield from _go(env, (x, height, z), grip)


def _stay(size: int, last: float = 0.0) -> Moves:
    while True:
        rest = np.zeros(size)
        rest[-1] = last
        yield rest


def _reach(env: tasks.Reach) -> Moves:
    yield from _go(env, env.target)
    yield from _stay(3)


def _deflect(env: tasks.DeflectSpheres) -> Moves:
    foot = env.feet[env.target]
    yield from _go(env, foot + (0, 0.034, 0.02))
    yield from _go(env, foot + (0, 0.034, -0.012))
    yield from _stay(3)


def _search(env: tasks.SearchForPoint) -> Moves:
    yield from _go(env, env.target + (0, 0.04, 0))
    yield from _go(env, env.target + (0, 0.025, 0))
    yield from _stay(3)


def _manipulate(env: tasks.TissueManipulation) -> Moves:
    while True:
        errors = env.targets - env._places()
        yield np.concatenate([_towards(env, tool, tool.place + 0.5 * e) for tool, e in zip(env.tools, errors)])


def _retract(env: tasks.TissueRetraction) -> Moves:
    yield from _grasp(env, lambda: env.sim.frame[env.flap].positions[env.edge] + (-0.003, 0.004, 0))
    yield from _go(env, env.target, 1.0)
    yield from _stay(4, 1.0)


def _cut(env: tasks.PrecisionCutting) -> Moves:
    yield from _go(env, (env.x, 0.0, 0.045))
    yield from _go(env, (env.x, 0.0, env.end + 0.002))
    yield from _stay(3)


def _place(env: tasks.PickAndPlace) -> Moves:
    yield from _grasp(env, lambda: env._cube() + (0, 0.008, 0))
    offset = env.tools[0].place - env._cube()
    yield from _rise(env, 0.04, 1.0)
    yield from _go(env, env.target + offset + (0, 0.02, 0), 1.0)
    yield from _go(env, env.target + offset + (0, 0.001, 0), 1.0)
    for _ in range(5):
        yield np.array([0, 0, 0, -1.0])
    yield from _rise(env, 0.05, -1.0)
    yield from _stay(4, -1.0)


def _lift(env: tasks.GraspLift) -> Moves:
    yield from _grasp(env, lambda: env._fundus() + (-0.004, 0.004, 0))
    yield from _rise(env, 0.06, 1.0)
    yield from _stay(4, 1.0)


def _resect(env: tasks.PolypRemoval) -> Moves:
    yield from _go(env, (0, 0.0065, 0.012))
    yield from _go(env, (0, 0.0065, -0.012))
    yield from _stay(3)


POLICIES: dict[type[SurgicalEnv], typing.Callable[[typing.Any], Moves]] = {
    tasks.Reach: _reach,
    tasks.DeflectSpheres: _deflect,
    tasks.SearchForPoint: _search,
    tasks.TissueManipulation: _manipulate,
    tasks.TissueRetraction: _retract,
    tasks.BimanualTissueManipulation: _manipulate,
    tasks.PrecisionCutting: _cut,
    tasks.PickAndPlace: _place,
    tasks.GraspLift: _lift,
    tasks.PolypRemoval: _resect,
}
