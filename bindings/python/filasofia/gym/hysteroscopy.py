"""A polyp, or a myoma, in the cavity of a uterus: the patients of the hysteroscopy trainer, with the fundus down."""

from __future__ import annotations

import json
import pathlib
import typing

import numpy as np

import filasofia as fs

from . import bodies
from .environment import STEEL, SurgicalEnv, distance
from .judgement import Judgement
from .tool import Array, Joint, Tool, aim, holds_down, posed, times, turned

MESHES = "meshes/hysteroscopy/"
OVER = np.array([0.0, 1.0, 0.0, 0.0])  # about x: the trainer's fundus is up, and its scope comes from below
LOOP = np.array([0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)])  # its arms, +z, become a Tool's shaft, +y; it hangs towards -z


def described(file: str, list_: str, name: str) -> dict[str, typing.Any]:
    """What is known of a growth, by a file of the assets."""
    whole = json.loads(pathlib.Path(fs.asset(MESHES + file)).read_text("utf-8"))
    return next(each for each in whole[list_] if each["name"] == name)


class UterusEnv(SurgicalEnv):
    """What both tasks share: the uterus, seen from the front without its nearer half, which each episode turns and
    tilts about the inner os.
    """

    eye, looks_at = (0.004, -0.026, 0.058), (0.0, -0.044, 0.0)
    lens = fs.CameraDef(vertical_field_of_view=0.75, near=0.001, exposure=11.0)
    lit = fs.Box((-0.03, -0.075, -0.02), (0.03, 0.0, 0.02))
    os = (0.0, -0.024, 0.0)  #: [m], the inner one, through which the shaft always passes
    low, high = (-0.014, -0.06, -0.0065), (0.014, -0.006, 0.0065)  #: [m], of the workspace
    tilts = 0.06  #: [rad], at most, about x and z
    cuttable = False  #: the wall

    def build(self) -> list[Tool]:
        self.sim.set_gravity((0, 0, 0))  # the cavity is full of saline, in which tissue hardly weighs anything
        self.known = json.loads(pathlib.Path(fs.asset(MESHES + "uterus.json")).read_text("utf-8"))
        self.pelvis = self.sim.add(fs.RigidBodyDef(name="pelvis", elements=[(0, 0, 0)]))
        self.uterus = self._uterus()
        return [self.grow()]

    def grow(self) -> Tool:
        """Adds what grows in the uterus; returns the instrument."""
        raise NotImplementedError

    def growth(self, name: str, mesh: typing.Any, base: list[int], site: int, **fields: typing.Any) -> fs.BodyId:
        """Adds what grows at a site of the wall; `look` and `interior` are its materials, `once_cut` whether its pieces
        meet each other, and the other fields those of SoftBodyDef.
        """
        self.at, self.normal = (turned(OVER, self.known["sites"][site][each]) for each in ("at", "normal"))
        self.base = np.array(base)
        look, interior, once_cut = (fields.pop(each) for each in ("look", "interior", "once_cut"))
        body = self.sim.add(
            fs.SoftBodyDef(
                name=name,
                mesh=mesh,
                pose=posed(self.at, aim((0.0, 0.0, 0.0), self.normal)),
                attachments=[fs.AttachmentDef(nodes=base, stiffness=40.0, to=self.uterus)],
                collision=[fs.CollisionDef(proximity=1e-4, group=2, self_once_cut=once_cut)],
                rayleigh=fs.Rayleigh(mass=10, stiffness=0.02),
                dynamic_topology=True,
                **fields,
            )
        )
        self.sim.show(body, subdivision=1, material=look, interior=interior)
        return body

    def carried(self, place: typing.Any) -> Array:
        """Where a place of the uterus, as it was made, is in this episode [m]."""
        placed = self.placed()
        return turned(np.array(placed.orientation), place) + placed.position

    def prepare(self) -> None:
        self.angle, self.tilt = 0.0, np.zeros(2)

    def arrange(self) -> None:
        self.angle = float(self.np_random.uniform(-0.35, 0.35))
        self.tilt = self.np_random.uniform(-self.tilts, self.tilts, 2)

    def _uterus(self) -> fs.BodyId:
        """The wall, held by its ligaments to a pelvis that can be turned; drawn without its nearer half."""
        low, high, out = 0.002, 0.026, 0.009
        sides = [
            ((-1, -high, -1), (1, -low, -out)),
            ((-1, -high, out), (1, -low, 1)),
            ((out, -high, -1), (1, -low, 1)),
            ((-1, -high, -1), (-out, -low, 1)),
            ((0.02, -1, -1), (1, -0.04, 1)),
            ((-1, -1, -1), (-0.02, -0.04, 1)),
        ]
        uterus = self.sim.add(
            fs.SoftBodyDef(
                name="uterus",
                mesh=fs.asset(MESHES + "uterus_1702.msh"),
                pose=posed(np.zeros(3), OVER),
                material=fs.FemMaterial(young_modulus=12e3, poisson_ratio=0.42),
                attachments=[fs.AttachmentDef(box=fs.Box(*each), stiffness=100.0, to=self.pelvis) for each in sides],
                collision=[fs.CollisionDef(proximity=2e-4, group=1, self_once_cut=False)],
                rayleigh=fs.Rayleigh(mass=5, stiffness=0.02),
                friction=0.05,
                dynamic_topology=self.cuttable,
            )
        )
        whole = fs.load_triangle_mesh(fs.asset(MESHES + "uterus_lining.obj"))
        vertices, triangles = np.asarray(whole.vertices), np.asarray(whole.triangles)
        far = vertices[triangles][:, :, 2].min(axis=1) > -0.001  # the trainer's +z is away from the camera
        self.sim.show(
            uterus,
            surface=fs.TriangleMesh(vertices=vertices, triangles=triangles[far]),
            material=fs.MucosaMaterial(base_color=(0.62, 0.17, 0.13), wetness=0.95, noise_scale=850, vessels=0.6),
        )
        return uterus

    def placed(self) -> fs.Pose:
        """Where the pelvis is in this episode, and the uterus with it."""
        turn = np.array([np.cos(self.angle / 2), 0.0, np.sin(self.angle / 2), 0.0])
        x, z = self.tilt / 2
        lean = np.array([1.0, x, 0.0, z]) / np.sqrt(1.0 + x * x + z * z)
        turn = times(lean, turn)
        place = np.asarray(self.os) - turned(turn, self.os)  # about the inner os
        return posed(place, turn)

    def moves(self) -> dict[fs.BodyId, typing.Any]:
        return {**super().moves(), self.pelvis: self.placed()}


class HysteroscopicPolypectomy(UterusEnv):
    """Grasp a polyp in the cavity of a uterus, tear it off its root, and draw it out through the cervix.

    The forceps come through the canal, as a working channel leads them, and turn about the inner os. They clamp what is
    within 3 mm of their tip, and press on the wall. Each episode turns and tilts the uterus, so that the polyp lies
    elsewhere, and has tissue of another stiffness. Difficulty: a polyp of 8 mm, of 12 mm, one with lobes of 13 mm.
    Features: the polyp's middle (3), its root (3), the direction out of the wall there (3), the force on the wall [N].
    Success: the polyp's middle has passed the inner os, 24 mm above the fundus, with the force on the wall never above
    2, 1 or 0.5 N (difficulty) for longer than 0.2 s, and the wall never drawn in by more than 10 mm.
    Reward: -10 times the distance of the forceps from the polyp [m] while they do not hold it, -10 times the polyp's
    way to the os [m], -0.1 times the force on the wall [N], +10 for success.
    """

    reach = 0.003  #: [m], of the jaws
    #: name of the polyp, and its number among the sites of uterus.json
    polyps = (("polyp_pedunculated_8", 182), ("polyp_pedunculated_12", 182), ("polyp_lobed_13", 202))

    def grow(self) -> Tool:
        name, site = self.polyps[self.difficulty]
        kind = described("polyps.json", "polyps", name)
        axis = self.known["centreline"]
        self.axis = np.array([[-each["at"][1], each["halfWidth"], each["halfDepth"]] for each in axis])
        self.polyp = self.growth(
            "polyp",
            fs.asset(MESHES + name + ".msh"),
            kind["base"],
            site,
            material=fs.FemMaterial(young_modulus=8e3, poisson_ratio=0.4, tearing_threshold=9e3),
            friction=0.8,
            once_cut=True,
            look=fs.MucosaMaterial(base_color=(0.72, 0.2, 0.16), noise_scale=700),
            interior=fs.TissueMaterial(base_color=(0.42, 0.02, 0.015), wetness=1),
        )
        start = (0.0, -0.03, 0.0)
        forceps = self._forceps(start)
        return Tool(forceps, start, self.low, self.high, 0.03, grips=self.polyp, port=(0.0, 0.05, 0.0))

    def _forceps(self, start: typing.Any) -> fs.BodyId:
        """A shaft of 5 Fr with two jaws; its tip touches the wall and the polyp."""
        tip = fs.shapes.sphere(0.001)
        body = self.sim.add(
            fs.RigidBodyDef(
                name="forceps",
                elements=[start],
                mesh=tip,
                collision=[fs.CollisionDef(proximity=1e-4, group=each) for each in (1, 2)],
                friction=0.3,
            )
        )
        shaft = fs.shapes.tube([(0, 0.08, 0), (0, 0.003, 0)], 0.00085, 12)
        jaws = [fs.shapes.tube([(0, 0.003, 0), (x, 0.001, 0), (x / 2, -0.001, 0)], 0.0004, 8) for x in (-0.001, 0.001)]
        for surface in (shaft, *jaws):
            self.sim.show(body, surface=surface, material=STEEL, cast_shadows=False)
        return body

    def prepare(self) -> None:
        super().prepare()
        self.wall, self.pressed, self.hurt = 0.0, 0.0, False
        rest = self.sim.frame[self.polyp].positions
        root = self.rooted = rest[self.base].mean(axis=0)
        away = np.linalg.norm(rest - root, axis=1)
        self.head = np.flatnonzero(away > 0.55 * away.max())  # what forceps may take
        self.sim.step(100)

    def arrange(self) -> None:
        super().arrange()
        self.wall, self.pressed, self.hurt = 0.0, 0.0, False
        stiff = 8e3 * float(np.exp(self.np_random.uniform(-0.3, 0.3)))
        self.sim.set_tissue(self.polyp, fs.TissueRegion(where=fs.Ball(radius=1.0), young_modulus=stiff))
        self.sim.step(round(0.4 * self.rate), self.moves())

    def limit(self, tool: Tool, place: Array) -> Array:
        """Not through the wall: within the cavity as it was made, turned as the uterus is, less 1 mm."""
        moved = self.placed()
        back = np.array(moved.orientation) * (1, -1, -1, -1)
        x, y, z = turned(back, np.asarray(place) - moved.position)
        wide, deep = (np.interp(y, self.axis[::-1, 0], self.axis[::-1, k]) for k in (1, 2))
        out = np.hypot(x / max(wide - 0.001, 1e-3), z / max(deep - 0.001, 1e-3))
        if out <= 1.0:
            return place
        return self.carried((x / out, y, z / out))

    def catch(self, tool: Tool) -> fs.AttachmentId | None:
        places = self.sim.frame[self.polyp].positions
        away = np.linalg.norm(places - tool.place, axis=1)
        if np.delete(away, self.base).min() > self.reach:
            return None
        place = tuple(float(each) for each in tool.place)
        return self.sim.attach(
            self.polyp, fs.AttachmentDef(ball=fs.Ball(place, self.reach), to=tool.body, stiffness=200.0)
        )

    def middle(self) -> Array:
        """The median of the nodes that are to come out: crumbs do not move it [m]."""
        return np.median(self.sim.frame[self.polyp].positions[self.head], axis=0)

    def root(self) -> Array:
        return self.sim.frame[self.polyp].positions[self.base].mean(axis=0)

    def features(self) -> Array:
        out = self.middle() - self.root()
        out = out / max(float(np.linalg.norm(out)), 1e-9)
        return np.concatenate([self.unit(self.middle()), self.unit(self.root()), out, [self.wall]])

    def judge(self) -> Judgement:
        contacts = self.sim.frame.contacts
        mine = (contacts["first"] == self.tools[0].body) | (contacts["second"] == self.tools[0].body)
        theirs = (contacts["first"] == self.uterus) | (contacts["second"] == self.uterus)
        self.wall = float(contacts["normal_force"][mine & theirs].sum())
        limit = (2.0, 1.0, 0.5)[self.difficulty]
        self.pressed = self.pressed + self.frame_skip / self.rate if self.wall > limit else 0.0
        drawn = float(np.linalg.norm(self.root() - self.carried(self.rooted)))
        self.hurt = self.hurt or self.pressed > 0.2 or drawn > 0.01
        way = max(self.os[1] - float(self.middle()[1]), 0.0)
        away = 0.0 if self.holds(self.tools[0]) else distance(self.tools[0].place, self.middle())
        success = way == 0.0 and not self.hurt
        reward = {"distance": -10 * away, "way": -10 * way, "force": -0.1 * self.wall, "success": 10.0 * success}
        return Judgement(reward, success, {"way": way, "distance": away, "force": self.wall, "drawn": drawn})


class HysteroscopicMyomectomy(UterusEnv):
    """Shave a myoma off the wall of a uterus with the loop of a resectoscope, chip by chip, and spare the wall.

    The loop's arms come through the canal and turn about the inner os; the loop hangs from them towards the wall, 3 mm
    deep. It moves (3 components), turns about the arms (1), and cuts only while its pedal is pressed (the last
    component presses it above 0.3, and releases it below -0.3). Chips float for half a second. Each episode turns and
    tilts the uterus, so that the myoma lies elsewhere, and has tissue of another stiffness.
    Features: the myoma's root (3), the direction out of the wall there (3), the middle of what is left (3), the bottom
    of the loop (3), the share that is left (1), the pedal (1), the area cut in the wall [cm^2] (1).
    Success: at most 50, 40 or 30 % (difficulty) of what stood out of the wall are left, and at most 30, 20 or 10 mm^2
    of the wall were cut.
    Reward: -1 times the share that is left, -10 times the distance of the loop's bottom from the middle of what is left
    [m], -0.05 times what is new in the wall [mm^2], +10 for success.
    """

    longest = 600
    eye, looks_at = (0.003, -0.036, 0.044), (0.0, -0.044, -0.004)
    tilts = 0.03
    cuttable = True
    site = 195  #: among the sites of uterus.json: one that the camera sees from the front
    floats = 25  #: actions for which a chip is seen
    most_left, most_cut = (0.5, 0.4, 0.3), (30.0, 20.0, 10.0)  #: [-], [mm^2]
    density = 1000.0  #: [kg/m^3]

    def grow(self) -> Tool:
        kind = described("myomas.json", "myomas", "myoma_11")
        mesh = fs.load_tet_mesh(fs.asset(MESHES + "myoma_11.msh"))
        corners = np.asarray(mesh.nodes)[np.asarray(mesh.tetrahedra)]
        a, b, c, d = (corners[:, k] for k in range(4))
        volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
        self.whole = float(volumes[corners[:, :, 1].mean(axis=1) > 0].sum())
        self.myoma = self.growth(
            "myoma",
            mesh,
            kind["base"],
            self.site,
            material=fs.FemMaterial(young_modulus=30e3, poisson_ratio=0.42),
            mass=fs.Density(self.density),
            friction=0.2,
            once_cut=False,
            look=fs.MucosaMaterial(base_color=(0.76, 0.4, 0.34), noise_scale=700, vessels=0.5),
            interior=fs.TissueMaterial(base_color=(0.8, 0.62, 0.54), wetness=1),
        )
        self.sim.burn(self.myoma, fs.BurningDef(depth=5e-4))
        self.loop = fs.WireLoop(self.sim, fs.WireLoopDef(width=4.8e-3, depth=3.1e-3, cutting=20.0, groups=[1, 2]))
        self.depth = self.loop.definition.depth
        roll = Joint(-0.8, 0.8, 2.0, (0.0, 1.0, 0.0))
        # What its jaws are for is the pedal, which any body may be named for.
        return Tool(
            self.loop.body, (0.0, -0.03, 0.0), self.low, self.high, 0.03, self.myoma, self.os, (roll,)
        )

    def prepare(self) -> None:
        super().prepare()
        self.sim.step(100)

    def arrange(self) -> None:
        super().arrange()
        self.pressed, self.removed, self.wall, self.seen = False, 0.0, 0.0, 0
        self.floating: list[tuple[int, int]] = []  # pieces, and the action after which they are gone
        stiff = 30e3 * float(np.exp(self.np_random.uniform(-0.3, 0.3)))
        self.sim.set_tissue(self.myoma, fs.TissueRegion(where=fs.Ball(radius=1.0), young_modulus=stiff))
        self.sim.step(round(0.4 * self.rate), self.moves())

    def moves(self) -> dict[fs.BodyId, typing.Any]:
        tool = self.tools[0]
        return {**super().moves(), self.loop.body: posed(tool.place, times(tool.turn(), LOOP))}

    def _grip(self, tool: Tool, command: float) -> None:
        """Presses or releases the pedal."""
        on = holds_down(self.pressed, command)
        if on != self.pressed:
            self.loop.cut(on)
        self.pressed = on

    def bottom(self) -> Array:
        """The lowest point of the loop [m]."""
        tool = self.tools[0]
        return tool.place + turned(tool.turn(), (0.0, 0.0, -self.depth))

    def out(self) -> Array:
        """The direction out of the wall in this episode."""
        return turned(np.array(self.placed().orientation), self.normal)

    def root(self) -> Array:
        """The place of the wall where it grows, in this episode [m]."""
        return self.carried(self.at)

    def rooted(self) -> Array:
        """The surface of what has not come off (n, 3) [m]."""
        myoma = self.sim.frame[self.myoma]
        piece = bodies.pieces(myoma.boundary, len(myoma.positions))
        nodes = np.unique(myoma.boundary)
        return myoma.positions[nodes[np.isin(piece[nodes], piece[self.base])]]

    def left(self) -> float:
        """The share of what stood out of the wall that has not come off [-]."""
        return max(1.0 - self.removed / self.whole, 0.0)

    def features(self) -> Array:
        places = [self.unit(each) for each in (self.root(), self.rooted().mean(axis=0), self.bottom())]
        return np.concatenate([*places, self.out(), [self.left(), float(self.pressed), self.wall * 1e4]])

    def judge(self) -> Judgement:
        lost = self.wall
        for cut in self.cuts[self.seen :]:
            if cut.rupture.body == self.uterus:
                self.wall += cut.rupture.area
                continue
            for piece in cut.rupture.detached:
                volume = piece.mass / self.density
                if volume < 0.5 * self.whole:  # else the myoma came off as a whole, which no loop does
                    self.removed += volume
                    self.floating.append((piece.piece, self.steps + self.floats))
        self.seen = len(self.cuts)
        for number, until in self.floating:
            if self.steps >= until:
                self.sim.remove_piece(self.myoma, number)
        self.floating = [each for each in self.floating if self.steps < each[1]]
        away = distance(self.bottom(), self.rooted().mean(axis=0))
        new, left = (self.wall - lost) * 1e6, self.left()
        success = left <= self.most_left[self.difficulty] and self.wall * 1e6 <= self.most_cut[self.difficulty]
        reward = {"left": -left, "distance": -10 * away, "wall": -0.05 * new, "success": 10.0 * success}
        return Judgement(reward, success, {"left": left, "wall": self.wall, "distance": away})
