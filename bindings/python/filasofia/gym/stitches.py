"""Tasks that close something with a thread: LigatingLoop, comparable to LapGym's, and Suture."""

from __future__ import annotations

import typing

import numpy as np

import filasofia as fs

from . import bodies
from .environment import STEEL, distance
from .judgement import Judgement
from .threads import BLUE, GREEN, ThreadEnv, plain
from .tool import Array, Joint, Tool, aim, posed, times, turned


class LigatingLoop(ThreadEnv):
    """Put a loop of thread over a vessel, up to a mark, and pull it tight.

    One end of the loop is fixed to the tip of a pusher, the other one runs through the pusher, which turns about a port
    and about its shaft; one more component of the action pulls the thread. Features: eight points of the loop (8, 3),
    the vessel at the mark (3), how much it is constricted of what is wanted (1), how much thread is pulled (1).
    Success: the loop is around the vessel within 4, 3 or 2 mm of the mark, and there the vessel's diameter is 10, 15 or
    20 % smaller than at rest (difficulty).
    Reward: -1 while the loop is not around the vessel, -10 times the distance of the loop from the mark [m], -5 times
    what the constriction lacks, +10 for success.
    """

    eye, looks_at = (0.07, 0.12, 0.07), (0.0, 0.026, 0.004)
    lens = fs.CameraDef(vertical_field_of_view=0.55, near=0.001, exposure=10.8)
    rate = least_rate = 1000  # at 500 Hz a thread that is pulled tight may leave the pusher through its wall
    radius, layer = 0.006, 0.0025  # of the vessel, and of its elements

    def build(self) -> list[Tool]:
        self.table(top=-0.003)
        self.vessel = self.soft(
            "vessel",
            bodies.soft_pipe(0.003, self.radius, 0.045, (12, 18, 1)),
            material=fs.FemMaterial(young_modulus=20e3, poisson_ratio=0.4),
            attachments=[fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, 1e-4, 1)))],
            collision=[fs.CollisionDef(proximity=0.5e-3)],
            friction=0.2,
            look=fs.TissueMaterial(base_color=(0.75, 0.25, 0.2)),
        )
        start, port = (0.0, 0.056, 0.016), (0.0, 0.075, 0.25)
        joints = (Joint(-0.6, 0.6, 1.0, (0, 1, 0)), Joint(0.0, 0.08, 0.06))
        pusher = self._pusher(posed(start, aim(start, port)))
        tool = Tool(pusher, start, (-0.03, 0.012, 0.004), (0.03, 0.07, 0.06), 0.06, port=port, joints=joints)
        self.puller = self.sim.add(fs.RigidBodyDef(name="puller", elements=[self._pull(tool)]))
        self.loop = self.thread(
            "loop",
            self._line(tool),
            (0.35, 0.15, 0.6),
            spacing=1.8e-3,
            radius=0.4e-3,
            young_modulus=80e6,
            friction=0.1,
        )
        mark = bodies.pipe(self.radius, self.radius + 0.2e-3, 0.001, 32)
        self.marked = self.sim.add(fs.RigidBodyDef(name="mark", elements=[(0, 0, 0)], mesh=mark))
        self.sim.show(self.marked, material=fs.UnlitMaterial(color=GREEN), cast_shadows=False)
        return [tool]

    def _pusher(self, pose: fs.Pose) -> fs.BodyId:
        # A round mouth: a thread that is pulled around it does not ride over corners.
        inner, wall = 0.9e-3, 1.1e-3
        turn = np.linspace(-np.pi, 0.0, 9)
        mouth = np.stack([inner + wall / 2 * (1 + np.cos(turn)), wall / 2 * (1 + np.sin(turn))], axis=1)
        tube = bodies.revolved([*mouth, (inner + wall, 0.01), (inner, 0.01)], 24)
        body = self.sim.add(
            fs.RigidBodyDef(
                name="pusher", elements=[pose], mesh=tube, collision=[fs.CollisionDef(proximity=0.2e-3)], friction=0.1
            )
        )
        shaft = bodies.moved(bodies.pipe(inner, inner + wall, 0.16, 24), (0, 0.01, 0))
        for surface in (tube, shaft):
            self.sim.show(body, surface=surface, material=plain((0.85, 0.85, 0.9), 0.4), cast_shadows=False)
        return body

    def _line(self, tool: Tool) -> list[Array]:
        """The thread: fixed beside the pusher's mouth, once around, and into the pusher."""
        angles = np.linspace(0.62 * np.pi, 2.38 * np.pi, 60)
        radius = 0.0125
        circle = [(radius * np.cos(a), -0.006 - radius + radius * np.sin(a), 0) for a in angles]
        line = [(-0.0026, 0.003, 0), (-0.0026, -0.001, 0), *circle, (0, -0.001, 0), (0, 0.014, 0)]
        return [tool.place + turned(tool.turn(), each) for each in line]

    def _pull(self, tool: Tool) -> fs.Pose:
        """Where the end of the thread is, in the pusher."""
        return posed(tool.place + turned(tool.turn(), (0, 0.014 + tool.values[1], 0)), tool.turn())

    def moves(self) -> dict[fs.BodyId, typing.Any]:
        return {**super().moves(), self.puller: self._pull(self.tools[0])}

    def prepare(self) -> None:
        rest = self.sim.frame[self.vessel].positions
        outside = np.hypot(rest[:, 0], rest[:, 2]) > self.radius - 1e-4
        self.rings = []
        for layer in range(6, 14):
            ring = np.flatnonzero(outside & (abs(rest[:, 1] - layer * self.layer) < 1e-4))
            self.rings.append(ring[np.argsort(np.arctan2(rest[ring, 2], rest[ring, 0]))])
        count = len(self.sim.frame[self.loop].positions)
        self.sim.attach(self.loop, fs.AttachmentDef(nodes=[0, 1], to=self.tools[0].body))
        self.sim.attach(self.loop, fs.AttachmentDef(nodes=[count - 2, count - 1], to=self.puller))
        self.sim.step(400)
        self.areas = [self._area(ring) for ring in self.rings]

    def arrange(self) -> None:
        chosen = int(self.np_random.integers(len(self.rings)))
        self.ring, self.area = self.rings[chosen], self.areas[chosen]
        self.put(self.marked, self._middle() - (0, 0.0005, 0))
        self.carry(self.tools, (-0.006, -0.002, -0.003), (0.006, 0.004, 0.006), 20)

    def _area(self, ring: Array) -> float:
        """The area of the vessel's cross-section at nodes around it."""
        x, _, z = self.sim.frame[self.vessel].positions[ring].T
        return 0.5 * abs(float(x @ np.roll(z, -1) - z @ np.roll(x, -1)))

    def _middle(self) -> Array:
        """The middle of the vessel at the mark."""
        return self.sim.frame[self.vessel].positions[self.ring].mean(axis=0)

    def _noose(self) -> Array:
        """The nodes of the loop outside the pusher."""
        places, tool = self.sim.frame[self.loop].positions, self.tools[0]
        outside = (places - tool.place) @ turned(tool.turn(), (0, 1, 0)) < 0
        return places[outside]

    def _around(self, noose: Array) -> bool:
        """Whether the loop, closed by the pusher's mouth, runs around the middle of the vessel."""
        if len(noose) < 3:
            return False
        away = noose - self._middle()
        turn = np.diff(np.unwrap(np.arctan2(away[:, 2], away[:, 0]), period=2 * np.pi))
        whole = turn.sum() + np.angle(np.exp(1j * (np.arctan2(*away[0, [2, 0]]) - np.arctan2(*away[-1, [2, 0]]))))
        top = self.sim.frame[self.vessel].positions[:, 1].max()
        return bool(abs(whole) > np.pi and noose[:, 1].mean() < top)

    def constriction(self) -> float:
        """By how much the vessel's diameter at the mark is smaller than at rest, relative to it."""
        return 1.0 - float(np.sqrt(self._area(self.ring) / self.area))

    def features(self) -> Array:
        noose, tool = self._noose(), self.tools[0]
        places = self.sim.frame[self.loop].positions if len(noose) < 8 else noose
        chosen = places[np.linspace(0, len(places) - 1, 8).astype(int)]
        done = self.constriction() / self.wanted()
        return np.concatenate([self.unit(chosen).ravel(), self.unit(self._middle()), [done, tool.values[1] / 0.08]])

    def wanted(self) -> float:
        """The constriction that counts as success."""
        return (0.1, 0.15, 0.2)[self.difficulty]

    def judge(self) -> Judgement:
        noose, middle = self._noose(), self._middle()
        self.put(self.marked, middle - (0, 0.0005, 0))
        around = self._around(noose)
        centre = noose.mean(axis=0) if len(noose) else self.tools[0].place
        away = abs(float(centre[1] - middle[1])) if around else distance(centre, middle)
        tight = self.constriction()
        near = around and away < (0.004, 0.003, 0.002)[self.difficulty]
        success = near and tight > self.wanted()
        reward = {
            "around": around - 1.0,
            "distance": -10 * away,
            "constriction": -5 * max(self.wanted() - tight * around, 0.0),
            "success": 10.0 * success,
        }
        held = self.sim.frame.attachments
        tension = float(np.linalg.norm(held["force"][held["to"] == self.puller], axis=1).sum())
        measures = {"distance": away, "constriction": tight, "around": float(around), "tension": tension}
        return Judgement(reward, success, measures)


class Suture(ThreadEnv):
    """Drive a curved needle through both edges of a wound at marked places, and draw the thread until it closes.

    A driver holds the needle; it turns about its shaft, and the shaft about a port. It may let the needle go and clamp
    it again wherever it is near: so a stitch is a turn until the tip is out, another grip near the tip, and a pull. The
    other end of the thread is held. Features: the needle's tip, middle and tail (3, 3), both marks (2, 3), whether each
    edge is pierced (2), the gap [cm] (1).
    Success: thread runs through both edges, in at the first mark and out at the second within 2.5, 2 or 1.5 mm of them,
    and at the stitch the edges are within 1.5, 1.2 or 1 mm (difficulty), from 3 mm at rest.
    Reward: -1 for each edge that is not pierced near its mark, -10 times the distance of the tip from the mark where it
    is to go in, or then from that where it is to come out [m], -200 times what the gap is too wide [m], +10 for
    success. Where a needle has several ways through an edge, the one nearest to the mark counts.
    """

    rate = least_rate = 1000  # at 500 Hz the tip may slip into the second edge without piercing it
    eye, looks_at = (0.026, 0.06, 0.044), (0.0, 0.0, 0.0)
    lens = fs.CameraDef(vertical_field_of_view=0.62, near=0.001, exposure=9.8)
    gap, bite, radius, thick = 0.003, 0.0066, 0.008, 0.0004  # of the wound, the stitch, the needle
    port = (0.0, 0.03, 0.16)
    size = (0.016, 0.008, 0.024)  # of an edge

    def build(self) -> list[Tool]:
        self.table(top=-0.0095)
        self.edges = [self._edge("left edge", -1), self._edge("right edge", 1)]
        angles = np.radians(np.linspace(0.0, 180.0, 19))
        self.line = (self.radius * np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)).tolist()
        start = (0.006, 0.0135, 0.0)
        driver = self.grasper("driver", start, self.port)
        roll = Joint(-1.0, 5.0, 3.0, (0, 1, 0))
        tool = Tool(driver, start, (-0.05, -0.002, -0.03), (0.05, 0.05, 0.03), 0.06, port=self.port, joints=(roll,))
        self.needle = self._needle(tool)
        tool.grips = self.needle
        hand = (0.03, 0.012, 0.004)
        forceps = self.grasper("forceps", hand, (0.1, 0.08, 0.06))
        middle, turn = self._hold(tool)
        tail = middle + turned(turn, self.line[-1])
        self.string = self.thread(
            "thread",
            [tail, (tail + hand) / 2 + (0, 0.022, -0.028), hand],
            (0.1, 0.1, 0.5),
            spacing=2e-3,
            radius=0.15e-3,
            young_modulus=50e6,
            straight=False,
            rayleigh=fs.Rayleigh(mass=20),
            friction=0.1,
            attachments=[fs.AttachmentDef(nodes=[0], to=self.needle)],
        )
        self.forceps = forceps
        self.marked = [self.marker(f"mark {i}", color, 0.0007) for i, color in enumerate((BLUE, GREEN))]
        return [tool]

    def _edge(self, name: str, side: int) -> fs.BodyId:
        x = side * (self.gap + self.size[0]) / 2
        outer = fs.Box((-1, -1, -1), (x - self.size[0] / 2 + 1e-4, 1, 1))
        if side > 0:
            outer = fs.Box((x + self.size[0] / 2 - 1e-4, -1, -1), (1, 1, 1))
        return self.block(
            name,
            self.size,
            (6, 3, 6),
            pose=(x, -self.size[1] / 2, 0),
            material=fs.FemMaterial(young_modulus=120e3, poisson_ratio=0.45),
            gravity=False,
            collision=[fs.CollisionDef(proximity=0.3e-3)],
            attachments=[fs.AttachmentDef(box=outer)],
            puncture=fs.PunctureDef(force=0.08, cutting=0.04, friction=4),
            look=fs.TissueMaterial(base_color=(0.75, 0.4, 0.32), wetness=0.3),
        )

    def _hold(self, tool: Tool) -> tuple[Array, Array]:
        """Where a driver that clamps the needle 15 degrees from its tail has the needle's middle, and its turn.

        A driver that turns on leads the tip down, across and up again; it begins 10 degrees above the horizontal.
        """
        angle, turn = np.radians(165.0 + 190.0), np.radians(-190.0)
        middle = -self.radius * np.array([np.cos(angle), 0.0, np.sin(angle)])
        middle, own = turned(tool.turn(), middle), np.array([np.cos(turn / 2), 0.0, np.sin(turn / 2), 0.0])
        return tool.place + middle, times(tool.turn(), own)

    def _needle(self, tool: Tool) -> fs.BodyId:
        body = self.sim.add(
            fs.RigidBodyDef(
                name="needle",
                elements=[posed(*self._hold(tool))],
                mesh=fs.shapes.tube(self.line, self.thick, 8, True),
                dynamic=True,
                linear_damping=5.0,
                angular_damping=5.0,
                collision=[fs.CollisionDef(proximity=0.2e-3)],
                needle=fs.NeedleDef(line=self.line, radius=self.thick),
            )
        )
        self.sim.show(body, material=STEEL)
        return body

    def prepare(self) -> None:
        tool = self.tools[0]
        self.held = self.sim.attach(self.needle, fs.RigidAttachmentDef(to=tool.body))
        last = len(self.sim.frame[self.string].positions) - 1
        self.sim.attach(self.string, fs.AttachmentDef(nodes=[last], to=self.forceps))
        self.tops = [self._top(edge) for edge in self.edges]
        self.sim.step(100)

    def _top(self, edge: fs.BodyId) -> tuple[Array, Array]:
        """The nodes of an edge's upper face, and their places at rest."""
        rest = self.sim.frame[edge].positions
        nodes = np.flatnonzero(rest[:, 1] > -1e-5)
        return nodes, rest[nodes].copy()

    def arrange(self) -> None:
        self.tools[0].grasp = self.held
        z = float(self.np_random.uniform(-0.005, 0.005))
        across = self.np_random.uniform(-0.0006, 0.0006, 2)
        lips = (-self.gap / 2, self.gap / 2)
        self.targets = [
            self._point(i, (x + away, z)) for i, (x, away) in enumerate(zip((-self.bite, self.bite), across))
        ]
        self.lips = [self._point(i, (x, z)) for i, x in enumerate(lips)]
        self.carry(self.tools, (-0.003, 0, -0.003), (0.003, 0.004, 0.003), 20)

    def _point(self, edge: int, place: typing.Any) -> tuple[int, Array, Array]:
        """A point of the upper face of an edge, as an edge and weights of its nodes: bilinear in their grid."""
        nodes, rest = self.tops[edge]
        cells = np.array([np.diff(np.unique(np.round(rest[:, k], 9))).max() for k in (0, 2)])
        weights = np.prod(np.maximum(1.0 - np.abs(rest[:, [0, 2]] - place) / cells, 0.0), axis=1)
        used = weights > 1e-9
        return edge, nodes[used], weights[used] / weights.sum()

    def _at(self, point: tuple[int, Array, Array]) -> Array:
        """Where a point of an edge is now."""
        edge, nodes, weights = point
        return weights @ self.sim.frame[self.edges[edge]].positions[nodes]

    def needle_at(self, angle: float) -> Array:
        """Where the needle's line is now, so many degrees from its tip."""
        pose, a = self.sim.frame[self.needle].poses[0], np.radians(angle)
        return pose[:3] + turned(pose[3:], self.radius * np.array([np.cos(a), 0.0, np.sin(a)]))

    def catch(self, tool: Tool) -> fs.AttachmentId | None:
        """The driver clamps the needle if its line is within reach."""
        away = [np.linalg.norm(self.needle_at(angle) - tool.place) for angle in range(0, 181, 5)]
        return self.sim.attach(self.needle, fs.RigidAttachmentDef(to=tool.body)) if min(away) < self.reach else None

    def _stitch(self) -> tuple[list[float], bool]:
        """How far [m] the needle's ways are from both marks (infinite: none), and whether thread runs in both."""
        away, threaded = [np.inf, np.inf], [False, False]
        for channel in self.sim.frame.channels:
            side = self.edges.index(fs.BodyId(int(channel["tissue"])))
            place = channel["entry"] if side == 0 else channel["end"]
            error = float(np.linalg.norm(place - self._at(self.targets[side])))
            if (side == 0 or channel["through"]) and error < away[side]:
                away[side], threaded[side] = error, int(channel["inside"]) == int(self.string)
        return away, all(threaded)

    def features(self) -> Array:
        line = np.array([self.needle_at(angle) for angle in (0, 90, 180)])
        marks = np.array([self._at(each) for each in self.targets])
        away, _ = self._stitch()
        return np.concatenate(
            [self.unit(line).ravel(), self.unit(marks).ravel(), np.isfinite(away), [self.width() * 100]]
        )

    def width(self) -> float:
        """How wide the wound gapes at the stitch [m]."""
        left, right = (self._at(each) for each in self.lips)
        return float(np.linalg.norm(right - left))

    def judge(self) -> Judgement:
        marks = [self._at(each) for each in self.targets]
        for marker, mark in zip(self.marked, marks):
            self.put(marker, mark + (0, 0.0005, 0))
        away, threaded = self._stitch()
        tolerance = (0.0025, 0.002, 0.0015)[self.difficulty]
        pierced = [each < tolerance for each in away]
        wanted = (0.0015, 0.0012, 0.001)[self.difficulty]
        tip = self.needle_at(0)
        gap = self.width()
        lacks = 0.0 if all(pierced) else distance(tip, marks[pierced[0]])
        success = all(pierced) and threaded and gap < wanted
        reward = {
            "edges": sum(pierced) - 2.0,
            "distance": -10 * lacks,
            "gap": -200 * max(gap - wanted, 0.0),
            "success": 10.0 * success,
        }
        errors = {name: min(each, 1.0) for name, each in zip(("entry_error", "exit_error"), away)}
        return Judgement(reward, bool(success), {"gap": gap, **errors, "threaded": float(threaded)})
