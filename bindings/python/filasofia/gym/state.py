"""The whole state of an environment, which other processes can reach, too."""

from __future__ import annotations

import copy
import dataclasses
import io
import pickle
import typing

import numpy as np

import filasofia as fs

from .tool import Array

if typing.TYPE_CHECKING:
    from .environment import SurgicalEnv

#: Attributes of an environment that are no part of an episode, or that a state has otherwise.
APART = frozenset(
    "observation action difficulty render_mode image_size max_steps frame_skip sim tools action_space "
    "observation_space _spec rate _sizes _np_random _np_random_seed _start _bodies _began _random _actions _closed".split()
)


@dataclasses.dataclass(eq=False)
class EnvState:
    """What SurgicalEnv.restore_state() returns to.

    In its process it has the saved simulation, and returning takes less than a millisecond. Pickled, it has what led
    to it: the random numbers from which the episode began, and its actions. The first return of a copy makes these
    steps again, with the same bits, which restore_state() checks.
    """

    task: str  #: the class of the environment
    options: dict[str, typing.Any]  #: on which the steps depend
    random: dict[str, typing.Any]  #: of np_random, at the beginning of the episode
    actions: tuple[Array, ...]  #: since then
    hash: str  #: of the state
    kept: dict[str, typing.Any] | None = None  #: simulation, tools and attributes, in the process that made them

    def __getstate__(self) -> dict[str, typing.Any]:
        return {**self.__dict__, "kept": None}


class _Kept:
    """Attributes of an object as they were. What belongs to an environment is that of the one that they return to."""

    def __init__(self, env: SurgicalEnv, attributes: dict[str, typing.Any]):
        self._objects: list[typing.Any] = []  # of the library, which never change
        self._packed: dict[str, bytes] = {}
        for name, value in attributes.items():
            stream = io.BytesIO()
            pickler = pickle.Pickler(stream)
            pickler.persistent_id = lambda each: self._name(env, each)  # type: ignore[method-assign]
            try:
                pickler.dump(value)
            except Exception:  # what cannot be pickled stays as it is
                continue
            self._packed[name] = stream.getvalue()

    def _name(self, env: SurgicalEnv, value: typing.Any) -> tuple[str, typing.Any] | None:
        if value is env or value is env.sim:
            return ("env", None) if value is env else ("sim", None)
        for number, tool in enumerate(env.tools):
            if value is tool:
                return "tool", number
        if isinstance(value, int) or type(value).__module__.partition(".")[0] != "filasofia":
            return None
        for name, each in env.__dict__.items():
            if each is value:
                return "attribute", name
        self._objects.append(value)
        return "object", len(self._objects) - 1

    def _find(self, env: SurgicalEnv, kind: str, which: typing.Any) -> typing.Any:
        if kind == "tool":
            return env.tools[which]
        if kind == "attribute":
            return getattr(env, which)
        return self._objects[which] if kind == "object" else env.sim if kind == "sim" else env

    def put_back(self, env: SurgicalEnv, target: typing.Any) -> None:
        """Gives an object these attributes; lists and dicts stay the same objects, as others may hold them."""
        for name, packed in self._packed.items():
            unpickler = pickle.Unpickler(io.BytesIO(packed))
            unpickler.persistent_load = lambda each: self._find(env, *each)  # type: ignore[method-assign]
            value, now = unpickler.load(), getattr(target, name, None)
            if type(value) is list and type(now) is list:
                now[:] = value
            elif type(value) is dict and type(now) is dict:
                now.clear()
                now.update(value)
            else:
                setattr(target, name, value)


def saved(env: SurgicalEnv) -> EnvState:
    """The present state of an environment."""
    if not env._began:
        raise fs.Error(f"{type(env).__name__}: save_state: no episode has begun: call reset() before")
    kept = {
        "sim": env.sim.save_state(),
        "random": copy.deepcopy(env.np_random.bit_generator.state),
        "tools": [_Kept(env, tool.__dict__) for tool in env.tools],
        "names": set(env.__dict__),
        "rest": _Kept(env, {name: value for name, value in env.__dict__.items() if name not in APART}),
    }
    return EnvState(*_same(env), env._random, tuple(env._actions), env._hash(), kept)


def restore(env: SurgicalEnv, state: EnvState) -> None:
    """Returns an environment to a state."""
    name = type(env).__name__
    if not isinstance(state, EnvState):
        raise fs.Error(f"{name}: restore_state: the state must be one of save_state(), got {state!r}")
    for what, mine, theirs in zip(("class", "options"), _same(env), (state.task, state.options)):
        if mine != theirs:
            raise fs.Error(f"{name}: restore_state: the {what} must be {mine!r}, got a state of {theirs!r}")
    if state.kept is None:
        _repeat(env, state)
        state.kept = saved(env).kept
        return
    env.sim.restore(state.kept["sim"])
    for added in set(env.__dict__) - state.kept["names"] - APART:
        delattr(env, added)
    for tool, kept in zip(env.tools, state.kept["tools"]):
        kept.put_back(env, tool)
    state.kept["rest"].put_back(env, env)
    _draw_from(env, state.kept["random"])
    env._began, env._random, env._actions = True, state.random, list(state.actions)


def _same(env: SurgicalEnv) -> tuple[str, dict[str, typing.Any]]:
    """What the environments of a state have in common."""
    options = {each: getattr(env, each) for each in ("difficulty", "action", "rate", "frame_skip")}
    return f"{type(env).__module__}.{type(env).__qualname__}", options


def _draw_from(env: SurgicalEnv, state: dict[str, typing.Any]) -> None:
    """Lets np_random go on from a state of it."""
    env.np_random = np.random.Generator(getattr(np.random, state["bit_generator"])())
    env.np_random.bit_generator.state = copy.deepcopy(state)


def _repeat(env: SurgicalEnv, state: EnvState) -> None:
    """Makes the steps that led to a state."""
    _draw_from(env, state.random)
    env._begin()
    for action in state.actions:
        env._advance(action)
    if env._hash() != state.hash:
        raise fs.Error(
            f"{type(env).__name__}: restore_state: {len(state.actions)} actions must lead to the state {state.hash}, "
            f"got {env._hash()}: something else has changed the episode, or another build made it"
        )
