"""Many environments on the threads of one process."""

from __future__ import annotations

import concurrent.futures
import math
import os
import typing
from copy import deepcopy

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space, create_empty_array

import filasofia as fs

from .checks import whole
from .environment import SurgicalEnv
from .tool import Array


class VectorEnv(gymnasium.vector.VectorEnv):
    """`num_envs` environments of a task, stepped by `threads` threads (default: one for each core).

    Steps run in C++ without Python's lock, so the environments of one process run in parallel. The result has the bits
    of a loop over single environments, for any number of threads. `options` go to every environment. Observations are
    rows of one array, which the next step overwrites if `copy` is False.

        envs = VectorEnv(Reach, 8, difficulty=1)    # or VectorEnv("filasofia/Reach-v0", 8, difficulty=1)
    """

    def __init__(
        self,
        task: str | typing.Callable[..., SurgicalEnv],
        num_envs: int,
        *,
        threads: int | None = None,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        **options: typing.Any,
    ):
        num_envs = self._count("num_envs", num_envs)
        threads = None if threads is None else self._count("threads", threads)
        try:
            self.autoreset_mode = AutoresetMode(autoreset_mode)
        except ValueError:
            known = ", ".join(repr(each.value) for each in AutoresetMode)
            raise fs.Error(f"VectorEnv: autoreset_mode must be one of {known}, got {autoreset_mode!r}") from None
        if not isinstance(task, str) and not callable(task):
            raise fs.Error(f"VectorEnv: task must be a class or the name of an environment, got {task!r}")
        self.num_envs, self._copy = num_envs, copy
        self._threads = min(threads or os.cpu_count() or 1, num_envs)
        self._pool = concurrent.futures.ThreadPoolExecutor(max(self._threads - 1, 1))  # the caller works, too
        self.envs = self._all(lambda i: self._make(task, options))
        one = self.envs[0]
        self.metadata = {**one.metadata, "autoreset_mode": self.autoreset_mode}
        self.render_mode, self.spec = one.render_mode, one.spec
        self.single_observation_space, self.single_action_space = one.observation_space, one.action_space
        self.observation_space = batch_space(one.observation_space, num_envs)
        self.action_space = batch_space(one.action_space, num_envs)
        self._seen: typing.Any = create_empty_array(one.observation_space, num_envs)
        self._ended: Array = np.zeros(num_envs, bool)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, typing.Any] | None = None
    ) -> tuple[Array, dict[str, typing.Any]]:
        """Resets all; with a number as seed, environment i gets seed + i.

        `options["reset_mask"]`, (num_envs,), bool, chooses some: at least one.
        """
        if not isinstance(seed, (int, np.integer, list, tuple, type(None))):
            raise fs.Error(f"VectorEnv: seed must be a number or {self.num_envs} of them, got {seed!r}")
        if isinstance(seed, (list, tuple)):
            seeds = list(seed)
        else:
            seeds = [None if seed is None else seed + i for i in range(self.num_envs)]
        if len(seeds) != self.num_envs:
            raise fs.Error(f"VectorEnv: seed must be a number or {self.num_envs} of them, got {len(seeds)}")
        if not isinstance(options, (dict, type(None))):
            raise fs.Error(f"VectorEnv: options must be a dict, got {options!r}")
        for each in options or {}:
            if each != "reset_mask":
                raise fs.Error(f"VectorEnv: reset: unknown option {each!r}; it has reset_mask")
        chosen = self._chosen(options or {})
        infos: dict[str, typing.Any] = {}
        for i, (seen, info) in zip(chosen, self._all(lambda i: self.envs[i].reset(seed=seeds[i]), chosen)):
            self._keep(int(i), seen)
            infos = self._add_info(infos, info, int(i))
        self._ended[chosen] = False
        return self._observations(), infos

    def step(self, actions: typing.Any) -> tuple[Array, Array, Array, Array, dict[str, typing.Any]]:
        """One step of each. If an action is wrong, also one of an environment that is reset now, none steps."""
        self._check_shape(actions)
        if self.autoreset_mode == AutoresetMode.DISABLED and self._ended.any():
            raise fs.Error(f"VectorEnv: environment {int(self._ended.argmax())} has ended: reset it first")
        self._check(actions)
        rewards = np.zeros(self.num_envs)
        ends = np.zeros((2, self.num_envs), bool)
        infos: dict[str, typing.Any] = {}
        for i, row in enumerate(self._all(lambda i: self._advance(i, actions[i]))):
            seen, rewards[i], ends[0, i], ends[1, i], info = row
            self._keep(i, seen)
            infos = self._add_info(infos, info, i)
        self._ended = ends.any(axis=0) & (self.autoreset_mode != AutoresetMode.SAME_STEP)
        return self._observations(), rewards, ends[0], ends[1], infos

    def render(self) -> tuple[typing.Any, ...]:
        return tuple(self._all(lambda i: self.envs[i].render()))

    def call(self, name: str, *args: typing.Any, **named: typing.Any) -> tuple[typing.Any, ...]:
        """What a method of each environment returns, or its attribute of that name; on the threads of the steps."""

        def one(i: int) -> typing.Any:
            found = self.envs[i].get_wrapper_attr(name)
            return found(*args, **named) if callable(found) else found

        return tuple(self._all(one))

    def get_attr(self, name: str) -> tuple[typing.Any, ...]:
        """An attribute of each environment."""
        return self.call(name)

    def set_attr(self, name: str, values: typing.Any) -> None:
        """Sets an attribute: a list or tuple has one value for each environment, anything else is for all."""
        each = values if isinstance(values, (list, tuple)) else [values] * self.num_envs
        if len(each) != self.num_envs:
            raise fs.Error(f"VectorEnv: set_attr: values of {name!r} must be {self.num_envs}, got {len(each)}")
        self._all(lambda i: self.envs[i].set_wrapper_attr(name, each[i]))

    def close_extras(self, **_: typing.Any) -> None:
        if hasattr(self, "envs"):
            for env in self.envs:
                env.close()
        self._pool.shutdown()

    @staticmethod
    def _count(name: str, value: typing.Any) -> int:
        number = whole(value, 1, 10_000)
        if number is None:
            raise fs.Error(f"VectorEnv: {name} must be a whole number in [1, 10000], got {value!r}")
        return number

    def _chosen(self, options: dict[str, typing.Any]) -> Array:
        """Which environments reset() resets."""
        if "reset_mask" not in options:
            return np.arange(self.num_envs)
        mask = np.asarray(options["reset_mask"])
        if mask.shape != (self.num_envs,) or mask.dtype != bool or not mask.any():
            raise fs.Error(
                f"VectorEnv: reset_mask must have {self.num_envs} flags, True or False, at least one of them True, "
                f"got {mask.tolist()}"
            )
        return np.flatnonzero(mask)

    def _check_shape(self, actions: typing.Any) -> None:
        """Error if the actions are not one for each environment; a wrapper says itself what one of them is."""
        wanted, given = self.action_space.shape, getattr(actions, "shape", None)
        rows = len(actions) if hasattr(actions, "__len__") and given != () else 0
        if rows == self.num_envs and (not given or not wanted or math.prod(given) == math.prod(wanted)):
            return
        got = tuple(given) if given is not None else f"a list of {rows}" if rows else repr(actions)
        raise fs.Error(f"VectorEnv: actions must have the shape {wanted or (self.num_envs,)}, got {got}")

    @staticmethod
    def _make(task: str | typing.Callable[..., SurgicalEnv], options: dict[str, typing.Any]) -> typing.Any:
        return gymnasium.make(task, **options).unwrapped if isinstance(task, str) else task(**options)

    def _all(self, act: typing.Callable[[int], typing.Any], which: typing.Any = None) -> list[typing.Any]:
        """What `act` returns for each environment; an exception names the first one that raised.

        One job for each thread, which takes environments until none is left: a job for each environment would cost as
        much as its observation.
        """
        if self.closed:
            raise gymnasium.error.ClosedEnvironmentError("VectorEnv: it is closed; make another one")
        chosen = [int(i) for i in (range(self.num_envs) if which is None else which)]
        found: list[typing.Any] = [None] * len(chosen)
        problems: dict[int, BaseException] = {}
        waiting = iter(range(len(chosen)))  # next() of it is one operation under Python's lock

        def work() -> None:
            for k in waiting:
                try:
                    found[k] = act(chosen[k])
                except BaseException as problem:
                    problems[k] = problem

        futures = [self._pool.submit(work) for _ in range(min(self._threads, len(chosen)) - 1)]
        work()
        concurrent.futures.wait(futures)
        for k, problem in sorted(problems.items()):
            if hasattr(problem, "add_note"):  # Python 3.11
                problem.add_note(f"in environment {chosen[k]} of {self.num_envs}")
            raise problem
        return found

    def _check(self, actions: typing.Any) -> None:
        """Raises what is wrong with an action, or with an environment, before any of them steps."""
        if self.closed:
            return  # _all() says so
        for i, env in enumerate(self.envs):
            try:
                plain = env.unwrapped
                plain._check_ready()
                if plain is env:  # a wrapper may change the action: it checks it itself
                    env._moves(actions[i])
            except fs.Error as problem:
                raise fs.Error(f"VectorEnv: environment {i}: {problem}") from None

    def _advance(self, i: int, action: typing.Any) -> tuple[Array, float, bool, bool, dict[str, typing.Any]]:
        env = self.envs[i]
        if self.autoreset_mode == AutoresetMode.NEXT_STEP and self._ended[i]:
            seen, info = env.reset()
            return seen, 0.0, False, False, info
        seen, reward, terminated, truncated, info = env.step(action)
        if self.autoreset_mode == AutoresetMode.SAME_STEP and (terminated or truncated):
            last = {"final_obs": seen, "final_info": info}
            seen, info = env.reset()
            info = {**info, **last}
        return seen, reward, terminated, truncated, info

    def _keep(self, i: int, seen: Array) -> None:
        if isinstance(seen, dict):
            for name, part in seen.items():
                self._seen[name][i] = part
        else:
            self._seen[i] = seen

    def _observations(self) -> Array:
        return deepcopy(self._seen) if self._copy else self._seen
