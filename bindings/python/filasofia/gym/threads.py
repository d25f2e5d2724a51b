"""Tasks with threads and ropes, comparable to LapGym's ThreadInHole and RopeThreading."""

from __future__ import annotations

import typing

import numpy as np

import filasofia as fs

from . import bodies
from .environment import SurgicalEnv, distance
from .judgement import Judgement
from .tool import Array, Joint, Tool, posed, turned

GREEN, BLUE = (0.0, 0.75, 0.1), (0.0, 0.1, 0.9)


def plain(color: typing.Any, wetness: float = 0.0) -> fs.TissueMaterial:
    """Plastic: a material without vessels and relief."""
    return fs.TissueMaterial(base_color=color, subsurface_color=color, wetness=wetness, vessels=0, mottling=0, bump=0)


class ThreadEnv(SurgicalEnv):
    """What tasks with threads share: threads, and graspers that clamp a thread.

    A grasper clamps the edge of the thread that is nearest to the middle of its jaws, if that is within 3 mm: it holds
    its place, its direction and its turn.
    """

    reach = 0.003  #: [m]

    def thread(self, name: str, points: typing.Any, color: typing.Any, **fields: typing.Any) -> fs.BodyId:
        """Adds a thread through these points [m]; `fields` are those of RodBodyDef."""
        fields.setdefault("collision", fs.RodCollision(self=False))
        fields.setdefault("rayleigh", fs.Rayleigh(mass=20, stiffness=2e-3))
        body = self.sim.add(fs.RodBodyDef(name=name, points=points, **fields))
        self.sim.show(body, material=plain(color, 0.2))
        return body

    def catch(self, tool: Tool) -> fs.AttachmentId | None:
        if tool.grips is None:
            return None
        places = self.sim.frame[tool.grips].positions
        away = np.linalg.norm((places[:-1] + places[1:]) / 2 - tool.place, axis=1)
        nearest = int(away.argmin())
        if away[nearest] > self.reach:
            return None
        return self.sim.attach(tool.grips, fs.AttachmentDef(nodes=[nearest, nearest + 1], to=tool.body))


class ThreadInHole(ThreadEnv):
    """Bring the end of a thread that hangs from an instrument into the hole of a cylinder, and down to a depth.

    The instrument turns about a port above the scene. Difficulty: a wide hole in rigid plastic, a narrow one, a narrow
    one in soft tissue. Features: four points of the thread (4, 3), the middle of the opening (3), the hole's axis (3),
    how deep the end is of what is wanted (1).
    Success: the end is 10, 12 or 15 mm below the rim (difficulty), and all of the thread between is in the hole.
    Reward: -10 times the distance of the end from the opening while it is outside, -20 times what the depth lacks [m],
    +10 for success.
    """

    eye, looks_at = (0.05, 0.18, 0.15), (0.0, 0.05, 0.0)
    lens = fs.CameraDef(vertical_field_of_view=0.6, near=0.001, exposure=10.8)
    height, port = 0.03, (0.0, 0.2, 0.08)

    def build(self) -> list[Tool]:
        self.inner = (0.005, 0.0035, 0.0035)[self.difficulty]
        self.wanted = (0.010, 0.012, 0.015)[self.difficulty]
        self.table(top=-0.003)
        self.yields = self.difficulty == 2
        self.foot = self._cylinder()
        start = (-0.02, 0.09, 0.02)
        tool = Tool(
            self.grasper("grasper", start, self.port),
            start,
            (-0.05, 0.045, -0.04),
            (0.05, 0.1, 0.05),
            0.06,
            port=self.port,
        )
        along = turned(tool.turn(), (0, -1, 0))
        self.string = self.thread(
            "thread",
            [np.array(start) - 0.004 * along, np.array(start) + 0.046 * along],
            (0.15, 0.2, 0.75),
            spacing=2e-3,
            radius=0.8e-3,
            young_modulus=2e6,
            friction=0.1,
            attachments=[fs.AttachmentDef(nodes=[0, 1, 2], to=tool.body)],
        )
        return [tool]

    def _cylinder(self) -> fs.BodyId:
        """The hole: a rigid cylinder, or one of tissue that stands on a rigid plate."""
        outer = self.inner + 0.004
        wall = bodies.pipe(self.inner, outer, self.height, 32)
        plate = bodies.moved(fs.shapes.cylinder(outer + 0.004, 0.003), (0, -0.0015, 0))
        surface = plate if self.yields else bodies.joined(wall, plate)
        foot = self.sim.add(
            fs.RigidBodyDef(
                name="cylinder",
                elements=[(0, 0, 0)],
                mesh=surface,
                collision=[] if self.yields else [fs.CollisionDef(proximity=0.5e-3)],
                friction=0.1,
            )
        )
        self.sim.show(foot, material=plain((0.85, 0.82, 0.75), 0.3))
        if self.yields:
            self.tissue = self.soft(
                "tissue",
                bodies.soft_pipe(self.inner, outer, self.height, (16, 6, 2)),
                material=fs.FemMaterial(young_modulus=30e3, poisson_ratio=0.4),
                attachments=[fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, 1e-4, 1)), to=foot)],
                collision=[fs.CollisionDef(proximity=0.5e-3)],
                friction=0.1,
            )
        return foot

    def moves(self) -> dict[fs.BodyId, typing.Any]:
        return {**super().moves(), self.foot: self.middle}

    def prepare(self) -> None:
        self.middle = np.zeros(3)
        if self.yields:
            rest = self.sim.frame[self.tissue].positions
            lining = np.hypot(rest[:, 0], rest[:, 2]) < self.inner + 1e-4
            self.rim, self.floor = (np.flatnonzero(lining & (abs(rest[:, 1] - y) < 1e-3)) for y in (self.height, 0.0))
        self.sim.step(300)  # the thread comes to rest

    def arrange(self) -> None:
        self.middle = np.array([*self.np_random.uniform((-0.01, -0.015), (0.025, 0.015)), 0.0])[[0, 2, 1]]
        self.carry(self.tools, (-0.008, 0, -0.008), (0.008, 0.006, 0.008))

    def hole(self) -> tuple[Array, Array]:
        """The middle of the opening, and the direction of the hole's axis, upwards."""
        if not self.yields:
            return self.middle + (0, self.height, 0), np.array([0.0, 1.0, 0.0])
        places = self.sim.frame[self.tissue].positions
        top, bottom = places[self.rim].mean(axis=0), places[self.floor].mean(axis=0)
        return top, (top - bottom) / np.linalg.norm(top - bottom)

    def depth(self) -> float:
        """How far the end is below the rim [m]; 0 if it is not in the hole."""
        top, axis = self.hole()
        away = self.sim.frame[self.string].positions[::-1] - top
        along = away @ axis
        across = np.linalg.norm(away - np.outer(along, axis), axis=1)
        above = np.flatnonzero(along >= 0)
        within = along[: above[0]] if above.size else along
        inside = across[: len(within)] < self.inner
        return float(-along[0]) if len(within) and inside.all() else 0.0

    def features(self) -> Array:
        places = self.sim.frame[self.string].positions
        chosen = places[np.linspace(0, len(places) - 1, 5).astype(int)[1:]]
        top, axis = self.hole()
        return np.concatenate([self.unit(chosen).ravel(), self.unit(top), axis, [self.depth() / self.wanted]])

    def judge(self) -> Judgement:
        depth = self.depth()
        end = self.sim.frame[self.string].positions[-1]
        away = 0.0 if depth > 0 else distance(end, self.hole()[0])
        force = float(self.sim.frame.contacts["normal_force"].sum())
        success = depth >= self.wanted
        lacks = max(self.wanted - depth, 0.0)
        reward = {"distance": -10 * away, "depth": -20 * lacks, "success": 10.0 * success}
        return Judgement(reward, success, {"depth": depth, "distance": away, "force": force})


class RopeThreading(ThreadEnv):
    """Pass the end of a rope through eyelets with two graspers, which hand it over.

    The first grasper holds the rope behind its end. Graspers turn about ports and their shafts, clamp the rope and
    let it go; they do not fit through an eyelet. Difficulty: a wide eyelet, a narrow one, two of them. Features: eight
    points of the rope (8, 3), and for each eyelet its middle (3), its axis (3), and how much rope is through (1).
    Success: the rope runs through all eyelets in their order, along their axes, and 8, 30 or 30 mm of it are through
    the last one (difficulty): as much as one hand can push, or as only a hand on the other side can pull.
    Reward: -1 for each eyelet it does not run through, -10 times the distance of its end from the first of these, -20
    times the length that is not yet through the last one [m], +10 for success.
    """

    eye, looks_at = (0.02, 0.17, 0.15), (0.005, 0.03, 0.0)
    lens = fs.CameraDef(vertical_field_of_view=0.7, near=0.001, exposure=10.7)
    ports = ((-0.08, 0.22, 0.1), (0.09, 0.22, 0.1))
    wire, clearance = 0.0012, 0.0035

    def build(self) -> list[Tool]:
        self.ring = (0.007, 0.005, 0.006)[self.difficulty]
        self.wanted = (0.008, 0.03, 0.03)[self.difficulty]
        self.table()
        self.rows = np.array([-0.015, 0.04] if self.difficulty == 2 else [0.0])
        self.eyelets = [self._eyelet(f"eyelet {i}", (x, 0.03, 0.0)) for i, x in enumerate(self.rows)]
        joint = Joint(-1.5, 1.5, 2.0, (0, 1, 0))
        starts = ((-0.045, 0.05, 0.0), (0.07, 0.05, 0.0))
        tools = [
            Tool(
                self.grasper(name, at, port), at, (-0.07, 0.006, -0.05), (0.11, 0.08, 0.05), port=port, joints=(joint,)
            )
            for name, at, port in zip(("left grasper", "right grasper"), starts, self.ports)
        ]
        end, length = -0.031, (0.1, 0.1, 0.15)[self.difficulty]
        self.rope = self.thread(
            "rope",
            [(end, 0.05, 0), (end - length, 0.05, 0)],
            (0.8, 0.75, 0.2),
            spacing=4e-3,
            radius=1e-3,
            young_modulus=3e6,
            friction=0.2,
        )
        for tool in tools:
            tool.grips = self.rope
        return tools

    def _eyelet(self, name: str, place: typing.Any) -> fs.BodyId:
        post = bodies.moved(fs.shapes.cylinder(0.0012, 0.03 - self.ring), (0, -(0.03 + self.ring) / 2, 0))
        surface = bodies.joined(bodies.eyelet(self.ring + self.wire, self.wire), post)
        body = self.sim.add(
            fs.RigidBodyDef(
                name=name,
                elements=[place],
                mesh=surface,
                collision=[fs.CollisionDef(proximity=0.5e-3)],
                friction=0.2,
            )
        )
        self.sim.show(body, material=plain((0.9, 0.3, 0.05), 0.3))
        return body

    def prepare(self) -> None:
        self.places = [np.array([x, 0.03, 0.0]) for x in self.rows]
        self.angles = np.zeros(len(self.eyelets))
        first = self.tools[0]
        self.held = self.sim.attach(self.rope, fs.AttachmentDef(nodes=[3, 4], to=first.body))
        self.sim.step(400)  # the rope comes to rest

    def arrange(self) -> None:
        self.tools[0].grasp = self.held
        count = len(self.eyelets)
        away = self.np_random.uniform((-0.006, -0.012), (0.006, 0.012), (count, 2))
        self.places = [np.array([row + x, 0.03, z]) for row, (x, z) in zip(self.rows, away)]
        self.angles = self.np_random.uniform(-0.4, 0.4, count)
        self.carry(self.tools, (-0.006, 0, -0.006), (0.006, 0.006, 0.006))

    def moves(self) -> dict[fs.BodyId, typing.Any]:
        poses = [posed(at, (np.cos(a / 2), 0, np.sin(a / 2), 0)) for at, a in zip(self.places, self.angles)]
        return {**super().moves(), **dict(zip(self.eyelets, poses))}

    def axis(self, i: int) -> Array:
        """The direction in which the rope is to run through an eyelet."""
        return np.array([np.cos(self.angles[i]), 0.0, -np.sin(self.angles[i])])

    def limit(self, tool: Tool, place: Array) -> Array:
        def away(at: Array, i: int) -> float:
            along = (at - self.places[i]) @ self.axis(i)
            across = float(np.linalg.norm(at - self.places[i] - along * self.axis(i)))
            return float(np.hypot(along, max(across - self.ring - 2 * self.wire, 0.0)))

        for i in range(len(self.eyelets)):
            if away(place, i) < min(self.clearance, away(tool.place, i)):
                return tool.place
        return place

    def passed(self) -> list[float]:
        """How much of the rope [m] is through each eyelet: from its end to the last place where it runs through."""
        places = self.sim.frame[self.rope].positions
        lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1)))
        found = []
        for i, middle in enumerate(self.places):
            along = (places - middle) @ self.axis(i)
            net, last = 0, 0.0
            for k in np.flatnonzero((along[:-1] > 0) != (along[1:] > 0)):
                part = along[k] / (along[k] - along[k + 1])
                if np.linalg.norm(places[k] + part * (places[k + 1] - places[k]) - middle) < self.ring:
                    net += 1 if along[k] > 0 else -1
                    last = lengths[k] + part * (lengths[k + 1] - lengths[k])
            found.append(float(last) if net == 1 else 0.0)
        return found

    def features(self) -> Array:
        places = self.sim.frame[self.rope].positions
        chosen = places[np.linspace(0, len(places) - 1, 8).astype(int)]
        parts = [self.unit(chosen).ravel()]
        for i, length in enumerate(self.passed()):
            parts += [self.unit(self.places[i]), self.axis(i), [min(length / self.wanted, 2.0)]]
        return np.concatenate(parts)

    def judge(self) -> Judgement:
        passed = self.passed()
        done = 0  # eyelets that it runs through in their order: the first has the most rope through it
        while done < len(passed) and passed[done] > 0 and (done == 0 or passed[done - 1] > passed[done]):
            done += 1
        end, count = self.sim.frame[self.rope].positions[0], len(passed)
        away = 0.0 if done == count else distance(end, self.places[done])
        through = passed[-1] if done == count else 0.0
        success = through >= self.wanted
        reward = {
            "eyelets": float(done - count),
            "distance": -10 * away,
            "length": -20 * max(self.wanted - through, 0.0),
            "success": 10.0 * success,
        }
        return Judgement(reward, success, {"eyelets": float(done), "through": through, "distance": away})
