"""Policies that solve the tasks from what an environment knows, with box actions: for baselines and demonstrations."""

from __future__ import annotations

import itertools
import typing

import numpy as np

from . import cannulation, cuts, gallbladder, hysteroscopy, laparoscopy, stitches, tasks, threads
from .environment import SurgicalEnv
from .tool import Array, Tool, aim, turned


def scripted(env: SurgicalEnv) -> typing.Callable[[], Array]:
    """A function that returns the next action of a policy for this environment's task; make one for each episode."""
    policy = POLICIES.get(type(env))
    if policy is None:
        raise TypeError(f"scripted: there is no policy for {type(env).__name__}")
    moves = policy(env)
    return lambda: np.asarray(next(moves), dtype=np.float32)


Moves = typing.Iterator[Array]
AWAY = np.array([0.009, 0.009, 0.016])  # [m], along the shaft of the right hand in the abdomen


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


def _cut(env: cuts.PrecisionCutting) -> Moves:
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


def _resect(env: cuts.PolypRemoval) -> Moves:
    yield from _go(env, (0, 0.0065, 0.012))
    yield from _go(env, (0, 0.0065, -0.012))
    yield from _stay(3)


def _command(
    env: SurgicalEnv, tool: Tool, place: typing.Any, joints: typing.Any = None, grip: float | None = None
) -> Array:
    """The action of one tool that brings it to a place, and its joints to values (they stay, if none are given)."""
    dt = env.frame_skip / env.rate
    wanted = tool.values if joints is None else np.asarray(joints)
    turns = [np.clip((b - a) / (j.speed * dt), -1, 1) for a, b, j in zip(tool.values, wanted, tool.joints)]
    return np.concatenate([_towards(env, tool, place), turns, [] if tool.grips is None else [grip or 0.0]])


def _insert(env: threads.ThreadInHole) -> Moves:
    tool = env.tools[0]
    while True:
        top, axis = env.hole()
        error = top - env.sim.frame[env.string].positions[-1]
        above = error @ axis
        aside = error - above * axis
        down = above - 0.02 if np.linalg.norm(aside) < 0.4 * env.inner or env.depth() > 0.001 else above + 0.006
        yield _command(env, tool, tool.place + 0.06 * aside + np.clip(0.1 * down, -6e-4, 6e-4) * axis)


def _both(env: SurgicalEnv, hand: int, steps: typing.Iterable[Array]) -> Moves:
    """The steps of one hand, while the other one stays as it is."""
    for step in steps:
        rest = np.zeros(env.tools[1 - hand].size)
        yield np.concatenate([step, rest] if hand == 0 else [rest, step])


def _to(
    env: SurgicalEnv, tool: Tool, place: typing.Any, grip: float = 0.0, joints: typing.Any = None, slow: float = 1.0
) -> typing.Iterator[Array]:
    """The steps of one tool until it is at a place, or stands still."""
    before = None
    for _ in range(150):
        there = place() if callable(place) else np.asarray(place)
        if before is not None and np.array_equal(before, np.append(tool.place, tool.values)):
            return
        before = np.append(tool.place, tool.values)
        steady = joints is None or np.abs(_command(env, tool, there, joints)[3 : 3 + len(tool.joints)]).max() < 0.5
        if np.linalg.norm(np.clip(there, tool.low, tool.high) - tool.place) < 5e-4 and steady:
            return
        step = _command(env, tool, there, joints, grip)
        step[:3] *= slow
        yield step


def _thread(env: threads.RopeThreading) -> Moves:
    for i in range(len(env.eyelets)):
        middle, axis = env.places[i], env.axis(i)
        yield from _both(env, 0, _push(env, middle, axis))
        yield from _both(env, 1, _take(env, middle, axis))
        yield from _both(env, 0, [np.array([0, 0, 0, 0, -1.0])])
        first, second = env.tools
        last = i + 1 == len(env.eyelets)
        yield from _both(
            env, 1, _to(env, second, second.place + (0.03 if last else 0.025) * axis + (0, 0.004, 0), slow=0.6)
        )
        if not last:
            yield from _both(env, 0, _hand_back(env, i))
            yield from _both(env, 1, _to(env, second, second.place + (0.006, 0.02, 0), -1.0))
    yield from _stay(10)


def _end(env: threads.RopeThreading) -> Array:
    return env.sim.frame[env.rope].positions[0]


def _push(env: threads.RopeThreading, middle: Array, axis: Array) -> typing.Iterator[Array]:
    """The first hand brings the end before an eyelet, and as far through it as it can."""
    tool = env.tools[0]
    for ahead, slow in ((-0.006, 1.0), (0.012, 0.5)):
        before = tool.place + 1.0
        for _ in range(120):
            end, next_ = env.sim.frame[env.rope].positions[:2]
            heading = end - next_
            turn = np.arctan2(heading[2] * axis[0] - heading[0] * axis[2], heading @ axis)
            error = middle + ahead * axis - end
            if ahead > 0:
                along = error @ axis
                error = error + (0.0 if np.linalg.norm(error - along * axis) < 0.6 * env.ring else -along) * axis
            yield slow * _command(env, tool, tool.place + 0.5 * error, tool.values + 0.3 * turn)
            if np.linalg.norm(error) < 0.0012 or np.array_equal(tool.place, before):
                break  # there, or as near to the eyelet as the hand comes
            before = tool.place


def _take(env: threads.RopeThreading, middle: Array, axis: Array) -> typing.Iterator[Array]:
    """The second hand takes the end on the other side."""
    tool = env.tools[1]
    yield from _to(env, tool, lambda: _end(env) + 0.008 * axis + (0, 0.015, 0), -1.0)
    yield from _to(env, tool, lambda: _end(env) + (0, 0.001, 0), -1.0)
    yield np.array([0, 0, 0, 0, 1.0])
    yield np.zeros(5)


def _hand_back(env: threads.RopeThreading, i: int) -> typing.Iterator[Array]:
    """The first hand takes the rope again, between its end and the eyelet that it went through."""
    tool = env.tools[0]
    yield from _to(env, tool, tool.place + (-0.004, 0.035, 0))

    def behind() -> Array:
        places = env.sim.frame[env.rope].positions
        return (places[3] + places[4]) / 2

    yield from _to(env, tool, lambda: behind() + (0, 0.02, 0))
    yield from _to(env, tool, behind)
    yield np.array([0, 0, 0, 0, 1.0])


def _ligate(env: stitches.LigatingLoop) -> Moves:
    tool = env.tools[0]
    yield from _to(env, tool, lambda: tool.place + (env._middle() - env._noose().mean(axis=0)) * (1, 0, 1))
    for pull in (0.0, 0.035, 0.08):
        reach = 0.0 if pull == 0 else tool.place[2] - env._middle()[2] - 0.010

        def level(reach: float = reach) -> Array:
            error = env._middle() - env._noose().mean(axis=0)
            return tool.place + (error[0] if reach == 0 else 0.0, error[1], -reach)

        goal = level()
        yield from _to(env, tool, goal, joints=[0.0, pull])
    yield from _stay(tool.size)


def _drive(env: stitches.Suture, middle: Array, grip: float, done: typing.Callable[[], bool]) -> Moves:
    """Turns the driver on, and moves it so that the needle turns about its middle."""
    tool = env.tools[0]
    turn = tool.joints[0].speed * env.frame_skip / env.rate
    for _ in range(120):
        if done():
            return
        axis = turned(tool.turn(), (0, 1, 0))
        offset = env.sim.frame[env.needle].poses[0, :3] - tool.place
        after = (
            offset * np.cos(turn) + np.cross(axis, offset) * np.sin(turn) + axis * (axis @ offset) * (1 - np.cos(turn))
        )
        yield _command(env, tool, middle - after, tool.values + turn, grip)


def _suture(env: stitches.Suture) -> Moves:
    tool = env.tools[0]
    marks = [env._at(each) for each in env.targets]
    half = np.linalg.norm(marks[1] - marks[0]) / 2
    middle = sum(marks) / 2 + (0, np.sqrt(env.radius**2 - half**2), 0)

    def beside(height: float) -> typing.Callable[[], Array]:
        return lambda: tool.place + middle + (0, height, 0) - env.sim.frame[env.needle].poses[0, :3]

    yield from _to(env, tool, beside(0.008))
    yield from _to(env, tool, beside(0.0))
    yield from _drive(env, middle, 0.0, lambda: tool.values[0] > 3.5)
    yield _command(env, tool, tool.place, grip=-1.0)
    yield from _to(env, tool, tool.place + (0, 0.012, 0), -1.0, [2.0])
    yield from _to(env, tool, lambda: env.needle_at(15) + (0, 0.008, 0), -1.0, [2.0])
    yield from _to(env, tool, lambda: env.needle_at(15), -1.0, [2.0])
    yield _command(env, tool, tool.place, grip=1.0)
    yield from _drive(env, middle, 0.0, lambda: env._stitch()[1] and env.needle_at(180)[1] > 0.002)
    yield from _to(env, tool, tool.place + (0, 0.01, 0))
    yield from _to(env, tool, (-0.05, 0.02, tool.place[2] - 0.004))  # across: both ends draw the edges together
    yield from _stay(tool.size)


def _transfer(env: laparoscopy.PegTransfer) -> Moves:
    left, right = env.tools
    beside = env.inner + env.wall / 2
    for i, wanted in enumerate(env.wanted):

        def at(side: float, above: float, i: int = i) -> typing.Callable[[], Array]:
            return lambda: env.ring(i) + (side * beside, env.height / 2 + 0.003 + above, 0)

        def carry(tool: Tool, place: Array, i: int = i) -> typing.Callable[[], Array]:
            return lambda: tool.place + place - env.ring(i)

        yield from _both(env, 0, _to(env, left, at(-1, 0.012), -1.0))
        yield from _both(env, 0, _until(env, left, at(-1, -0.004), lambda: env.has(0, i)))
        yield from _both(env, 0, _to(env, left, carry(left, env.ring(i) * (1, 0, 1) + (0, 0.032, 0)), 1.0))
        yield from _both(env, 0, _to(env, left, carry(left, np.array([0.0, 0.036, 0.0])), 1.0))
        yield from _both(env, 1, _to(env, right, at(1, 0.012), -1.0))
        yield from _both(env, 1, _until(env, right, at(1, -0.004), lambda: env.has(1, i)))
        yield from _both(env, 0, [np.array([0, 0, 0, -1.0])] * 2)
        yield from _both(env, 0, _to(env, left, left.place + (-0.03, 0.01, 0.0), -1.0))
        yield from _both(env, 1, _to(env, right, carry(right, wanted + (0, 0.032, 0)), 1.0))
        yield from _both(env, 1, _to(env, right, carry(right, wanted + (0, 0.006, 0)), 1.0, slow=0.5))
        yield from _both(env, 1, [np.array([0, 0, 0, -1.0])] * 2)
        yield from _both(env, 1, _to(env, right, right.place + (0.0, 0.03, 0.01), -1.0))
    yield from _stay(8)


def _until(
    env: SurgicalEnv, tool: Tool, place: typing.Callable[[], Array], done: typing.Callable[[], bool]
) -> typing.Iterator[Array]:
    """Closed, to a place, until something is done."""
    for _ in range(60):
        if done():
            return
        step = _command(env, tool, place(), grip=1.0)
        step[:3] *= 0.5
        yield step


def _pattern(env: laparoscopy.PatternCutting) -> Moves:
    scissors, hand = env.tools
    if env.difficulty > 0:
        corner = env.corner
        yield from _both(env, 1, _to(env, hand, lambda: env.sim.frame[env.gauze].positions[corner] + (0, 0.01, 0), -1.0))
        yield from _both(
            env,
            1,
            _until(env, hand, lambda: env.sim.frame[env.gauze].positions[corner], lambda: env.holds(hand)),
        )
        yield from _both(env, 1, _to(env, hand, np.array([-0.05, 0.004, 0.05]), 1.0))
    grip = 0.0 if env.difficulty == 0 else 1.0

    def cut(x: float, z: float, heading: float, slow: float = 1.0, up: float = 0.0) -> Moves:
        for _ in range(60):
            there = env.at(x, z) + (0, up, 0)
            step = _command(env, scissors, there, [heading])
            far = np.linalg.norm(there - scissors.place)
            if far < 8e-4:
                return
            step[:3] *= slow
            yield np.concatenate([step, [0, 0, 0, grip]])

    yield from cut(0.0, env.radius, np.pi / 2, up=0.025)
    yield from cut(0.0, env.radius, np.pi / 2)
    parts = 60
    for i in range(1, parts + 12):  # on over its start, where something may still hold
        angle = 2 * np.pi * i / parts
        yield from cut(env.radius * np.sin(angle), env.radius * np.cos(angle), np.pi / 2 + angle)
    yield from _stay(8, grip)


def _clip_and_cut(env: laparoscopy.ClipAndCut) -> Moves:
    applier, scissors = env.tools
    for x in (*env.wanted[0], *env.wanted[1]):
        place = env.at(x)
        yield from _both(env, 0, _to(env, applier, place + (0, 0, 0.014), -1.0))
        yield from _both(env, 0, _to(env, applier, place, -1.0))
        yield from _both(env, 0, [np.array([0, 0, 0, 1.0])] * 18)
        yield from _both(env, 0, _to(env, applier, place + (0, 0, 0.014), 0.0))
    for off in (0.0, 8e-4, -8e-4, 1.6e-3, -1.6e-3):  # a cut may leave a bridge
        if env.sim.duct(env.vessel).state in ("cut", "leaking"):
            break
        place = env.at(env.cut_at) + (off, 0, 0)
        yield from _both(env, 1, _to(env, scissors, place + (0, 0.006, 0)))
        yield from _both(env, 1, _to(env, scissors, place - (0, 0.006, 0), slow=0.6))
        yield from _both(env, 1, _to(env, scissors, place + (0, 0.006, 0)))
    yield from _stay(7, -1.0)


def _cannulate(env: cannulation.Cannulation) -> Moves:
    tool, hole = env.tools[0], env.hole()
    back = np.array([-np.cos(cannulation.STEEP), np.sin(cannulation.STEEP), 0.0])

    def behind(away: float) -> Array:
        return env.sim.frame[env.catheter].positions[-1 - round(away / env.spacing)]

    def lead(to: Array) -> Array:
        return tool.place + to - behind(0.0)

    where = 0.024
    for _ in range(4):
        yield from _go(env, lambda: behind(where) + (0, 0.012, 0.006), -1.0)
        yield from _go(env, lambda: behind(where), -1.0)
        yield from _again(np.array([0, 0, 0, 1.0]), 2)
        if env.depth() == 0:
            yield from _go(env, lambda: lead(hole + 0.012 * back), 1.0)
            yield from _go(env, lambda: lead(hole + 0.004 * back), 1.0)
        for _ in range(60):
            away = hole - tool.place
            if np.linalg.norm(away) < 0.014 or not env.holds(tool) or env.depth() > env.wanted + 0.0015:
                break
            yield np.append(_towards(env, tool, tool.place + 6e-4 * away / np.linalg.norm(away)), 1.0)
        yield from _again(np.array([0, 0, 0, -1.0]), 2)
        if env.depth() > env.wanted:
            break
        where = 0.024 + env.depth()
    yield from _stay(4, -1.0)


def _dissect(env: gallbladder.GallbladderEnv, part: int) -> Moves:
    """The hook passes over the points of a part of the bed that hold, always to the nearest one."""
    hook = env.tools[1]
    for back in (AWAY, 0 * AWAY):
        yield from _to(env, hook, env.nearest(part) + back, -1.0)
    for _ in range(200):
        if not len(env.holding(part)):
            break
        yield _command(env, hook, env.nearest(part) + (0, 0, 0.0004), grip=1.0)
    yield from _to(env, hook, hook.place + AWAY, -1.0)


def _detach(env: gallbladder.GallbladderDissection) -> Moves:
    for part in (0, 1):
        yield from _both(env, 1, _dissect(env, part))
    yield from _stay(8, -1.0)


def _take_instrument(env: gallbladder.Cholecystectomy, which: int) -> Moves:
    """Draws the right hand back, and gives it another instrument."""
    tool = env.tools[1]
    yield from _to(env, tool, (0.03, 0.015, 0.05), -1.0)
    while env.chosen != which:
        yield _command(env, tool, tool.place, [tool.values[0], which], -1.0)


def _part_layer(env: gallbladder.Cholecystectomy) -> Moves:
    """The hook passes through the layer between duct and artery, towards the gall bladder, until it is parted."""
    hook = env.tools[1]
    for off in (0.0, 0.001, -0.001):
        yield from _to(env, hook, env.middle()[-1] + AWAY, -1.0)
        yield from _to(env, hook, env.middle()[-1] + (0, off, -0.0005), -1.0)
        for i in range(10, -1, -1):
            yield from _to(env, hook, lambda i=i: env.middle()[i] + (0, off, -0.0005), 1.0, slow=0.5)
        yield from _to(env, hook, hook.place + AWAY, -1.0)
        if env.parted:
            return


def _close_on(env: gallbladder.Cholecystectomy, tube: gallbladder.Tube, part: float, times: int) -> Moves:
    """Applier or scissors go across a tube, close for so many actions, and draw back."""
    tool = env.tools[1]

    def across() -> Array:
        along = tube.at(part + 0.04) - tube.at(part - 0.04)
        base = aim(tool.place, tool.port)
        turn = np.arctan2(-along @ turned(base, (0, 0, 1)), along @ turned(base, (1, 0, 0)))
        return np.array([turn - np.pi * round(turn / np.pi), tool.values[1]])

    yield from _to(env, tool, tube.at(part) + AWAY, -1.0, across())
    yield from _to(env, tool, tube.at(part), -1.0, across())
    for _ in range(times):
        yield _command(env, tool, tool.place, grip=1.0)
    yield from _to(env, tool, tool.place + AWAY, -1.0)


def _take_neck(env: gallbladder.Cholecystectomy) -> Moves:
    """The left hand grasps the neck, and draws it aside."""
    left = env.tools[0]
    yield from _both(env, 0, _to(env, left, lambda: env.neck() + (-0.006, -0.003, 0.008)))
    yield from _both(env, 0, _until(env, left, env.neck, lambda: env.holds(left)))
    yield from _both(env, 0, _to(env, left, left.place + (-0.004, -0.003, 0.003), slow=0.3))


def _take_out(env: gallbladder.Cholecystectomy) -> Moves:
    if not env.holds(env.tools[0]):
        yield from _take_neck(env)
    yield from _both(env, 1, _part_layer(env))
    yield from _both(env, 1, _dissect(env, 0))
    yield from _both(env, 1, _take_instrument(env, gallbladder.APPLIER))
    for tube in env.tubes:
        for part in tube.wanted[::-1]:
            yield from _both(env, 1, _close_on(env, tube, part, 16))
    yield from _both(env, 1, _take_instrument(env, gallbladder.SCISSORS))
    for tube in env.tubes:
        for off in (0.0, 0.03, -0.03):  # a cut may leave a bridge
            if not tube.is_cut():
                yield from _both(env, 1, _close_on(env, tube, tube.cut_at + off, 6))
    yield from _both(env, 1, _take_instrument(env, gallbladder.HOOK))
    yield from _both(env, 1, _dissect(env, 1))
    yield from _stay(10, -1.0)


def _pluck(env: hysteroscopy.HysteroscopicPolypectomy) -> Moves:
    """Takes a bite of the polyp and draws; if only the bite comes, takes a deeper one."""
    tool, os = env.tools[0], np.asarray(env.os)

    def before(back: float) -> Array:
        way = os - env.middle()
        return env.middle() + back * way / np.linalg.norm(way)

    for near in (0.003, 0.002, 0.001, 0.0, -0.001, -0.002):
        yield from _go(env, lambda: before(0.012), -1.0)
        yield from itertools.islice(_go(env, lambda: before(near), -1.0), 60)
        yield from _again(np.append(np.zeros(3), 1.0), 2)
        if not env.holds(tool):
            continue
        yield from _go(env, os - (0, 0.006, 0), 1.0)
        if np.linalg.norm(env.middle() - tool.place) < 0.012:
            break
    yield from _go(env, os + (0, 0.018, 0), 1.0)
    yield from _stay(4, 1.0)


def _shave(env: hysteroscopy.HysteroscopicMyomectomy) -> Moves:
    """Strokes towards the scope, from the top down to half a millimetre above the wall."""
    tool, os = env.tools[0], np.asarray(env.os)
    up = env.out()
    across = np.cross(env.root() - os, up)
    across /= np.linalg.norm(across)
    ahead, beyond = np.cross(up, across), 0.0013
    radius = env.loop.definition.width / 2

    def held(ahead_: float, side: float, bottom: float) -> tuple[Array, float]:
        """Where the loop's arms end, and how they are turned, so that its bottom is at a place above the wall."""
        lowest = env.root() + side * across + ahead_ * ahead + bottom * up
        place, roll = lowest + env.depth * up, 0.0
        for _ in range(3):
            base = aim(place, tool.port)
            seen = turned(base * (1, -1, -1, -1), up)
            roll = float(np.arctan2(seen[0], seen[2]))
            place = lowest + env.depth * turned(base, (np.sin(roll), 0.0, np.cos(roll)))
        return place, roll

    def to(ahead_: float, side: float, bottom: float, pedal: float, slow: float = 1.0) -> Moves:
        place, roll = held(ahead_, side, bottom)
        for _ in range(100):
            if np.linalg.norm(place - tool.place) < 3e-4 and abs(roll - tool.values[0]) < 0.03:
                return
            turn = np.clip((roll - tool.values[0]) * env.rate / env.frame_skip / tool.joints[0].speed, -1.0, 1.0)
            yield np.append(slow * _towards(env, tool, place), (turn, pedal))

    strokes = [(4e-3, 0.0), (2.4e-3, 1.8e-3), (2.4e-3, -1.8e-3)]
    strokes += [(0.5e-3, side) for _ in range(2) for side in (0.0, 2.8e-3, -2.8e-3)]
    for bottom, side in strokes:
        from_ = env.rooted() - env.root()
        beside = from_ @ across - side
        near = np.abs(beside) < radius
        thick = from_[near] @ up - bottom - radius + np.sqrt(radius**2 - beside[near] ** 2)
        if not len(thick) or thick.max() < 1e-3:
            continue
        span = (from_ @ ahead)[near][thick > 0.0]
        high = 6.7e-3
        yield from to(span.max() + beyond, side, high, -1.0)
        yield from to(span.max() + beyond, side, bottom, -1.0)
        yield from to(span.min() - beyond, side, bottom, 1.0, slow=0.5)
        yield from to(span.min() - beyond, side, high, -1.0)
    yield from _stay(5, -1.0)


def _again(action: Array, times: int) -> Moves:
    for _ in range(times):
        yield action


POLICIES: dict[type[SurgicalEnv], typing.Callable[[typing.Any], Moves]] = {
    tasks.Reach: _reach,
    tasks.DeflectSpheres: _deflect,
    tasks.SearchForPoint: _search,
    tasks.TissueManipulation: _manipulate,
    tasks.TissueRetraction: _retract,
    tasks.BimanualTissueManipulation: _manipulate,
    cuts.PrecisionCutting: _cut,
    tasks.PickAndPlace: _place,
    tasks.GraspLift: _lift,
    cuts.PolypRemoval: _resect,
    threads.ThreadInHole: _insert,
    threads.RopeThreading: _thread,
    stitches.LigatingLoop: _ligate,
    stitches.Suture: _suture,
    laparoscopy.PegTransfer: _transfer,
    laparoscopy.PatternCutting: _pattern,
    laparoscopy.ClipAndCut: _clip_and_cut,
    cannulation.Cannulation: _cannulate,
    gallbladder.GallbladderDissection: _detach,
    gallbladder.Cholecystectomy: _take_out,
    hysteroscopy.HysteroscopicPolypectomy: _pluck,
    hysteroscopy.HysteroscopicMyomectomy: _shave,
}
