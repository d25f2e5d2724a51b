"""Tasks of laparoscopy: PegTransfer and PatternCutting of the FLS, and ClipAndCut."""

from __future__ import annotations

import typing

import numpy as np

import filasofia as fs

from . import bodies
from .environment import FAR, SurgicalEnv, distance
from .judgement import Judgement
from .tasks import GREEN, YELLOW
from .tool import Array, Joint, Tool


def plain(color: typing.Any) -> fs.TissueMaterial:
    """A dull surface without vessels."""
    return fs.TissueMaterial(
        base_color=color, subsurface_color=color, wetness=0.1, thickness=0, mottling=0, vessels=0, bump=0
    )


def applier(env: SurgicalEnv, start: typing.Any) -> fs.BodyId:
    """Adds a clip applier: a tube through the origin along x is between its legs; its shaft is along +z."""
    body = env.sim.add(fs.RigidBodyDef(name="applier", elements=[start], mesh=fs.shapes.box((0.002,) * 3)))
    for y in (-0.004, 0.004):
        leg = bodies.moved(fs.shapes.box((0.002, 0.0012, 0.014)), (0, y, 0.003))
        env.sim.show(body, surface=leg, material=fs.MetalMaterial(), cast_shadows=False)
    shaft = bodies.moved(fs.shapes.box((0.005, 0.009, 0.05)), (0, 0, 0.035))
    env.sim.show(body, surface=shaft, material=plain((0.05, 0.05, 0.06)), cast_shadows=False)
    return body


class PegTransfer(SurgicalEnv):
    """Take a ring from its peg with the left hand, give it to the right one in the air, put it onto a peg of its side.

    Rings: 1, 1 or 2 (difficulty); from difficulty 1 on, the pegs are drawn. Features: for each ring its place (3), its
    peg (3), and whether it was given (1).
    Success: each ring was given to the right hand at least 12 mm above the board, lies around its peg, and is let go.
    Reward: for each ring that is not there, -1 while it is not given, and -10 times its distance from its peg [m];
    -10 times the distance [m] of the hand that has to take the next ring from it; +10 for success.
    A ring that falls off the board lies on the table below, out of reach, and is lost (measure `lost`): it counts as
    not given and as 0.3 m away, and so do the hands once no other is left. The episode goes on to its last step: as
    each step costs, it would pay to end it.
    """

    eye, looks_at = (0.0, 0.14, 0.13), (0.0, 0.005, 0.0)
    inner, wall, height, peg = 0.0055, 0.0033, 0.007, 0.0013  # [m]
    grip = 20e3  #: [N/m], of each held point: the board, or the other hand, holds against a hard one without bound
    bears = 10.0  #: [N], what a grip bears: more than its hand pulls with
    strength = 5.0  #: [N], of a hand

    def build(self) -> list[Tool]:
        self.table((2.0, 0.1, 2.0), top=-0.01)
        self._fixed("board", fs.shapes.box((0.15, 0.01, 0.1)), (0, -0.005, 0), (0.62, 0.60, 0.53))
        self.pegs = np.array([(side * x, 0.0, z) for side in (-1, 1) for x in (0.03, 0.055) for z in (-0.02, 0.02)])
        post = bodies.moved(fs.shapes.cylinder(self.peg, 0.018, 8), (0, 0.009, 0))
        for i, foot in enumerate(self.pegs):
            self._fixed(f"peg {i}", post, foot, (0.55, 0.55, 0.58))
        ring = bodies.moved(
            bodies.pipe(self.inner, self.inner + self.wall, self.height, 24), (0, -self.height / 2, 0)
        )
        solid = bodies.moved(
            bodies.pipe(self.inner, self.inner + self.wall, self.height, 12), (0, -self.height / 2, 0)
        )
        self.rings = []
        for i in range((1, 1, 2)[self.difficulty]):
            body = self.sim.add(
                fs.RigidBodyDef(
                    name=f"ring {i}",
                    elements=[tuple(self.pegs[i] + (0, self.height / 2 + 0.0006, 0))],
                    mesh=solid,
                    dynamic=True,
                    mass=fs.Density(1100),
                    collision=[fs.CollisionDef()],
                    friction=0.6,
                    linear_damping=2,
                    angular_damping=10,
                )
            )
            self.sim.show(body, surface=ring, material=plain(((0.75, 0.3, 0.06), (0.08, 0.35, 0.55))[i]))
            self.rings.append(body)
        self.marked = [self.marker(f"wanted {i}", GREEN, 0.0025) for i in range(len(self.rings))]
        tools = []
        for x in (-0.05, 0.05):
            start = (x, 0.045, 0.035)
            tip = self.tip(f"hand {x}", start, 0.003)
            low, high = (-0.07, 0.006, -0.04), (0.07, 0.06, 0.05)
            tools.append(Tool(tip, start, low, high, 0.2, grips=self.rings[0], strength=self.strength))
        self.held: list[int | None] = [None, None]
        return tools

    def _fixed(self, name: str, mesh: fs.TriangleMesh, place: typing.Any, color: typing.Any) -> fs.BodyId:
        body = self.sim.add(
            fs.RigidBodyDef(
                name=name, elements=[tuple(place)], mesh=mesh, collision=[fs.CollisionDef()], friction=0.5
            )
        )
        self.sim.show(body, material=plain(color))
        return body

    def prepare(self) -> None:
        self.sim.step(100)  # the rings come to rest

    def arrange(self) -> None:
        right = list(range(4, 8))
        chosen = [4, 6] if self.difficulty == 0 else list(self.np_random.choice(right, len(self.rings), replace=False))
        self.wanted = [self.pegs[chosen[i]] for i in range(len(self.rings))]
        for marker, place in zip(self.marked, self.wanted):
            self.put(marker, place + (0, 0.02, 0))
        self.given = [False] * len(self.rings)
        self.held = [None, None]
        for tool in self.tools:
            self.shift(tool, (-0.004, -0.003, -0.004), (0.004, 0.003, 0.004))

    def ring(self, i: int) -> Array:
        """The middle of a ring [m]."""
        return self.sim.frame[self.rings[i]].poses[0, :3]

    def catch(self, tool: Tool) -> fs.AttachmentId | None:
        contacts = self.sim.frame.contacts
        for i, ring in enumerate(self.rings):
            mine = (contacts["first"] == tool.body) & (contacts["second"] == ring)
            mine |= (contacts["first"] == ring) & (contacts["second"] == tool.body)
            if np.any(mine & (contacts["normal_force"] > 0)):
                self.held[self.tools.index(tool)] = i
                return self.sim.grasp(tool.body, ring, fs.GraspDef(stiffness=self.grip, break_force=self.bears))
        return None

    def has(self, hand: int, ring: int) -> bool:
        """Whether a hand, 0 is the left one, holds a ring."""
        return self.held[hand] == ring and self.holds(self.tools[hand])

    def there(self, i: int) -> bool:
        """Whether a ring lies around its peg."""
        away = self.ring(i) - self.wanted[i]
        return bool(np.hypot(away[0], away[2]) < self.inner and away[1] < 0.012)

    def lost(self, i: int) -> bool:
        """Whether a ring is off the board."""
        return bool(self.ring(i)[1] < 0.0)

    def features(self) -> Array:
        rows = [
            np.concatenate([self.unit(self.ring(i)), self.unit(peg), [float(self.given[i])]])
            for i, peg in enumerate(self.wanted)
        ]
        return np.array(rows)

    def judge(self) -> Judgement:
        done, away, lacking = 0, 0.0, 0.0
        next_: int | None = None
        for i, wanted in enumerate(self.wanted):
            if self.has(0, i) and self.has(1, i) and self.ring(i)[1] > 0.012:
                self.given[i] = True
            if self.given[i] and self.there(i) and not self.has(0, i) and not self.has(1, i):
                done += 1
                continue
            lost = self.lost(i)
            self.given[i] = self.given[i] and not lost
            next_ = i if next_ is None and not lost else next_
            away += FAR if lost else distance(self.ring(i), wanted)
            lacking += not self.given[i]
        success = done == len(self.rings)
        hand = 0.0 if success else FAR
        if next_ is not None:
            taker = 1 if self.given[next_] or self.has(0, next_) else 0
            hand = distance(self.tools[taker].place, self.ring(next_))
        reward = {"given": -lacking, "ring": -10 * away, "hand": -10 * hand, "success": 10.0 * success}
        gone = sum(self.lost(i) for i in range(len(self.rings)))
        measures = {"done": done, "given": sum(self.given), "distance": away, "lost": gone}
        return Judgement(reward, success, {name: float(value) for name, value in measures.items()})


class PatternCutting(SurgicalEnv):
    """Cut a printed circle out of gauze, between its two lines.

    The gauze, 100 x 100 mm, is held by clips at its corners; at difficulty 1 and 2 the front left one is free, and a
    second hand has to hold it. The scissors cut with a vertical edge; one more component of the action turns them.
    Features: what is cut of the circle in 12 sectors (12), eight points of the circle now (8, 3), the share of the disc
    by which the cut deviates (1).
    Success: the disc is out, and deviates by at most 15, 10 or 6 % of its area (difficulty).
    Reward: -0.05 times what is not cut of the circle, -10 times the scissors' distance from the next uncut part of it
    [m], -20 times what is new of the deviation and of ten times the length that is cut inside the lines' band [m],
    +10 for success.
    """

    eye, looks_at = (0.0, 0.135, 0.11), (0.0, 0.0, 0.006)
    lens = fs.CameraDef(vertical_field_of_view=0.7, near=0.001, exposure=11.0)
    side, radius, cells, sectors, band = 0.1, 0.02, 24, 60, 0.005

    def build(self) -> list[Tool]:
        self.table(top=-0.06)  # a disc that was cut out wrongly comes to lie there
        flat = fs.shapes.sheet(self.side, self.side, (self.cells, self.cells))
        places = np.asarray(flat.vertices)
        uv = np.stack([places[:, 0] / self.side + 0.5, 0.5 - places[:, 2] / self.side], axis=1)
        corners = [(-1, -1), (1, -1), (1, 1)] + [(-1, 1)] * (self.difficulty == 0)
        near = self.side / 2 - 0.008
        clips = [
            fs.AttachmentDef(nodes=np.flatnonzero((x * places[:, 0] > near) & (z * places[:, 2] > near)).tolist())
            for x, z in corners
        ]
        self.gauze = self.sim.add(
            fs.SoftBodyDef(
                name="gauze",
                mesh=fs.TriangleMesh(vertices=places, triangles=flat.triangles, uv=uv),
                material=fs.ShellMaterial(
                    young_modulus=200e3, poisson_ratio=0.2, thickness=0.4e-3, bending_scale=30
                ),
                mass=fs.Density(80),
                rayleigh=fs.Rayleigh(8.0, 1e-3),
                attachments=clips,
                collision=[fs.CollisionDef()],
                friction=0.8,
                dynamic_topology=True,
            )
        )
        printed = fs.TextureFile(fs.asset("meshes/laparoscopy/gauze.png"))
        look = plain((0.85, 0.85, 0.8)).replace(base_color_texture=printed, wetness=0)
        self.sim.show(self.gauze, material=look)
        for x, z in corners:
            clip = self.sim.add(
                fs.RigidBodyDef(
                    name=f"clip {x} {z}", elements=[(x * 0.053, 0, z * 0.053)], mesh=fs.shapes.box((0.01, 0.004, 0.01))
                )
            )
            self.sim.show(clip, material=fs.MetalMaterial())
        start = (0.0, 0.004, 0.065)
        edges = [[0, -0.006, 0.0005], [0, -0.006, -0.0005], [0, 0.012, -0.0005], [0, 0.012, 0.0005]]
        scissors = self.blade("scissors", start, edges, (0.0012, 0.018, 0.003), fs.MetalMaterial())
        turn = Joint(-4 * np.pi, 4 * np.pi, 6.0, (0, 1, 0))
        hand = (-0.045, 0.02, 0.06)
        tip = self.tip("hand", hand, 0.003)
        self.marked = self.marker("next", GREEN, 0.0015)
        return [
            Tool(scissors, start, (-0.045, -0.01, -0.045), (0.045, 0.03, 0.07), 0.12, joints=(turn,)),
            Tool(tip, hand, (-0.07, -0.01, 0.02), (-0.02, 0.04, 0.075), 0.1, grips=self.gauze),
        ]

    def prepare(self) -> None:
        self.sim.step(150)  # the gauze comes to rest
        self.corner = self.node(self.gauze, (-self.side / 2 + 0.004, -0.01, self.side / 2 - 0.004))

    def arrange(self) -> None:
        self.seen = -1
        self.cut = np.zeros(self.sectors, dtype=bool)
        self.out, self.deviation, self.beside = False, 0.0, 0.0
        self.shift(self.tools[0], (-0.004, 0.0, -0.003), (0.004, 0.0, 0.003))
        self.shift(self.tools[1], (-0.004, 0.0, -0.004), (0.004, 0.004, 0.004))
        self.rest = self._mesh()[0]
        self._choose()

    def _mesh(self) -> tuple[Array, Array]:
        """Where the nodes are at rest (n, 3), and the triangles (m, 3)."""
        body = self.sim.frame[self.gauze]
        return np.asarray(body.rest), np.asarray(body.boundary)

    def _choose(self) -> None:
        """Eight nodes near the circle."""
        angles = 2 * np.pi * np.arange(8) / 8
        circle = self.radius * np.stack([np.sin(angles), np.cos(angles)], axis=1)
        self.near = [int(((self.rest[:, [0, 2]] - each) ** 2).sum(axis=1).argmin()) for each in circle]

    def at(self, x: float, z: float) -> Array:
        """Where a point of the gauze is now [m]: the nearest triangle's, by its place at rest."""
        rest, triangles = self._mesh()
        a, b, c = (rest[triangles[:, k]][:, [0, 2]] for k in range(3))
        p, q, r = b - a, c - a, np.array([x, z]) - a
        whole = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
        v = (r[:, 0] * q[:, 1] - r[:, 1] * q[:, 0]) / whole
        w = (p[:, 0] * r[:, 1] - p[:, 1] * r[:, 0]) / whole
        best = int(np.argmin(np.maximum.reduce([-v, -w, v + w - 1])))
        weights = np.array([1 - v[best] - w[best], v[best], w[best]])
        return weights @ self.sim.frame[self.gauze].positions[triangles[best]]

    def _look(self) -> None:
        """What has been cut, if that has changed."""
        body = self.sim.frame[self.gauze]
        if body.revision == self.seen:
            return
        self.seen = body.revision
        rest, triangles = self._mesh()
        self.rest = rest
        sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, count = np.unique(sides, axis=0, return_counts=True)
        flat = rest[:, [0, 2]]
        rim = np.abs(flat).max(axis=1) > self.side / 2 - 1e-6
        open_ = edges[(count == 1) & ~(rim[edges[:, 0]] & rim[edges[:, 1]])]
        self.cut[:] = False
        beside = 0.0
        if len(open_):
            steps = np.linspace(0, 1, 9)[:, None, None]
            points = flat[open_[:, 0]] + steps * (flat[open_[:, 1]] - flat[open_[:, 0]])
            away = np.hypot(points[..., 0], points[..., 1])
            on = np.abs(away - self.radius) < self.band
            sector = ((np.arctan2(points[..., 0], points[..., 1]) / (2 * np.pi)) % 1 * self.sectors).astype(int)
            self.cut[sector[on] % self.sectors] = True
            length = np.linalg.norm(flat[open_[:, 0]] - flat[open_[:, 1]], axis=1)
            beside = float(length[away[4] < self.radius - self.band].sum()) / 2
        self.beside = max(self.beside, beside)
        self._measure(flat, triangles)

    def _measure(self, flat: Array, triangles: Array) -> None:
        """Whether the disc is out, and by which area it deviates."""
        piece = bodies.pieces(triangles, len(flat))
        used = np.unique(triangles)
        middle = used[np.hypot(*flat[used].T).argmin()]
        rim = used[np.abs(flat[used]).max(axis=1) > self.side / 2 - 1e-6]
        self.out = bool(np.all(piece[rim] != piece[middle]))
        if not self.out:
            return
        mine = triangles[piece[triangles[:, 0]] == piece[middle]]
        a, b, c = (flat[mine[:, k]] for k in range(3))
        area = 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
        one, two = (each.ravel() for each in np.meshgrid((np.arange(12) + 0.5) / 12, (np.arange(12) + 0.5) / 12))
        u, v = np.where(one + two > 1, 1 - one, one), np.where(one + two > 1, 1 - two, two)
        points = a[:, None] + u[:, None] * (b - a)[:, None] + v[:, None] * (c - a)[:, None]
        inside = (np.hypot(points[..., 0], points[..., 1]) < self.radius).mean(axis=1)
        disc = np.pi * self.radius**2
        self.deviation = float((area * (1 - inside)).sum() + max(0.0, disc - (area * inside).sum())) / disc

    def next(self) -> Array:
        """The next part of the circle to be cut: the front, then on to the right [m]."""
        left = np.flatnonzero(~self.cut)
        angle = 2 * np.pi * ((left[0] if len(left) else 0) + 0.5) / self.sectors
        return self.at(self.radius * np.sin(angle), self.radius * np.cos(angle))

    def features(self) -> Array:
        now = self.sim.frame[self.gauze].positions[self.near]
        sectors = self.cut.reshape(12, -1).mean(axis=1)
        return np.concatenate([sectors, self.unit(now).ravel(), [self.deviation]])

    def judge(self) -> Judgement:
        before = self.deviation + 10 * self.beside
        self._look()
        around = float(self.cut.mean())
        there = self.next()
        self.put(self.marked, there + (0, 0.002, 0))
        success = self.out and self.deviation <= (0.15, 0.1, 0.06)[self.difficulty]
        reward = {
            "uncut": -0.05 * (1 - around),
            "distance": -10 * distance(self.tools[0].place, there),
            "beside": -20 * max(self.deviation + 10 * self.beside - before, 0.0),
            "success": 10.0 * success,
        }
        measures = {"around": around, "deviation": self.deviation, "out": float(self.out), "beside": self.beside}
        return Judgement(reward, success, measures)


class ClipAndCut(SurgicalEnv):
    """Close a vessel with two clips and one, and cut it between them; nothing may leak.

    The vessel runs along x, its inlet is on the left, under 12 kPa. The applier closes a clip where it is whenever its
    last component rises above 0.3, and is ready again below -0.3; it has 5, 4 or 3 clips (difficulty). The scissors cut
    with an edge across the vessel. At difficulty 1 and 2 the vessel is bent.
    Features: nine points of the vessel (9, 3), clips before and after the cut or on both sides of the mark (2), clips
    left (1), whether it is cut (1), what has leaked [ml] (1).
    Success: it is cut, with at least two clips before the cut and one behind it, and less than 0.5, 0.2 or 0.05 ml have
    leaked.
    Reward: -0.3 for each clip that is missing, -10 times the distance of the instrument that is next from the vessel
    [m], -0.5 while it is not cut, -2 times what leaks [ml/s], -1 for each clip that is lost, +10 for success.
    """

    eye, looks_at = (0.0, 0.055, 0.06), (0.0, 0.0, 0.002)
    lens = fs.CameraDef(vertical_field_of_view=0.6, near=0.001, exposure=9.6)
    inner, wall, length = 0.001, 0.0008, 0.044  # [m]
    wanted = ((-0.009, -0.005), (0.008,))  #: [m] x of the clips before and behind the cut
    cut_at = 0.002  #: [m]

    def build(self) -> list[Tool]:
        self.sim.set_gravity((0, 0, 0))  # what would bear the vessel is not there
        x = np.linspace(-self.length / 2, self.length / 2, 45)
        bend = (0.0, 0.003, 0.004)[self.difficulty]
        self.line = np.stack([x, 0 * x, bend * np.cos(2 * np.pi * x / self.length)], axis=1)
        ends = [
            fs.AttachmentDef(box=fs.Box((-1, -1, -1), (-self.length / 2 + 0.001, 1, 1))),
            fs.AttachmentDef(box=fs.Box((self.length / 2 - 0.001, -1, -1), (1, 1, 1))),
        ]
        self.vessel = self.soft(
            "vessel",
            fs.shapes.vessel([tuple(each) for each in self.line], self.inner, self.wall, (8, 1)),
            material=fs.FemMaterial(young_modulus=20e3, poisson_ratio=0.4),
            rayleigh=fs.Rayleigh(20.0, 0.0),
            attachments=ends,
            gravity=False,
            collision=[],
            dynamic_topology=True,
            look=fs.TissueMaterial(base_color=(0.75, 0.25, 0.2)),
        )
        self.sim.bleed(self.vessel, fs.BleedingDef(flux=1e-4))
        self.sim.add_duct(
            self.vessel,
            fs.DuctDef(
                name="vessel",
                path=[tuple(each) for each in self.line],
                radius=self.inner,
                viscosity=3.5e-3,
                inlet_pressure=12e3,
                outlet_pressure=1.3e3,
                inlet_resistance=2.4e10,
                outlet_resistance=2.4e10,
            ),
        )
        drape = self.sim.add(
            fs.RigidBodyDef(name="drape", elements=[(0, -0.02, 0)], mesh=fs.shapes.box((0.2, 0.004, 0.2)))
        )
        self.sim.show(drape, material=plain((0.35, 0.12, 0.10)))
        start = (-0.012, 0.0, 0.03)
        held = applier(self, start)
        self.count = (5, 4, 3)[self.difficulty]
        clips = fs.ClipApplierDef(clips=self.count, targets=[self.vessel], place=(0, 0, 0), clip=fs.ClipDef(closing_force=10))
        self.clips = fs.ClipApplier(self.sim, held, clips)
        place = (self.cut_at, 0.03, 0.0)
        edges = [[0, 0, 0.008], [0, 0, -0.008], [0, 0.02, -0.008], [0, 0.02, 0.008]]
        scissors = self.blade("scissors", place, edges, (0.0008, 0.003, 0.012), fs.MetalMaterial())
        self.marked = [self.marker(f"mark {i}", GREEN if i < 3 else YELLOW, 0.0008) for i in range(4)]
        return [
            Tool(held, start, (-0.018, -0.006, -0.006), (0.018, 0.01, 0.035), 0.08, grips=self.vessel),
            Tool(scissors, place, (-0.015, -0.008, -0.01), (0.015, 0.03, 0.02), 0.08),
        ]

    def prepare(self) -> None:
        frame = self.sim.frame[self.vessel].positions
        self.along = np.linspace(-0.018, 0.018, 9)
        self.around = [np.flatnonzero(np.abs(frame[:, 0] - each) < 2.5e-3) for each in self.along]
        self.marks = [*self.wanted[0], *self.wanted[1], self.cut_at]

    def arrange(self) -> None:
        self.closed, self.missed = False, 0
        for marker, x in zip(self.marked, self.marks):
            self.put(marker, self.at(x) + (0, 0.003, 0))
        self.shift(self.tools[0], (-0.003, -0.001, -0.004), (0.003, 0.001, 0.004))
        self.shift(self.tools[1], (-0.002, -0.004, -0.002), (0.002, 0.0, 0.002))

    def _grip(self, tool: Tool, command: float) -> None:
        if command > 0.3 and not self.closed:
            self.clips.close()
        self.closed = command > 0.3 or (self.closed and command > -0.3)

    def at(self, x: float) -> Array:
        """The middle of the vessel now, where it was at x at rest [m]."""
        points = self.points()
        return np.array([np.interp(x, self.along, points[:, k]) for k in range(3)])

    def points(self) -> Array:
        """Nine points along the middle of the vessel (9, 3) [m]."""
        now = self.sim.frame[self.vessel].positions
        return np.array([now[each].mean(axis=0) for each in self.around])

    def features(self) -> Array:
        points = self.unit(self.points())
        duct = self.sim.duct(self.vessel)
        before, behind = self._count()
        cut = float(duct.state in ("cut", "leaking"))
        counts = np.array([before, behind, self.clips.left]) / self.count
        return np.concatenate([points.ravel(), counts, [cut, duct.lost * 1e6]])

    def _count(self) -> tuple[int, int]:
        """Clips before and behind the cut, or where it is to be."""
        duct = self.sim.duct(self.vessel)
        if duct.state in ("cut", "leaking"):
            return duct.clips_before, duct.clips_after
        places = self.sim.frame.clips["place"]
        before = int((places[:, 0] < self.cut_at).sum())
        return before, len(places) - before

    def judge(self) -> Judgement:
        duct = self.sim.duct(self.vessel)
        before, behind = self._count()
        missing = max(2 - before, 0) + max(1 - behind, 0)
        cut = duct.state in ("cut", "leaking")
        lost = duct.lost * 1e6
        success = cut and missing == 0 and duct.leak == 0 and lost < (0.5, 0.2, 0.05)[self.difficulty]
        tool = self.tools[0 if missing else 1]
        reward = {
            "clips": -0.3 * missing,
            "distance": -10 * distance(tool.place, self.at(float(tool.place[0]))),
            "cut": 0.5 * (cut - 1.0),
            "leak": -2 * duct.leak * 1e6,
            "lost": -1.0 * (self.clips.missed - self.missed),
            "success": 10.0 * success,
        }
        self.missed = self.clips.missed
        measures = {"before": float(before), "behind": float(behind), "leaked": duct.lost, "cut": float(cut)}
        return Judgement(reward, success, measures)
