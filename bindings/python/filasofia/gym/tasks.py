"""Tasks without cuts and threads. Places are in metres, forces in newtons, y is up.

Success ends an episode. So a state short of it must not be worth more than the end: rewards of states are penalties, at
most 0, and only success pays. With a reward of +1 for each step with a grasp, the best policy held on just outside the
target for ever, and this is what learning found.
"""

from __future__ import annotations

import numpy as np

import filasofia as fs

from .environment import SurgicalEnv, distance
from .judgement import Judgement
from .tool import Array, Tool

GREEN, BLUE, YELLOW = (0.1, 1.0, 0.2), (0.1, 0.4, 1.0), (1.0, 0.8, 0.1)


class Reach(SurgicalEnv):
    """Bring the tip of an instrument to a point above tissue.

    Features: the target (3).
    Success: the tip is within 5, 3 or 2 mm of it (difficulty 0, 1, 2).
    Reward: -10 times the distance [m], -0.1 times the force on the tissue [N], +10 for success.
    """

    def build(self) -> list[Tool]:
        self.tissue = self.block("tissue", (0.1, 0.02, 0.1), (8, 2, 8))
        start = (0.0, 0.05, 0.0)
        tip = self.tip("tip", start)
        self.marked = self.marker("target", GREEN)
        return [Tool(tip, start, (-0.04, 0.008, -0.04), (0.04, 0.06, 0.04))]

    def arrange(self) -> None:
        low, high = np.array(self.tools[0].low), np.array(self.tools[0].high)
        self.target = self.np_random.uniform(low + 0.008, high)
        self.put(self.marked, self.target)

    def features(self) -> Array:
        return self.unit(self.target)

    def judge(self) -> Judgement:
        away = distance(self.tools[0].place, self.target)
        force = float(self.sim.frame.contacts["normal_force"].sum())
        success = away < (0.005, 0.003, 0.002)[self.difficulty]
        reward = {"distance": -10 * away, "force": -0.1 * force, "success": 10.0 * success}
        return Judgement(reward, success, {"distance": away, "force": force})


class DeflectSpheres(SurgicalEnv):
    """Push one of several elastic posts aside with the instrument, and leave the others alone.

    Posts: 2, 3 or 4 (difficulty). Features: for each post how its top is deflected [cm] (3), its foot (3), and whether
    it is the target (7 numbers for each).
    Success: the target's top is 6 mm from where it stood, and no other one more than 3 mm.
    Reward: -100 times what the target's deflection [m] lacks of 6 mm, -100 times the largest of the others, -10 times
    the distance of the instrument from the target [m], +10 for success.
    """

    eye, looks_at = (0.0, 0.07, 0.12), (0.0, 0.025, 0.0)

    def build(self) -> list[Tool]:
        count = (2, 3, 4)[self.difficulty]
        self.feet = [np.array([0.024 * (i - (count - 1) / 2), 0.0, 0.0]) for i in range(count)]
        stiff = fs.FemMaterial(young_modulus=60e3, poisson_ratio=0.4)
        self.posts = [
            self.block(f"post {i}", (0.006, 0.04, 0.006), (1, 6, 1), pose=(foot[0], 0.02, foot[2]), material=stiff)
            for i, foot in enumerate(self.feet)
        ]
        start = (0.0, 0.035, 0.03)
        tip = self.tip("tip", start)
        self.marked = self.marker("target", BLUE, 0.004)
        return [Tool(tip, start, (-0.06, 0.02, -0.03), (0.06, 0.05, 0.04))]

    def prepare(self) -> None:
        frame = self.sim.frame
        self.tops = [np.argsort(frame[post].positions[:, 1])[-4:] for post in self.posts]
        self.stood = [frame[post].positions[top].mean(axis=0) for post, top in zip(self.posts, self.tops)]

    def arrange(self) -> None:
        self.target = int(self.np_random.integers(len(self.posts)))
        self.put(self.marked, self.feet[self.target] + (0, 0.047, 0))
        self.shift(self.tools[0], (-0.005, -0.005, -0.005), (0.005, 0.005, 0.005))

    def _deflections(self) -> list[Array]:
        frame = self.sim.frame
        tops = [frame[post].positions[top].mean(axis=0) for post, top in zip(self.posts, self.tops)]
        return [top - stood for top, stood in zip(tops, self.stood)]

    def features(self) -> Array:
        rows = [np.concatenate([bend * 100, self.unit(foot)]) for bend, foot in zip(self._deflections(), self.feet)]
        return np.column_stack([np.array(rows), np.arange(len(rows)) == self.target])

    def judge(self) -> Judgement:
        bends = [float(np.linalg.norm(each)) for each in self._deflections()]
        mine = bends.pop(self.target)
        others = max(bends)
        away = distance(self.tools[0].place, self.feet[self.target] + (0, 0.035, 0))
        success = mine > 0.006 and others < 0.003
        reward = {
            "deflection": 100 * min(mine - 0.006, 0.0),
            "others": -100 * others,
            "distance": -10 * away,
            "success": 10.0 * success,
        }
        return Judgement(reward, success, {"deflection": mine, "others": others})


class SearchForPoint(SurgicalEnv):
    """Move an endoscope until a point on the tissue is in the middle of its picture, at a good distance.

    The scope looks straight down. The picture is the scope's; render() shows it, too.
    Features: the point (3).
    Success: the point is within 8, 5 or 3 degrees of the axis (difficulty), 20 to 30 mm away, and the scope has not
    pushed the tissue with more than 0.05 N.
    Reward: -1 times the angle [rad], -10 times the error of the distance [m], -1 times the force [N], +10 for success.
    """

    lens = fs.CameraDef(vertical_field_of_view=1.2, near=0.001, exposure=11.5)

    def build(self) -> list[Tool]:
        self.tissue = self.block("tissue", (0.1, 0.02, 0.1), (8, 2, 8))
        self.hill = self.block("hill", (0.02, 0.015, 0.02), (2, 2, 2), pose=(0, 0.0175, 0))
        start = (0.0, 0.06, 0.0)
        scope = self.tip("scope", start, 0.003)
        self.marked = self.marker("point", GREEN, 0.002)
        return [Tool(scope, start, (-0.04, 0.02, -0.04), (0.04, 0.07, 0.04))]

    def arrange(self) -> None:
        self.target = np.append(self.np_random.uniform(-0.035, 0.035, 2), 0.01)[[0, 2, 1]]
        if np.abs(self.target[[0, 2]]).max() < 0.01:
            self.target[1] = 0.025  # on the hill
        self.put(self.marked, self.target)

    def features(self) -> Array:
        return self.unit(self.target)

    def judge(self) -> Judgement:
        ray = self.target - self.tools[0].place
        away = float(np.linalg.norm(ray))
        angle = float(np.arccos(np.clip(-ray[1] / away, -1, 1)))
        force = float(self.sim.frame.contacts["normal_force"].sum())
        wrong = max(0.02 - away, away - 0.03, 0.0)
        success = angle < np.radians((8, 5, 3)[self.difficulty]) and wrong == 0.0 and force < 0.05
        reward = {"angle": -angle, "distance": -10 * wrong, "force": -force, "success": 10.0 * success}
        return Judgement(reward, success, {"angle": angle, "distance": away, "force": force})

    def view(self) -> fs.Pose:
        eye = self.tools[0].place - (0, 0.0032, 0)  # just below the ball that is the scope
        return fs.look_at(eye, eye - (0, 1, 0), (0, 0, -1))


class TissueManipulation(SurgicalEnv):
    """Pull tissue that is held in the instrument until a landmark on it is at a target.

    Features: the landmark (3), the target (3).
    Success: the landmark is within 3, 2 or 1 mm of the target (difficulty).
    Reward: -100 times the distance [m], +10 for success.
    """

    eye, looks_at = (0.03, 0.06, 0.13), (0.0, 0.04, 0.0)
    hands = 1

    def build(self) -> list[Tool]:
        self.tissue = self.block("tissue", (0.06, 0.05, 0.01), (6, 5, 1), pose=(0, 0.025, 0))
        tools = []
        for x in ((0.0,), (-0.025, 0.025))[self.hands - 1]:
            start = (x, 0.054, 0.0)
            tip = self.tip(f"grasper {x}", start)
            tools.append(Tool(tip, start, (x - 0.015, 0.045, -0.015), (x + 0.015, 0.075, 0.015), 0.05))
        self.marked = [self.marker(f"landmark {i}", YELLOW, 0.002) for i in range(self.hands)]
        self.wanted = [self.marker(f"target {i}", GREEN, 0.002) for i in range(self.hands)]
        return tools

    def prepare(self) -> None:
        self.landmarks = [self.node(self.tissue, (tool.start[0], 0.04, 0.005)) for tool in self.tools]
        for tool in self.tools:
            edge = fs.Box((tool.start[0] - 0.006, 0.0499, -1), (tool.start[0] + 0.006, 1, 1))
            self.sim.attach(self.tissue, fs.AttachmentDef(box=edge, to=tool.body))
        self.sim.step(100)  # it comes to rest

    def _places(self) -> Array:
        return self.sim.frame[self.tissue].positions[self.landmarks]

    def arrange(self) -> None:
        away = self.np_random.uniform((-0.007, 0.002, -0.006), (0.007, 0.009, 0.006), (self.hands, 3))
        self.targets = self._places() + away
        for marker, target in zip(self.wanted, self.targets):
            self.put(marker, target)

    def features(self) -> Array:
        return np.concatenate([self.unit(self._places()), self.unit(self.targets)])

    def judge(self) -> Judgement:
        places = self._places()
        for marker, place in zip(self.marked, places):
            self.put(marker, place + (0, 0, 0.002))
        away = max(distance(place, target) for place, target in zip(places, self.targets))
        success = away < (0.003, 0.002, 0.001)[self.difficulty]
        return Judgement({"distance": -100 * away, "success": 10.0 * success}, success, {"distance": away})


class BimanualTissueManipulation(TissueManipulation):
    """The same with two instruments, which hold two corners, and two landmarks.

    Features: the landmarks (2, 3), the targets (2, 3).
    Success: both landmarks are within 3, 2 or 1 mm of their targets (difficulty).
    Reward: -100 times the larger distance [m], +10 for success.
    """

    hands = 2


class TissueRetraction(SurgicalEnv):
    """Grasp the free edge of a flap of tissue and retract it to a target.

    Features: where to grasp (3), the target (3).
    Success: it is grasped, and the instrument is within 5, 3 or 2 mm of the target (difficulty).
    Reward: -1 and -10 times the distance to the place to grasp, or once it is grasped -10 times the distance to the
    target [m], +10 for success.
    """

    eye, looks_at = (0.07, 0.07, 0.09), (0.0, 0.015, 0.0)

    def build(self) -> list[Tool]:
        self.bed = self.block("bed", (0.08, 0.01, 0.06), (4, 1, 3), pose=(0, -0.005, 0))
        held = fs.AttachmentDef(box=fs.Box((-1, -1, -1), (-0.0249, 1, 1)))
        self.flap = self.block(
            "flap",
            (0.05, 0.004, 0.04),
            (8, 1, 6),
            pose=(0, 0.0025, 0),
            material=fs.FemMaterial(young_modulus=8e3, poisson_ratio=0.4),
            attachments=[held],
            look=fs.TissueMaterial(base_color=(0.9, 0.6, 0.3)),
        )
        start = (0.0, 0.03, 0.0)
        tip = self.tip("grasper", start)
        self.marked = self.marker("target", GREEN)
        return [Tool(tip, start, (-0.03, 0.004, -0.02), (0.035, 0.06, 0.02), grips=self.flap)]

    def prepare(self) -> None:
        self.edge = self.node(self.flap, (0.019, 0.0045, 0.0))
        self.sim.step(50)

    def arrange(self) -> None:
        self.target = self.np_random.uniform((-0.015, 0.02, -0.008), (0.005, 0.035, 0.008))
        self.put(self.marked, self.target)

    def features(self) -> Array:
        return np.concatenate([self.unit(self.sim.frame[self.flap].positions[self.edge]), self.unit(self.target)])

    def judge(self) -> Judgement:
        tool = self.tools[0]
        held = self.holds(tool)
        there = self.target if held else self.sim.frame[self.flap].positions[self.edge]
        away = distance(tool.place, there)
        success = held and away < (0.005, 0.003, 0.002)[self.difficulty]
        reward = {"distance": -10 * away, "grasped": held - 1.0, "success": 10.0 * success}
        return Judgement(reward, success, {"distance": away, "grasped": float(held)})


class PickAndPlace(SurgicalEnv):
    """Grasp a soft cube, carry it to a place on the table, and let go.

    Features: the cube (3), its place (3).
    Success: it is let go, and within 8, 6 or 4 mm of its place (difficulty), lower than 12 mm.
    Reward: -10 times the distance of the instrument from the cube, and -20 times that of the cube from its place [m],
    -0.5 while it is not held, +10 for success.
    """

    eye, looks_at = (0.0, 0.1, 0.12), (0.0, 0.012, 0.0)

    def build(self) -> list[Tool]:
        table = self.sim.add(
            fs.RigidBodyDef(
                name="table",
                elements=[(0, -0.005, 0)],
                mesh=fs.shapes.box((0.3, 0.01, 0.26)),  # what is thrown as far as it goes lies on it
                collision=[fs.CollisionDef()],
                friction=0.8,
            )
        )
        self.sim.show(table, material=fs.TissueMaterial(base_color=(0.1, 0.3, 0.3), wetness=0, vessels=0))
        stiff = fs.FemMaterial(young_modulus=20e3, poisson_ratio=0.4)
        self.cube = self.block(
            "cube", (0.012,) * 3, (2, 2, 2), attachments=[], pose=(-0.03, 0.0065, 0), material=stiff, friction=0.8
        )
        start = (0.0, 0.04, 0.0)
        tip = self.tip("grasper", start)
        self.marked = self.marker("place", GREEN)
        return [Tool(tip, start, (-0.05, 0.01, -0.03), (0.05, 0.06, 0.03), grips=self.cube)]

    def prepare(self) -> None:
        self.sim.step(100)

    def arrange(self) -> None:
        self.target = self.np_random.uniform((0.015, 0.006, -0.02), (0.04, 0.006, 0.02))
        self.put(self.marked, self.target - (0, 0.005, 0))

    def _cube(self) -> Array:
        return self.sim.frame[self.cube].positions.mean(axis=0)

    def features(self) -> Array:
        return np.concatenate([self.unit(self._cube()), self.unit(self.target)])

    def judge(self) -> Judgement:
        tool, cube = self.tools[0], self._cube()
        held = self.holds(tool)
        away = distance(cube[[0, 2]], self.target[[0, 2]])
        success = not held and tool.grasp is None and away < (0.008, 0.006, 0.004)[self.difficulty] and cube[1] < 0.012
        reward = {
            "instrument": -10 * distance(tool.place, cube),
            "cube": -20 * away,
            "held": 0.5 * (held - 1.0),
            "success": 10.0 * success,
        }
        return Judgement(reward, success, {"distance": away, "height": float(cube[1]), "held": float(held)})


class GraspLift(SurgicalEnv):
    """Grasp the gallbladder at its fundus and lift it to show its bed.

    The gallbladder is attached to the liver by half of its length.
    Features: the fundus (3).
    Success: it is held, and its fundus is 12, 15 or 18 mm higher than at rest (difficulty).
    Reward: -10 times the distance of the instrument from the fundus [m], -50 times what the lift [m] lacks (all of it,
    while nothing is held), +10 for success.
    """

    eye, looks_at = (0.08, 0.06, 0.09), (0.008, 0.018, 0.0)

    def build(self) -> list[Tool]:
        self.liver = self.block("liver", (0.08, 0.02, 0.06), (6, 2, 4), material=fs.tissue("liver").material)
        bed = fs.AttachmentDef(box=fs.Box((-1, -1, -1), (0.0001, 0.0106, 1)), to=self.liver)
        self.gallbladder = self.block(
            "gallbladder",
            (0.05, 0.014, 0.016),
            (8, 2, 3),
            pose=(0.01, 0.0175, 0),
            material=fs.FemMaterial(young_modulus=12e3, poisson_ratio=0.45),
            attachments=[bed],
            look=fs.TissueMaterial(base_color=(0.35, 0.55, 0.3)),
        )
        start = (0.02, 0.05, 0.0)
        tip = self.tip("grasper", start)
        return [Tool(tip, start, (-0.03, 0.015, -0.025), (0.045, 0.07, 0.025), grips=self.gallbladder)]

    def prepare(self) -> None:
        self.sim.step(100)
        self.fundus = self.node(self.gallbladder, (0.031, 0.0245, 0))
        self.rest = float(self.sim.frame[self.gallbladder].positions[self.fundus, 1])

    def arrange(self) -> None:
        self.shift(self.tools[0], (-0.008,) * 3, (0.008,) * 3)

    def _fundus(self) -> Array:
        return self.sim.frame[self.gallbladder].positions[self.fundus]

    def features(self) -> Array:
        return self.unit(self._fundus())

    def judge(self) -> Judgement:
        tool, fundus = self.tools[0], self._fundus()
        held = self.holds(tool)
        lift = float(fundus[1]) - self.rest
        wanted = (0.012, 0.015, 0.018)[self.difficulty]
        success = held and lift > wanted
        lacks = max(wanted - lift * held, 0.0)
        reward = {"distance": -10 * distance(tool.place, fundus), "lift": -50 * lacks, "success": 10.0 * success}
        return Judgement(reward, success, {"lift": lift, "held": float(held)})
