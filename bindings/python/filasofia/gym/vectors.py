"""Vectors of the registered tasks, for gymnasium.make_vec: filasofia.gym.vectors:Reach makes a VectorEnv of Reach."""

from __future__ import annotations

import functools
import typing

from . import TASKS, SurgicalEnv, VectorEnv


def _vector(
    task: type[SurgicalEnv], num_envs: int, *, max_episode_steps: int | None = None, **options: typing.Any
) -> VectorEnv:
    """make_vec() says max_episode_steps if it is in the spec: it is the environments' max_steps."""
    if max_episode_steps is not None:
        options.setdefault("max_steps", max_episode_steps)
    return VectorEnv(task, num_envs, **options)


def __getattr__(name: str) -> typing.Callable[..., VectorEnv]:
    for task in TASKS:
        if task.__name__ == name:
            return functools.partial(_vector, task)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
