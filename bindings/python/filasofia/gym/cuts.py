"""Tasks that cut: PrecisionCutting and PolypRemoval."""

from __future__ import annotations

import numpy as np

import filasofia as fs

from . import bodies
from .environment import SurgicalEnv, distance
from .judgement import Judgement
from .tasks import GREEN, YELLOW
from .tool import Array, Tool


class PrecisionCutting(SurgicalEnv):
    """Cut a sheet of tissue along a line from its front edge, with a blade that stands upright.

    Features: the line's x (1), the end of the line (3), what is cut of it (1), the area beside it [cm^2] (1).
    Success: 90 % of the line are cut, and at most 40, 30 or 20 % as much area beside it, or beyond its end
    (difficulty). Beside it is what is more than 4 mm away: the width of an element. Seen from the side, the line is 40
    segments long and 4 deep; each of these places counts once, if surface that was opened within 4 mm covers it.
    Reward: the fraction that is new in this step, -1 times what is new beside it in relation to the line, -10 times
    the blade's distance from the line [m], +10 for success.
    Measures: cut, the fraction of the line, in [0, 1]; beside [m^2]; pieces, how many came off the sheet: none if only
    the line was cut.
    """

    eye, looks_at = (0.0, 0.09, 0.07), (0.0, 0.0, 0.004)
    thickness, half, corridor = 0.004, 0.03, 0.004
    segments = (40, 4)  #: of the line: along it, and through the sheet

    def build(self) -> list[Tool]:
        frame = [
            fs.AttachmentDef(box=fs.Box((-1, -1, -1), (-0.0299, 1, 1))),
            fs.AttachmentDef(box=fs.Box((0.0299, -1, -1), (1, 1, 1))),
        ]
        self.sheet = self.block(
            "sheet",
            (0.06, self.thickness, 0.06),
            (16, 1, 16),
            material=fs.FemMaterial(young_modulus=20e3, poisson_ratio=0.4),
            attachments=frame,
            collision=[],
            dynamic_topology=True,
        )
        start = (0.0, 0.0, 0.045)
        corners = [[0, -0.01, 0], [0, -0.01, -0.004], [0, 0.03, -0.004], [0, 0.03, 0]]
        knife = self.blade("knife", start, corners, (0.001, 0.03, 0.004), fs.MetalMaterial())
        self.marked = [self.marker(f"line {i}", GREEN, 0.001) for i in range(5)]
        return [Tool(knife, start, (-0.02, -0.001, -0.025), (0.02, 0.02, 0.045), 0.05)]

    def arrange(self) -> None:
        reach = (0.008, 0.012, 0.016)[self.difficulty]
        self.x = float(self.np_random.uniform(-reach, reach))
        self.end = float(self.np_random.uniform(-0.005, 0.01))
        self.done = self.beside = 0.0
        self.opened, self.seen = np.zeros(self.segments[0] * self.segments[1], dtype=bool), -1
        for marker, z in zip(self.marked, np.linspace(self.half, self.end, len(self.marked))):
            self.put(marker, np.array([self.x, self.thickness / 2 + 0.001, z]))

    def features(self) -> Array:
        place = self.unit((self.x, 0.0, self.end))
        return np.array([place[0], *place, self.done, self.beside * 1e4])

    def _look(self) -> None:
        """Marks the places of the line that are opened, if the sheet was cut since the last look."""
        body = self.sim.frame[self.sheet]
        if body.revision == self.seen:
            return
        self.seen = body.revision
        corners = np.asarray(body.rest)[np.asarray(body.boundary)]
        # The faces of the uncut sheet are no part of it: its sides are far away, the others have no area from the side.
        near = np.abs(corners[..., 0].mean(axis=1) - self.x) < self.corridor
        along, deep = ((np.arange(count) + 0.5) / count for count in self.segments)
        z, y = np.meshgrid(self.end + along * (self.half - self.end), (deep - 0.5) * self.thickness)
        self.opened |= bodies.covered(corners[near][..., [2, 1]], np.stack([z.ravel(), y.ravel()], axis=1))

    def _beside(self) -> float:
        """The area that was opened beside the line [m^2]."""
        area = 0.0
        for cut in self.cuts:
            x, _, z = cut.rupture.place
            on = abs(x - self.x) < self.corridor and z > self.end - self.corridor
            area += 0.0 if on else cut.rupture.area
        return area

    def judge(self) -> Judgement:
        self._look()
        line = self.thickness * (self.half - self.end)
        done, beside = float(self.opened.mean()), self._beside()
        gained, lost = done - self.done, (beside - self.beside) / line
        self.done, self.beside = done, beside
        success = done >= 0.9 and beside / line <= (0.4, 0.3, 0.2)[self.difficulty]
        off = abs(float(self.tools[0].place[0]) - self.x)
        reward = {"cut": gained, "beside": -lost, "off": -10 * off, "success": 10.0 * success}
        pieces = float(sum(len(cut.rupture.detached) for cut in self.cuts))
        return Judgement(reward, success, {"cut": done, "beside": beside, "pieces": pieces})


class PolypRemoval(SurgicalEnv):
    """Resect a polyp at its stalk with a loop, under the view of the hysteroscope, and leave the wall alone.

    The loop is a straight wire; it cuts as it moves.
    Features: the polyp's head (3), the stalk (3), the area cut in the wall [cm^2] (1).
    Success: the head has come off, and at most 30, 20 or 10 mm^2 of the wall were cut (difficulty).
    Reward: -10 times the distance of the loop from the stalk [m], -0.05 times what is new in the wall [mm^2], +10 for
    success.
    """

    eye, looks_at = (0.0, 0.04, 0.045), (0.0, 0.008, 0.002)

    def build(self) -> list[Tool]:
        self.polyp = self.sim.add(
            fs.SoftBodyDef(
                name="polyp",
                mesh=_mushroom(),
                material=fs.FemMaterial(young_modulus=10e3, poisson_ratio=0.4),
                attachments=[fs.AttachmentDef(box=fs.Box((-1, -1, -1), (1, 0.0001, 1)))],
                dynamic_topology=True,
            )
        )
        self.sim.show(self.polyp, material=fs.MucosaMaterial())
        start = (0.0, 0.012, 0.02)
        corners = [[-0.008, 0, 0], [0.008, 0, 0], [0.008, 0, 0.012], [-0.008, 0, 0.012]]
        loop = self.blade("loop", start, corners, (0.016, 0.001, 0.001), fs.UnlitMaterial(color=YELLOW))
        return [Tool(loop, start, (-0.01, 0.001, -0.02), (0.01, 0.02, 0.03), 0.05)]

    def prepare(self) -> None:
        self.head = self.node(self.polyp, (0, 0.014, 0))
        self.stalk = self.node(self.polyp, (0, 0.006, 0))

    def arrange(self) -> None:
        self.wall = 0.0
        self.shift(self.tools[0], (-0.003, -0.002, 0), (0.003, 0.004, 0.006))

    def features(self) -> Array:
        places = self.sim.frame[self.polyp].positions
        return np.concatenate([self.unit(places[self.head]), self.unit(places[self.stalk]), [self.wall * 1e4]])

    def judge(self) -> Judgement:
        wall = sum(cut.rupture.area for cut in self.cuts if cut.rupture.place[1] < 0.004)
        off = sum(piece.mass for cut in self.cuts for piece in cut.rupture.detached if not piece.held)
        lost = (wall - self.wall) * 1e6
        self.wall = wall
        success = off > 0.5e-3 and wall * 1e6 < (30, 20, 10)[self.difficulty]
        away = distance(self.tools[0].place, self.sim.frame[self.polyp].positions[self.stalk])
        reward = {"distance": -10 * away, "wall": -0.05 * lost, "success": 10.0 * success}
        return Judgement(reward, success, {"removed": off, "wall": wall})


def _mushroom() -> fs.TetMesh:
    """A wall, 4 mm thick, with a stalk of 4 x 4 x 4 mm and a head of 12 x 8 x 12 mm, of elements of 2 mm; y from 0."""
    grid = fs.shapes.block((0.028, 0.016, 0.028), (14, 8, 14))
    nodes = np.asarray(grid.nodes) + (0, 0.008, 0)
    middle = nodes[np.asarray(grid.tetrahedra)].mean(axis=1)
    x, y, z = np.abs(middle[:, 0]), middle[:, 1], np.abs(middle[:, 2])
    across = np.maximum(x, z)
    inside = (y < 0.004) | ((y < 0.008) & (across < 0.002)) | ((y > 0.008) & (across < 0.006))
    kept = np.asarray(grid.tetrahedra)[inside]
    used, renumbered = np.unique(kept, return_inverse=True)
    return fs.TetMesh(nodes=nodes[used], tetrahedra=renumbered.reshape(-1, 4))
