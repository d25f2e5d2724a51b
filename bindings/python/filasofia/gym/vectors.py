"""Vectors of the registered tasks, for gymnasium.make_vec: filasofia.gym.vectors:Reach makes a VectorEnv of Reach."""

from __future__ import annotations

import functools
import typing

from . import TASKS, VectorEnv


def __getattr__(name: str) -> typing.Callable[..., VectorEnv]:
    for task in TASKS:
        if task.__name__ == name:
            return functools.partial(VectorEnv, task)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
