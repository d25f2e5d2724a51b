"""A polyp in the cavity of a uterus. The patient is that of the hysteroscopy trainer, turned with its fundus down."""

from __future__ import annotations

import json
import pathlib
import typing

import numpy as np

import filasofia as fs

from .environment import STEEL, SurgicalEnv, distance
from .judgement import Judgement
from .tool import Array, Tool, aim, posed, times, turned

MESHES = "meshes/hysteroscopy/"
OVER = np.array([0.0, 1.0, 0.0, 0.0])  # about x: the trainer's fundus is up, and its scope comes from below


class HysteroscopicPolypectomy(SurgicalEnv):
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

    eye, looks_at = (0.004, -0.026, 0.058), (0.0, -0.044, 0.0)
    lens = fs.CameraDef(vertical_field_of_view=0.75, near=0.001, exposure=11.0)
    lit = fs.Box((-0.03, -0.075, -0.02), (0.03, 0.0, 0.02))
    os = (0.0, -0.024, 0.0)  #: [m], the inner one, through which the shaft always passes
    reach = 0.003  #: [m], of the jaws
    #: name of the polyp, and its number among the sites of uterus.json
    polyps = (("polyp_pedunculated_8", 182), ("polyp_pedunculated_12", 182), ("polyp_lobed_13", 202))

    def build(self) -> list[Tool]:
        self.sim.set_gravity((0, 0, 0))  # the cavity is full of saline, in which tissue hardly weighs anything
        name, site = self.polyps[self.difficulty]
        uterus, polyps = (
            json.loads(pathlib.Path(fs.asset(MESHES + each)).read_text("utf-8")) for each in ("uterus.json", "polyps.json")
        )
        kind = next(each for each in polyps["polyps"] if each["name"] == name)
        self.axis = np.array([[-each["at"][1], each["halfWidth"], each["halfDepth"]] for each in uterus["centreline"]])
        self.pelvis = self.sim.add(fs.RigidBodyDef(name="pelvis", elements=[(0, 0, 0)]))
        self.uterus = self._uterus()
        at, normal = (turned(OVER, uterus["sites"][site][each]) for each in ("at", "normal"))
        self.base = np.array(kind["base"])
        self.polyp = self.sim.add(
            fs.SoftBodyDef(
                name="polyp",
                mesh=fs.asset(MESHES + name + ".msh"),
                pose=posed(at, aim((0.0, 0.0, 0.0), normal)),
                material=fs.FemMaterial(young_modulus=8e3, poisson_ratio=0.4, tearing_threshold=9e3),
                attachments=[fs.AttachmentDef(nodes=kind["base"], stiffness=40.0, to=self.uterus)],
                collision=[fs.CollisionDef(proximity=1e-4, group=2)],
                rayleigh=fs.Rayleigh(mass=10, stiffness=0.02),
                friction=0.8,
                dynamic_topology=True,
            )
        )
        self.sim.show(
            self.polyp,
            subdivision=1,
            material=fs.MucosaMaterial(base_color=(0.72, 0.2, 0.16), noise_scale=700),
            interior=fs.TissueMaterial(base_color=(0.42, 0.02, 0.015), wetness=1),
        )
        start = (0.0, -0.03, 0.0)
        forceps = self._forceps(start)
        low, high = (-0.014, -0.06, -0.0065), (0.014, -0.006, 0.0065)
        return [Tool(forceps, start, low, high, 0.03, grips=self.polyp, port=(0.0, 0.05, 0.0))]

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
                collision=[fs.CollisionDef(proximity=2e-4, group=1)],
                rayleigh=fs.Rayleigh(mass=5, stiffness=0.02),
                friction=0.05,
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
        self.angle, self.tilt = 0.0, np.zeros(2)
        self.wall, self.pressed, self.hurt = 0.0, 0.0, False
        rest = self.sim.frame[self.polyp].positions
        root = self.rooted = rest[self.base].mean(axis=0)
        away = np.linalg.norm(rest - root, axis=1)
        self.head = np.flatnonzero(away > 0.55 * away.max())  # what forceps may take
        self.sim.step(100)

    def arrange(self) -> None:
        self.wall, self.pressed, self.hurt = 0.0, 0.0, False
        self.angle = float(self.np_random.uniform(-0.35, 0.35))
        self.tilt = self.np_random.uniform(-0.06, 0.06, 2)
        stiff = 8e3 * float(np.exp(self.np_random.uniform(-0.3, 0.3)))
        self.sim.set_tissue(self.polyp, fs.TissueRegion(where=fs.Ball(radius=1.0), young_modulus=stiff))
        self.sim.step(round(0.4 * self.rate), self.moves())

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

    def limit(self, tool: Tool, place: Array) -> Array:
        """Not through the wall: within the cavity as it was made, turned as the uterus is, less 1 mm."""
        moved = self.placed()
        back = np.array(moved.orientation) * (1, -1, -1, -1)
        x, y, z = turned(back, np.asarray(place) - moved.position)
        wide, deep = (np.interp(y, self.axis[::-1, 0], self.axis[::-1, k]) for k in (1, 2))
        out = np.hypot(x / max(wide - 0.001, 1e-3), z / max(deep - 0.001, 1e-3))
        if out <= 1.0:
            return place
        inside = np.array([x / out, y, z / out])
        return turned(np.array(moved.orientation), inside) + moved.position

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
        pelvis = self.placed()
        drawn = float(np.linalg.norm(self.root() - turned(np.array(pelvis.orientation), self.rooted) - pelvis.position))
        self.hurt = self.hurt or self.pressed > 0.2 or drawn > 0.01
        way = max(self.os[1] - float(self.middle()[1]), 0.0)
        away = 0.0 if self.holds(self.tools[0]) else distance(self.tools[0].place, self.middle())
        success = way == 0.0 and not self.hurt
        reward = {"distance": -10 * away, "way": -10 * way, "force": -0.1 * self.wall, "success": 10.0 * success}
        return Judgement(reward, success, {"way": way, "distance": away, "force": self.wall, "drawn": drawn})
