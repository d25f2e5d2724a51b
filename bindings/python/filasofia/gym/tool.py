"""Instruments that actions move, turn and close."""

from __future__ import annotations

import dataclasses
import typing

import numpy as np

import filasofia as fs

Array = typing.Any  # numpy.ndarray


@dataclasses.dataclass(frozen=True)
class Joint:
    """One more component of an instrument's action: a turn about an axis of it, or a number that the task uses."""

    low: float  #: [rad] if it turns, below high
    high: float
    speed: float  #: [rad/s] if it turns, of an action of 1, >= 0
    axis: tuple[float, float, float] | None = None  #: of length 1, in own coordinates; none: it does not turn it
    start: float = 0.0  #: in [low, high]


@dataclasses.dataclass
class Tool:
    """An instrument whose tip an action moves within a box, and turns.

    Its own coordinates have the tip at the origin and the shaft along +y. Without a port they stay parallel to those of
    the world. With one the shaft always passes through that point, as through a trocar. `joints` turn it further.
    """

    body: fs.BodyId
    start: tuple[float, float, float]  #: [m]
    low: tuple[float, float, float]  #: [m], the workspace's corners
    high: tuple[float, float, float]  #: [m]
    speed: float = 0.1  #: [m/s], >= 0, along each axis, of an action of 1
    grips: fs.BodyId | None = None  #: what it can grasp, by one more component of the action
    port: tuple[float, float, float] | None = None  #: [m], above the workspace
    joints: tuple[Joint, ...] = ()
    strength: float = float("inf")  #: [N], > 0: its hand does not push or pull against a larger force
    place: Array = None  #: [m], now
    values: Array = None  #: those of the joints, now
    grasp: fs.AttachmentId | None = None  #: while it is closed

    def __post_init__(self) -> None:
        self.reset()

    @property
    def size(self) -> int:
        """How many components its action has."""
        return 3 + len(self.joints) + (self.grips is not None)

    def reset(self) -> None:
        """As it is at the start. Error if the joints are not a list of them."""
        if not isinstance(self.joints, (tuple, list)) or not all(isinstance(each, Joint) for each in self.joints):
            raise fs.Error(f"Tool: joints must be a tuple of Joints, got {self.joints!r}")
        self.place, self.grasp = np.array(self.start, dtype=float), None
        self.values = np.array([joint.start for joint in self.joints])

    def move(self, action: Array, dt: float) -> Array:
        """The place that an action [-1, 1] asks for within the workspace; the joints are moved."""
        speeds, lows, highs = (np.array([getattr(j, name) for j in self.joints]) for name in ("speed", "low", "high"))
        self.values = np.clip(self.values + dt * speeds * action[3 : 3 + len(self.joints)], lows, highs)
        return np.clip(self.place + self.speed * dt * action[:3], self.low, self.high)

    def pose(self) -> typing.Any:
        """Where it is: a place if it never turns, or a Pose."""
        if self.port is None and not any(joint.axis for joint in self.joints):
            return tuple(float(each) for each in self.place)
        return posed(self.place, self.turn())

    def turn(self) -> Array:
        """Its orientation: a quaternion (w, x, y, z)."""
        turn = aim(self.place, self.port)
        for joint, value in zip(self.joints, self.values):
            if joint.axis is not None:
                turn = times(turn, np.append(np.cos(value / 2), np.sin(value / 2) * np.asarray(joint.axis)))
        return turn

    def units(self) -> Array:
        """The joints as numbers in [-1, 1]."""
        return np.array([2 * (v - j.low) / (j.high - j.low) - 1 for j, v in zip(self.joints, self.values)])


def aim(place: typing.Any, port: typing.Any = None) -> Array:
    """The shortest turn, a quaternion, that lets a shaft along +y pass from a place through a port."""
    if port is None:
        return np.array([1.0, 0.0, 0.0, 0.0])
    shaft = np.asarray(port, dtype=float) - place
    found = np.append(1.0 + shaft[1] / np.linalg.norm(shaft), np.cross((0.0, 1.0, 0.0), shaft / np.linalg.norm(shaft)))
    return found / np.linalg.norm(found)


def holds_down(before: bool, command: float) -> bool:
    """Whether the last component of an action holds a pedal down: above 0.3 it does, down to -0.3 if it did before."""
    return command > 0.3 or (before and command > -0.3)


def posed(place: Array, turn: Array) -> fs.Pose:
    """A Pose of arrays."""
    return fs.Pose(tuple(float(each) for each in place), tuple(float(each) for each in turn))


def times(a: Array, b: Array) -> Array:
    """The turn b, then the turn a."""
    return np.append(a[0] * b[0] - a[1:] @ b[1:], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:]))


def turned(turn: Array, vector: typing.Any) -> Array:
    """A vector after a turn."""
    v = np.asarray(vector, dtype=float)
    across = 2.0 * np.cross(turn[1:], v)
    return v + turn[0] * across + np.cross(turn[1:], across)
