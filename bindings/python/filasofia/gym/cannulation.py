"""A catheter that is led into a duct through an opening in its wall."""

from __future__ import annotations

import typing

import numpy as np

import filasofia as fs

from . import bodies
from .environment import distance
from .judgement import Judgement
from .threads import ThreadEnv, plain
from .tool import Array, Tool, posed

STEEP = np.pi / 6  # slope of the introducer


class Cannulation(ThreadEnv):
    """Lead a catheter through an opening into a duct of soft tissue, and advance it to a depth.

    The catheter lies in an introducer that points to the opening; friction keeps it there. The grasper turns about a
    port, clamps the catheter and lets it go, and does not come nearer to the duct's axis than 8 mm. Difficulty: a wide
    duct and one stroke, a narrow one and two strokes, and the catheter has to be let go. Features: five points of the
    catheter (5, 3), the middle of the opening (3), the duct's axis (3), the depth over the wanted one (1).
    Success: the tip is 8, 15 or 15 mm beyond the opening (difficulty), with all of the catheter between them in the
    duct; at 2 also at most 20 mm, and let go.
    Reward: -10 times the distance of the tip from the opening while it is outside, -20 times what the depth lacks or
    has too much [m], -0.1 at 2 while the catheter is held there, +10 for success.
    """

    eye, looks_at = (-0.005, 0.165, 0.085), (-0.005, 0.03, 0.0)
    lens = fs.CameraDef(vertical_field_of_view=0.7, near=0.001, exposure=11.0)
    height, port = 0.022, (-0.06, 0.22, 0.09)
    wall, length, before, opening = 0.0012, 0.05, 0.01, 0.006
    catheter_radius, spacing = 0.8e-3, 1.5e-3
    clearance = 0.008

    def build(self) -> list[Tool]:
        self.inner = (0.004, 0.003, 0.003)[self.difficulty]
        self.wanted = (0.008, 0.015, 0.015)[self.difficulty]
        self.most = 0.02 if self.difficulty == 2 else np.inf
        self.table()
        self.foot = self._posts()
        self.duct = self.soft(
            "duct",
            self._tube(),
            material=fs.FemMaterial(young_modulus=100e3, poisson_ratio=0.4),
            attachments=[
                fs.AttachmentDef(box=fs.Box((low, -1, -1), (low + 1e-3, 1, 1)), to=self.foot)
                for low in (-self.before - 5e-4, self.length - self.before - 5e-4)
            ],
            collision=[fs.CollisionDef(proximity=0.2e-3)],
            rayleigh=fs.Rayleigh(mass=20, stiffness=2e-3),
            friction=0.1,
            look=fs.TissueMaterial(base_color=(0.72, 0.42, 0.3), vessels=0.2),
        )
        tip, mouth, rear, end = (self._line(each) for each in (0.02, 0.056, 0.076, 0.116))
        middle = tuple(float(each) for each in (mouth + rear) / 2)
        turn = np.array([np.cos(np.pi / 4 - STEEP / 2), 0.0, 0.0, np.sin(np.pi / 4 - STEEP / 2)])
        sleeve = bodies.moved(bodies.pipe(0.0013, 0.0022, 0.02, 10), (0, -0.01, 0))
        introducer = self.sim.add(
            fs.RigidBodyDef(
                name="introducer",
                elements=[posed(np.array(middle), turn)],
                mesh=sleeve,
                collision=[fs.CollisionDef(proximity=0.2e-3)],
                friction=2.0,
            )
        )
        self.sim.show(introducer, material=plain((0.55, 0.57, 0.6), 0.3))
        self.catheter = self.thread(
            "catheter",
            [end, tip],
            (0.75, 0.72, 0.6),
            spacing=self.spacing,
            radius=self.catheter_radius,
            young_modulus=15e6,
            friction=0.3,
            collision=fs.RodCollision(proximity=0.2e-3, self=False),
        )
        start = (-0.045, 0.065, 0.02)
        body = self.grasper("grasper", start, self.port)
        return [Tool(body, start, (-0.07, 0.015, -0.03), (0.02, 0.08, 0.04), 0.06, grips=self.catheter, port=self.port)]

    def _line(self, back: float) -> Array:
        """A point of the introducer's line, so far before the opening [m]."""
        return np.array([-back * np.cos(STEEP), self.height + self.inner + back * np.sin(STEEP), 0.0])

    def _tube(self) -> fs.TetMesh:
        """A vessel along x without the cells of the opening, and without the nodes that were only theirs."""
        axis = [(-self.before + 0.002 * i, 0.0, 0.0) for i in range(round(self.length / 0.002) + 1)]
        whole = fs.shapes.vessel(axis, self.inner, self.wall, (12, 1))
        nodes, tetrahedra = np.asarray(whole.nodes), np.asarray(whole.tetrahedra)
        x, y, z = nodes[tetrahedra].mean(axis=1).T
        cut = (abs(np.arctan2(z, y)) < np.pi / 6) & (abs(x) < self.opening / 2)
        used, numbers = np.unique(tetrahedra[~cut], return_inverse=True)
        return fs.TetMesh(nodes=nodes[used] + (0, self.height, 0), tetrahedra=numbers.reshape(-1, 4))

    def _posts(self) -> fs.BodyId:
        """What holds the duct: two posts, and a cap on each end. Its place is that of the opening on the table."""
        outer = self.inner + self.wall
        high = self.height - outer - 5e-4
        cap = bodies.revolved([(0.0, -5e-4), (outer, -5e-4), (outer, 5e-4), (0.0, 5e-4)], 24)
        cap = fs.TriangleMesh(vertices=np.asarray(cap.vertices)[:, [1, 2, 0]], triangles=cap.triangles)
        ends = -self.before, self.length - self.before
        post = fs.shapes.box((0.006, high, 0.011))
        posts = [bodies.moved(post, (x, high / 2, 0)) for x in (ends[0] + 2e-3, ends[1] - 2e-3)]
        caps = [bodies.moved(cap, (x, self.height, 0)) for x in (ends[0] - 8e-4, ends[1] + 8e-4)]
        foot = self.sim.add(
            fs.RigidBodyDef(
                name="posts",
                elements=[(0, 0, 0)],
                mesh=bodies.joined(*posts, *caps),
                collision=[fs.CollisionDef(mesh=bodies.joined(*caps), proximity=0.2e-3)],
            )
        )
        self.sim.show(foot, material=plain((0.16, 0.2, 0.24)))
        return foot

    def moves(self) -> dict[fs.BodyId, typing.Any]:
        turn = np.array([np.cos(self.angle / 2), 0.0, np.sin(self.angle / 2), 0.0])
        return {**super().moves(), self.foot: posed(self.middle, turn)}

    def prepare(self) -> None:
        self.middle, self.angle = np.zeros(3), 0.0
        rest = self.sim.frame[self.duct].positions - (0, self.height, 0)
        lining = np.hypot(rest[:, 1], rest[:, 2]) < self.inner + 1e-4
        places = -self.before + 0.002 * np.arange(round(self.length / 0.002) + 1)
        self.rings = [np.flatnonzero(lining & (abs(rest[:, 0] - x) < 5e-4)) for x in places]
        self.sim.step(300)  # duct and catheter come to rest

    def arrange(self) -> None:
        x, y, z = self.np_random.uniform(-0.003, 0.003, 3)
        self.middle, self.angle = np.array([x, y / 2, z]), float(self.np_random.uniform(-0.12, 0.12))
        self.carry(self.tools, (-0.008, 0, -0.008), (0.008, 0.006, 0.008))

    def axis(self) -> Array:
        """The direction of the duct, from the opening on."""
        return np.array([np.cos(self.angle), 0.0, -np.sin(self.angle)])

    def hole(self) -> Array:
        """The middle of the opening, in the wall."""
        return self.middle + (0, self.height + self.inner, 0)

    def limit(self, tool: Tool, place: Array) -> Array:
        def away(at: Array) -> float:
            out = at - self.middle - (0, self.height, 0)
            along = np.clip(out @ self.axis(), -self.before, self.length - self.before)
            return float(np.linalg.norm(out - along * self.axis()))

        return tool.place if away(place) < min(self.clearance, away(tool.place)) else place

    def depth(self) -> float:
        """How far the tip is beyond the opening [m]; 0 if it is not in the duct, or not through the opening."""
        frame = self.sim.frame
        positions = frame[self.duct].positions
        line = np.array([positions[ring].mean(axis=0) for ring in self.rings])
        points = frame[self.catheter].positions[::-1]
        steps = np.diff(line, axis=0)
        out = points[:, None] - line[:-1]
        parts = np.clip((out * steps).sum(axis=2) / (steps**2).sum(axis=1), 0.0, 1.0)
        gaps = np.linalg.norm(out - parts[..., None] * steps, axis=2)
        nearest = gaps.argmin(axis=1)
        each = np.arange(len(points))
        along = -self.before + 0.002 * (nearest + parts[each, nearest])
        inside = gaps[each, nearest] < self.inner + self.wall / 2
        above = np.flatnonzero(along < self.opening / 2)  # from the tip back to the opening
        last = int(above[0]) + 1 if above.size else len(points)
        return max(float(along[0]), 0.0) if above.size and inside[:last].all() else 0.0

    def features(self) -> Array:
        places = self.sim.frame[self.catheter].positions
        chosen = places[np.linspace(0, len(places) - 1, 5).astype(int)]
        return np.concatenate(
            [self.unit(chosen).ravel(), self.unit(self.hole()), self.axis(), [self.depth() / self.wanted]]
        )

    def judge(self) -> Judgement:
        depth, frame = self.depth(), self.sim.frame
        away = 0.0 if depth > 0 else distance(frame[self.catheter].positions[-1], self.hole())
        contacts = frame.contacts
        mine = (contacts["first"] == self.duct) & (contacts["second"] == self.catheter)
        mine |= (contacts["first"] == self.catheter) & (contacts["second"] == self.duct)
        force = float(contacts["normal_force"][mine].sum())
        wrong = max(self.wanted - depth, depth - self.most, 0.0)
        held = self.difficulty == 2 and wrong == 0 and self.holds(self.tools[0])
        success = wrong == 0 and not held
        reward = {"distance": -10 * away, "depth": -20 * wrong, "held": -0.1 * held, "success": 10.0 * success}
        return Judgement(reward, success, {"depth": depth, "distance": away, "force": force})
