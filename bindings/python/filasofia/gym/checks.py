"""What a task of one's own returns must be usable: an Error names the task, its method, the bound and the value.

A not-a-number in an observation or a reward would end in the weights of a policy, many steps later.
"""

from __future__ import annotations

import operator
import typing

import numpy as np

import filasofia as fs

from .judgement import Judgement
from .tool import Array, Joint, Tool


def missing(task: object, what: str) -> NotImplementedError:
    """The error of a method that a task has to override."""
    return NotImplementedError(f"{type(task).__name__} must override {what}")


def whole(value: typing.Any, low: int, high: int) -> int | None:
    """The value as an int, if it is a whole number in [low, high], also one of NumPy; a flag is none."""
    if isinstance(value, bool):
        return None
    try:
        number = operator.index(value)
    except TypeError:
        return None
    return number if low <= number <= high else None


def check_tools(task: str, tools: typing.Any, known: list[fs.BodyId]) -> list[Tool]:
    """What build() returned, if it is a list of tools of known bodies, whose workspaces hold their starts."""
    if not isinstance(tools, (list, tuple)) or not all(isinstance(each, Tool) for each in tools):
        raise fs.Error(f"{task}: build() must return a list of tools, got {tools!r}")
    for number, tool in enumerate(tools):
        _check_tool(f"{task}: tools[{number}]", tool)
        _check_tool_bodies(f"{task}: tools[{number}]", tool, known)
    return list(tools)


def check_bodies(task: str, who: str, sim: fs.Simulation, bodies: list[fs.BodyId]) -> None:
    """Error if bodies were added to, or removed from, those that build() and prepare() left."""
    now = sim.bodies
    changed = [f"'{sim.definition(each).name}' was added" for each in now if each not in bodies]
    changed += [f"body {int(each)} was removed" for each in bodies if each not in now]
    if changed:
        raise fs.Error(
            f"{task}: {who} must not add or remove bodies, but {', '.join(changed)}: an episode begins by returning "
            "to the state after prepare(). Add bodies in build(); arrange() can move them, out of sight, too "
            "(put(), sim.set_pose())"
        )


def check_judgement(task: str, judgement: typing.Any) -> Judgement:
    """What judge() returned, if it is a Judgement whose terms are finite."""
    if not isinstance(judgement, Judgement):
        raise fs.Error(f"{task}: judge() must return a Judgement, got {judgement!r}")
    for name in ("reward", "measures"):
        if not isinstance(getattr(judgement, name), dict):
            raise fs.Error(f"{task}: judge(): {name} must be a dict, got {getattr(judgement, name)!r}")
    for name, term in judgement.reward.items():
        if not _finite(term, ()):
            raise fs.Error(f"{task}: judge(): reward[{name!r}] must be a finite number, got {term!r}")
    if not isinstance(judgement.success, (bool, np.bool_)):
        raise fs.Error(f"{task}: judge(): success must be True or False, got {judgement.success!r}")
    return judgement


def check_features(task: str, features: typing.Any) -> Array:
    """What features() returned, as one row, if it is numbers."""
    try:
        row = np.ravel(np.asarray(features, dtype=float))
    except (TypeError, ValueError):
        row = np.array([np.nan])
    if np.isnan(row).any():
        raise fs.Error(f"{task}: features() must be numbers, got {features!r}")
    return row


def _finite(value: typing.Any, shape: tuple[int, ...]) -> bool:
    try:
        numbers = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        return False
    return numbers.shape == shape and bool(np.isfinite(numbers).all())


def _check_tool(name: str, tool: Tool) -> None:
    for field in ("start", "low", "high"):
        if not _finite(getattr(tool, field), (3,)):
            raise fs.Error(f"{name}.{field} must be three finite numbers [m], got {getattr(tool, field)!r}")
    if not np.all(np.asarray(tool.low) <= np.asarray(tool.high)):
        raise fs.Error(f"{name}.low must be <= high along each axis, {tool.high!r}, got {tool.low!r}")
    if not np.all((np.asarray(tool.low) <= tool.start) & (tool.start <= np.asarray(tool.high))):
        raise fs.Error(f"{name}.start must be between low, {tool.low!r}, and high, {tool.high!r}, got {tool.start!r}")
    if not (_finite(tool.speed, ()) and tool.speed >= 0):
        raise fs.Error(f"{name}.speed must be a finite number >= 0 m/s, got {tool.speed!r}")
    if not (_finite(tool.strength, ()) or tool.strength == float("inf")) or not tool.strength > 0:
        raise fs.Error(f"{name}.strength must be > 0 N, got {tool.strength!r}")
    if tool.port is not None and not _finite(tool.port, (3,)):
        raise fs.Error(f"{name}.port must be three finite numbers [m], or None, got {tool.port!r}")
    for number, joint in enumerate(tool.joints):
        _check_joint(f"{name}.joints[{number}]", joint)


def _check_tool_bodies(name: str, tool: Tool, known: list[fs.BodyId]) -> None:
    if tool.body not in known:
        raise fs.Error(f"{name}.body must be a body of the simulation, got {tool.body!r}")
    if tool.grips is not None and tool.grips not in known:
        raise fs.Error(f"{name}.grips must be a body of the simulation, or None, got {tool.grips!r}")


def _check_joint(name: str, joint: Joint) -> None:
    for field in ("low", "high", "speed", "start"):
        if not _finite(getattr(joint, field), ()):
            raise fs.Error(f"{name}.{field} must be a finite number, got {getattr(joint, field)!r}")
    if not joint.low < joint.high:
        raise fs.Error(f"{name}.low must be < high, {joint.high!r}, got {joint.low!r}")
    if not joint.low <= joint.start <= joint.high:
        raise fs.Error(f"{name}.start must be in [{joint.low!r}, {joint.high!r}], got {joint.start!r}")
    if joint.speed < 0:
        raise fs.Error(f"{name}.speed must be >= 0, got {joint.speed!r}")
    if joint.axis is not None and not (_finite(joint.axis, (3,)) and abs(np.linalg.norm(joint.axis) - 1) < 1e-6):
        raise fs.Error(f"{name}.axis must be three numbers of length 1, or None, got {joint.axis!r}")
