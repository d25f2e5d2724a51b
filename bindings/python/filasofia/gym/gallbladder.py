"""Taking out a gall bladder: off its bed, or the whole operation. The patient is that of the laparoscopy trainer."""

from __future__ import annotations

import typing

import numpy as np

import filasofia as fs

from . import bodies
from .environment import STEEL, SurgicalEnv, distance
from .judgement import Judgement
from .laparoscopy import applier
from .tool import Array, Joint, Tool, aim, holds_down, posed, times, turned

HOOK, APPLIER, SCISSORS = range(3)  #: what the right hand has
ASIDE = np.array([np.sqrt(0.5), -np.sqrt(0.5), 0.0, 0.0])  # a clip applier's shaft, +z, becomes a Tool's, +y


class Tube:
    """Duct or artery, by the rings of its mesh, from the gall bladder on."""

    cut_at = 0.53  #: [-], part of the way where it is to be cut
    wanted = (0.38, 0.68, 0.8)  #: [-], parts where clips are to be: one near the gall bladder, two far from it

    def __init__(self, sim: fs.Simulation, body: fs.BodyId, around: int, along: int, outwards: bool):
        self.sim, self.body, self.along = sim, body, along
        self.outwards = outwards  # what flows in it comes from the gall bladder
        self.rings = np.arange(2 * around * (along + 1)).reshape(along + 1, -1)

    def line(self) -> Array:
        """The middles of its rings (n, 3) [m]."""
        return self.sim.frame[self.body].positions[self.rings].mean(axis=1)

    def at(self, part: float) -> Array:
        """A place in its middle [m]."""
        line = self.line()
        return np.array([np.interp(part * self.along, np.arange(len(line)), line[:, k]) for k in range(3)])

    def clips(self) -> tuple[int, int]:
        """Clips on the gall bladder's side of the cut, or of where it is to be, and beyond."""
        duct = self.sim.duct(self.body)
        if self.is_cut():
            sides = duct.clips_before, duct.clips_after
            return sides if self.outwards else sides[::-1]
        clips = self.sim.frame.clips
        places, line = clips["place"][clips["tissue"] == self.body], self.line()
        nearest = np.linalg.norm(places[:, None] - line, axis=2).argmin(axis=1)
        near = int((nearest < self.cut_at * self.along).sum())
        return near, len(places) - near

    def missing(self) -> int:
        """Clips that are still to be applied: one near the gall bladder, two far from it."""
        near, far = self.clips()
        return max(1 - near, 0) + max(2 - far, 0)

    def is_cut(self) -> bool:
        return self.sim.duct(self.body).state in ("cut", "leaking")

    def lost(self) -> float:
        """What ran out of it [m^3]."""
        return float(self.sim.duct(self.body).lost)


class GallbladderEnv(SurgicalEnv):
    """What both tasks share. Each episode has its own traction and tissue: the fundus is lifted to another place, and
    the gall bladder has another stiffness, so that bed, duct and artery lie elsewhere.
    """

    scene = "scenes/gallbladder.json"
    eye, looks_at = (0.018, -0.04, 0.104), (0.005, 0.003, 0.004)
    lens = fs.CameraDef(vertical_field_of_view=0.8, near=0.001, exposure=10.9)
    lit = fs.Box((-0.06, -0.05, -0.02), (0.06, 0.05, 0.06))
    left_port, right_port = (-0.12, -0.07, 0.15), (0.115, 0.07, 0.15)
    lift, reach = (-0.032, 0.038, 0.015), 0.004  #: [m], where the fundus is held, and how far around

    def build(self) -> list[Tool]:
        ids = {self.sim.definition(body).name: body for body in self.sim.bodies}
        self.liver, self.gallbladder, self.layer = ids["liver"], ids["gallbladder"], ids["layer"]
        self.duct = Tube(self.sim, ids["duct"], 8, 24, True)
        self.artery = Tube(self.sim, ids["artery"], 6, 22, False)
        self.theirs = ids["assistant"]
        self.assistant = self.sim.add(fs.RigidBodyDef(name="other assistant", elements=[self.lift]))
        self.lifted = np.array(self.lift)
        self.pressed = False
        start = (0.05, 0.02, 0.06)
        edges = [[0, -0.0015, 0], [0, -0.0015, -0.0005], [0, 0.0055, -0.0005], [0, 0.0055, 0]]
        points = [(0, 0.16, 0), (0, -0.0005, 0), (0, -0.0015, 0.0012), (0, -0.0015, 0.003)]
        self.hook = self.blade("hook", start, edges, fs.shapes.tube(points, 0.0007, 12), STEEL)
        tip = fs.ElectrodeTip(from_=(0, 0.0035, 0), to=(0, -0.0015, 0))
        self.sim.add_electrode(self.hook, fs.ElectrodeDef(mode="cut", power=30, radius=1.5e-3, tip=tip))
        low, high = (-0.045, -0.04, -0.01), (0.055, 0.045, 0.07)
        # What its jaws are for is the pedal, which any body may be named for.
        right = Tool(self.hook, start, low, high, 0.12, grips=self.gallbladder, port=self.right_port)
        start = (-0.03, -0.02, 0.05)
        jaws = self.grasper("grasper", start, self.left_port)
        low, high = (-0.06, -0.035, -0.01), (0.02, 0.045, 0.08)
        return [Tool(jaws, start, low, high, 0.06, grips=self.gallbladder, port=self.left_port), right]

    @property
    def tubes(self) -> tuple[Tube, Tube]:
        return self.duct, self.artery

    def prepare(self) -> None:
        self.sim.step(round(1.6 * self.rate))  # the scene's own assistant has lifted the fundus
        self.bed = self.sim.attachments(self.gallbladder)[:2]
        held = fs.AttachmentDef(ball=fs.Ball(self.lift, 0.0065), to=self.assistant, stiffness=100.0)
        self.sim.attach(self.gallbladder, held)
        attached = self.sim.frame.attachments
        self.sim.release(fs.AttachmentId(int(attached["id"][attached["to"] == self.theirs][0])))
        self.sim.step()
        points = self.sim.frame.attached_points
        self.all = [int((points["attachment"] == each).sum()) for each in self.bed]
        places = self.sim.frame[self.gallbladder].positions
        end = self.duct.at(0.0)
        axis = (self.holding(1).mean(axis=0) - end) * (1, 1, 0)
        self.neck_nodes = np.argsort(np.linalg.norm(places - end - 0.0095 * axis / np.linalg.norm(axis), axis=1))[:6]

    def draw_neck(self, by: typing.Any) -> None:
        """The left hand goes to the neck, grasps it and draws it aside: where its episodes begin."""
        hand = self.tools[0]
        hand.place = self.neck()
        self.sim.step(50, self.moves())
        self.neck_grasp = self.catch(hand)
        hand.place = hand.place + by
        hand.start = tuple(hand.place)
        self.sim.step(round(0.8 * self.rate), self.moves())

    def arrange(self) -> None:
        self.pressed, self.lost, self.burnt = False, 0.0, 0.0
        self.lifted = np.array(self.lift) + self.np_random.uniform((-0.0015, -0.004, -0.004), (0.004, 0.0015, 0.0015))
        stiff = 25e3 * float(np.exp(self.np_random.uniform(-0.3, 0.3)))
        whole = fs.TissueRegion(where=fs.Ball(radius=1.0), young_modulus=stiff)
        self.sim.set_tissue(self.gallbladder, whole)
        self.tools[1].place = np.array(self.tools[1].start) + self.np_random.uniform(-0.008, 0.008, 3)
        self.sim.step(round(0.2 * self.rate), self.moves())
        points = self.sim.frame.attached_points
        self.joined, self.torn = points["node"][np.isin(points["attachment"], self.bed)], 0

    def moves(self) -> dict[fs.BodyId, typing.Any]:
        return {**super().moves(), self.assistant: tuple(float(each) for each in self.lifted)}

    def catch(self, tool: Tool) -> fs.AttachmentId | None:
        """The grasper clamps the part of the gall bladder that is between its jaws, if there is any."""
        away = np.linalg.norm(self.sim.frame[self.gallbladder].positions - tool.place, axis=1)
        if away.min() > 0.9 * self.reach:
            return None
        ball = fs.Ball(tuple(tool.place), self.reach)
        return self.sim.attach(self.gallbladder, fs.AttachmentDef(ball=ball, to=tool.body, stiffness=150.0))

    def _grip(self, tool: Tool, command: float) -> None:
        if tool is self.tools[0]:
            super()._grip(tool, command)
        else:
            self.press(holds_down(self.pressed, command))

    def press(self, on: bool) -> None:
        """Presses or releases the pedal of the hook."""
        if on != self.pressed:
            self.sim.activate(self.hook, on)
        self.pressed = on

    def neck(self) -> Array:
        """Where the left hand has to grasp [m]."""
        return self.sim.frame[self.gallbladder].positions[self.neck_nodes].mean(axis=0)

    def holding(self, part: int) -> Array:
        """The points of the bed that still hold (n, 3) [m]: 0 is its lower third, 1 the rest."""
        points = self.sim.frame.attached_points
        return points["place"][points["attachment"] == self.bed[part]]

    def share(self, part: int) -> float:
        """What still holds of a part of the bed [-]."""
        return len(self.holding(part)) / max(self.all[part], 1)

    def nearest(self, part: int) -> Array:
        """The point of a part of the bed that holds and is nearest to the right hand [m]; that hand, if none does."""
        held, here = self.holding(part), self.tools[1].place
        return held[np.linalg.norm(held - here, axis=1).argmin()] if len(held) else here

    def away(self, part: int) -> float:
        """How far the right hand is from there [m]."""
        return distance(self.nearest(part), self.tools[1].place)

    def tear(self) -> int:
        """How many points of the bed have let go since the last action that were not at the pressed hook."""
        points = self.sim.frame.attached_points
        now = points["node"][np.isin(points["attachment"], self.bed)]
        gone = np.setdiff1d(self.joined, now)
        self.joined = now
        away = np.linalg.norm(self.sim.frame[self.gallbladder].positions[gone] - self.tools[1].place, axis=1)
        torn = int((away > 0.006).sum()) if self.pressed else len(gone)
        self.torn += torn
        return torn

    def harm(self) -> tuple[dict[str, float], bool]:
        """What is new of blood and bile that are lost, of what is burnt beside, and of the bed that is torn: what it
        costs; and whether burns and tears are few enough.
        """
        blood = self.sim.blood(self.liver).welled + self.sim.blood(self.artery.body).welled
        lost = (blood + self.duct.lost()) * 1e6
        burnt = sum(self.sim.heat(each).burnt for each in (self.liver, *(tube.body for tube in self.tubes))) * 1e6
        costs = {
            "lost": -0.5 * (lost - self.lost),
            "burnt": -0.02 * (burnt - self.burnt),
            "torn": -0.05 * self.tear(),
        }
        self.lost, self.burnt = lost, burnt
        few = self.torn <= (0.4, 0.3, 0.25)[self.difficulty] * sum(self.all) and burnt <= 60
        return costs, few

    def measures(self) -> dict[str, float]:
        """What harm was done: volumes [m^3], areas [m^2], points of the bed."""
        return {"lost": self.lost * 1e-6, "burnt": self.burnt * 1e-6, "torn": float(self.torn)}

    def features(self) -> Array:
        middles = []
        for part in (0, 1):
            held = self.holding(part)
            middles.append(self.unit(held.mean(axis=0) if len(held) else self.neck()))
        fundus = self.sim.frame[self.gallbladder].positions.mean(axis=0)
        numbers = [self.share(0), self.share(1), float(self.pressed), self.lost, self.burnt / 100]
        return np.concatenate([self.unit(self.neck()), self.unit(fundus), *middles, numbers])


class GallbladderDissection(GallbladderEnv):
    """Free a gall bladder from its bed on the liver with a hook; duct and artery are already divided.

    The left hand holds the neck, and draws it (3 components); the last component of the right hand is the hook's
    pedal: the hook cuts, and burns what it touches, only while it is pressed.
    Features: neck (3), middle of the gall bladder (3), middle of what still holds of the lower third of the bed (3) and
    of the rest (3), their shares that hold (2), the pedal (1), blood lost [ml] (1), area burnt beside [cm^2] (1).
    Success: at most 10 % of the lower third hold (difficulty 0), or nothing of the bed (1, 2); at most 60 mm^2 of liver
    are burnt, and at most 40, 30 or 25 % of the points of the bed were torn: let go away from the pressed hook.
    Reward: -1 times the share of the bed that is to be freed and still holds, -10 times the distance of the hook from
    the nearest point that does [m], -0.02 times what is newly burnt [mm^2], -0.5 times what is newly lost [ml], -0.05
    for each point that is torn, +10 for success.
    """

    def prepare(self) -> None:
        super().prepare()
        for tube in self.tubes:
            self.sim.release(self.sim.attachments(tube.body)[0])
        self.sim.release(self.sim.attachments(self.layer)[2])
        self.draw_neck((-0.004, -0.003, 0.003))

    def arrange(self) -> None:
        self.tools[0].grasp = self.neck_grasp
        super().arrange()

    def judge(self) -> Judgement:
        parts = (0,) if self.difficulty == 0 else (0, 1)
        left = sum(len(self.holding(part)) for part in parts) / sum(self.all[part] for part in parts)
        next_ = 0 if self.share(0) > 0.1 or self.difficulty == 0 else 1
        harm, fine = self.harm()
        success = fine and left <= (0.1, 0.0, 0.0)[self.difficulty]
        reward = {"bed": -left, "distance": -10 * self.away(next_), **harm, "success": 10.0 * success}
        return Judgement(reward, success, {"bed": left, **self.measures()})


class Cholecystectomy(GallbladderEnv):
    """Take a gall bladder out of its bed: hook, clips, scissors, and the hook again.

    The left hand has a grasper. The right one has, by a joint that is a number, a hook (about 0), a clip applier with 8
    clips (1) or scissors (2); another joint turns its shaft. Its last component is the hook's pedal, closes a clip
    where the applier is, or closes the scissors, which cut with one blade. At difficulty 0 the left hand holds the neck
    from the start, at 1 and 2 it has to grasp it.
    Features: those of GallbladderDissection (17); five points of the duct and of the artery, from the gall bladder on
    (2, 5, 3); clips near and far of each, of 1 and 2 (4); whether each is cut (2), and the layer between them parted
    (1); clips left (1).
    Success: the layer is parted, duct and artery are cut, each between two clips on the patient's side and one, none of
    them leaks, and nothing of the bed holds; at most 1, 0.5 or 0.2 ml of blood and bile are lost, 60 mm^2 burnt beside,
    and 40, 30 or 25 % of the points of the bed torn; at 2, no clip came before layer and lower third of the bed were
    parted (critical view of safety).
    Reward: -0.5 while the layer is not parted, -1 times the share of the bed that holds, -0.1 for each clip that is
    missing, -0.25 for each of duct and artery that is not cut, -0.2 while the neck is not held, -10 times the distance
    [m] of the hand that is next from its next place, what harm costs in GallbladderDissection, -0.2 for each clip that
    is lost, +10 for success.
    """

    longest = 1000
    count = 8

    def build(self) -> list[Tool]:
        left, right = super().build()
        turn = Joint(-np.pi, np.pi, 4.0, (0, 1, 0))
        right.joints = (turn, Joint(0.0, 2.0, 5.0))
        right.reset()
        self.parked = np.array(self.right_port) * 1.3
        held = applier(self, posed(self.parked, times(aim(self.parked, self.right_port), ASIDE)))
        targets = [tube.body for tube in self.tubes]
        clips = fs.ClipApplierDef(clips=self.count, targets=targets, place=(0, 0, 0), clip=fs.ClipDef(gap=5e-4))
        self.clips = fs.ClipApplier(self.sim, held, clips)
        edges = [[0, -0.002, 0], [0, -0.02, 0], [0, -0.02, -0.0004], [0, -0.002, -0.0018]]
        blade = fs.shapes.tube([(0, -0.02, 0), (0, -0.002, 0), (0, 0.003, 0)], 0.0009, 6, sharp=True)
        cutting = self.blade("scissors", tuple(self.parked), edges, blade, STEEL)
        lower = self.sim.add(fs.RigidBodyDef(name="lower blade", elements=[tuple(self.parked)], mesh=blade))
        shaft = fs.shapes.tube([(0, 0, 0), (0, 0.16, 0)], 0.0022, 16)
        for surface in (blade, shaft):
            self.sim.show(lower, surface=surface, material=STEEL, cast_shadows=False)
        self.right = self.hook, held, cutting, lower
        self.chosen, self.opened = HOOK, 1.0
        return [left, right]

    def prepare(self) -> None:
        super().prepare()
        self.sim.set_cutting(self.right[SCISSORS], False)
        self.rows = [self.sim.definition(self.layer).attachments[i].nodes for i in (0, 1)]
        if self.difficulty == 0:
            self.draw_neck((-0.004, -0.003, 0.003))

    def arrange(self) -> None:
        self.chosen, self.opened, self.seen = HOOK, 1.0, -1
        self.parted = self.viewed = self.begun = False
        self.missed = 0
        if self.difficulty == 0:
            self.tools[0].grasp = self.neck_grasp
        super().arrange()

    def moves(self) -> dict[fs.BodyId, typing.Any]:
        left, right = self.tools
        away = posed(self.parked, aim(self.parked, (0.0, 1.0, 0.0)))
        now = {left.body: left.pose(), self.assistant: tuple(float(each) for each in self.lifted)}
        now.update({body: away for body in self.right})
        turn = right.turn()
        if self.chosen == HOOK:
            now[self.hook] = right.pose()
        elif self.chosen == APPLIER:
            now[self.right[APPLIER]] = posed(right.place, times(turn, ASIDE))
        else:
            pivot = right.place + turned(turn, (0, 0.012, 0))
            for body, angle in zip(self.right[SCISSORS:], (0.8 * self.opened - 0.3, -0.3)):
                now[body] = posed(pivot, times(turn, np.array([np.cos(angle / 2), np.sin(angle / 2), 0, 0])))
        return now

    def _grip(self, tool: Tool, command: float) -> None:
        if tool is self.tools[1]:
            chosen = round(float(tool.values[1]))
            if chosen != self.chosen:  # it takes another instrument, with its pedal and jaws open
                self.press(False)
                self.chosen, self.opened = chosen, 1.0
                return
        super()._grip(tool, command)
        self.opened = float(np.clip(self.opened + (-0.25 if self.pressed else 0.25), 0.0, 1.0))

    def press(self, on: bool) -> None:
        if self.chosen == HOOK:
            super().press(on)
        elif on != self.pressed:
            if self.chosen == SCISSORS:
                self.sim.set_cutting(self.right[SCISSORS], on)
            elif on:
                self.close()
            self.pressed = on

    def close(self) -> None:
        """Closes a clip; with the first one it counts what is to be seen."""
        if not self.begun:
            self.begun, self.viewed = True, self.parted and self.share(0) <= 0.1
        self.clips.close()

    def is_parted(self) -> bool:
        """Whether the layer is in two pieces, one at the artery and one at the duct."""
        body = self.sim.frame[self.layer]
        if not self.parted and body.revision != self.seen:
            self.seen = body.revision
            piece = bodies.pieces(np.asarray(body.boundary), len(body.positions))
            sides = [np.bincount(piece[row]).argmax() for row in self.rows]
            self.parted = bool(sides[0] != sides[1])
        return self.parted

    def middle(self) -> Array:
        """A line in the layer, between duct and artery (11, 3) [m]."""
        parts = np.linspace(0.07, 0.95, 11)
        return np.array([sum(tube.at(part) for tube in self.tubes) / 2 for part in parts])

    def next(self) -> tuple[Tool, Array]:
        """Which hand has to go where next [m]."""
        left, right = self.tools
        if not self.holds(left):
            return left, self.neck()
        if not self.parted:
            line = self.middle()
            return right, line[np.linalg.norm(line - right.place, axis=1).argmin()]
        if self.share(0) > 0.1:
            return right, self.nearest(0)
        for tube in self.tubes:
            if tube.missing():
                near, far = tube.clips()
                return right, tube.at(tube.wanted[0 if near == 0 else 1 + min(far, 1)])
        for tube in self.tubes:
            if not tube.is_cut():
                return right, tube.at(tube.cut_at)
        return right, self.nearest(0 if self.share(0) > 0 else 1)

    def features(self) -> Array:
        tubes = [self.unit(tube.at(part)) for tube in self.tubes for part in np.linspace(0.05, 0.95, 5)]
        numbers: list[float] = []
        for tube in self.tubes:
            near, far = tube.clips()
            numbers += [near, far / 2, tube.is_cut()]
        numbers += [self.parted, self.clips.left / self.count]
        return np.concatenate([super().features(), *tubes, numbers])

    def judge(self) -> Judgement:
        parted = self.is_parted()
        bed = sum(len(self.holding(part)) for part in (0, 1)) / sum(self.all)
        missing = sum(tube.missing() for tube in self.tubes)
        uncut = sum(not tube.is_cut() for tube in self.tubes)
        leak = sum(self.sim.duct(tube.body).leak for tube in self.tubes if tube.is_cut())
        harm, fine = self.harm()
        fine = fine and self.lost <= (1.0, 0.5, 0.2)[self.difficulty] and (self.viewed or self.difficulty < 2)
        success = fine and parted and missing == uncut == bed == leak == 0
        tool, there = self.next()
        reward = {
            "layer": 0.5 * (parted - 1.0),
            "bed": -bed,
            "clips": -0.1 * missing,
            "cut": -0.25 * uncut,
            "held": 0.2 * (self.holds(self.tools[0]) - 1.0),
            "distance": -10 * distance(tool.place, there),
            "missed": -0.2 * (self.clips.missed - self.missed),
            **harm,
            "success": 10.0 * success,
        }
        self.missed = self.clips.missed
        now = {"bed": bed, "parted": parted, "clips": 6 - missing, "cut": 2 - uncut, "viewed": self.viewed}
        return Judgement(reward, success, {**{name: float(each) for name, each in now.items()}, **self.measures()})
