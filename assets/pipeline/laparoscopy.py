"""The instruments of laparoscopy, 5 mm wide: grasper, dissector and scissors, on the shaft of suturing; the laparoscope of
10 mm and the cannula of a trocar. Jaws are cut as those of 5 Fr in instruments.py and then enlarged. Sizes: README.md."""
import numpy as np

from instruments import ALLIGATOR, BLADE, BLADE_EDGE, BLADE_FOR_COLLISION, TOOL_LENGTH, TOOL_RADIUS, Mouth, half_rod, lathe, loft, mouth, writer
from output import metre, write_json
from suturing import POINTED, TIMES, larger

BEND = 0.015          # [1/mm] curvature of the dissector's jaws, to the right; a port of 5 mm lets no more pass
STRAIGHT = 4.0        # [mm] up to here behind the pin they are straight
SCOPE_RADIUS = 5.0    # [mm] a laparoscope of 10 mm
SCOPE_LENGTH = 320.0  # [mm]
CANNULA = (2.7, 3.6, 90.0)  # [mm] inner radius, outer radius, length below its head


def bent(vertices):
    """Both jaws of a Maryland dissector bend to the same side, as parabolas."""
    v = np.array(vertices, float)
    beyond = np.maximum(-v[:, 2] - STRAIGHT, 0.0)
    v[:, 0] += 0.5 * BEND * beyond ** 2
    return v


def scope():
    """Shaft, light post and camera head; its end is flat, whatever the angle of its view."""
    return lathe([(0, 0), (0, 4.4), (0.6, SCOPE_RADIUS), (SCOPE_LENGTH, SCOPE_RADIUS), (SCOPE_LENGTH + 6, 9), (SCOPE_LENGTH + 34, 9),
                  (SCOPE_LENGTH + 40, 17), (SCOPE_LENGTH + 90, 19), (SCOPE_LENGTH + 96, 12), (SCOPE_LENGTH + 96, 0)], 32)


def cannula():
    """A closed sleeve: outside, the end, inside; its origin is where the wall holds it, the body lies at -z."""
    inner, outer, length = CANNULA
    return lathe([(-0.5 * length, 0), (-0.5 * length, outer), (0.5 * length, outer), (0.5 * length + 2, 9), (0.5 * length + 22, 9),
                  (0.5 * length + 22, 0)], 28)


def scope_collision(around=10):
    angle = 2.0 * np.pi * np.arange(around) / around
    return loft([np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(around, z)])
                 for r, z in ((4.2, 0.0), (SCOPE_RADIUS, 1.0), (SCOPE_RADIUS, 40.0), (SCOPE_RADIUS, 160.0), (SCOPE_RADIUS, SCOPE_LENGTH))])


def make(folder, report):
    save = writer(folder, report)
    save("laparoscope.obj", scope(), "a laparoscope of 10 mm with its camera head")
    save("laparoscope_collision.obj", scope_collision(), "its shaft for collision")
    save("cannula.obj", cannula(), "the cannula of a trocar")
    shaft = {"shaft": "../suturing/shaft.obj", "shaftCollision": "../suturing/shaft_collision.obj",
             "radius": float(metre(TIMES * TOOL_RADIUS)), "length": float(metre(TOOL_LENGTH))}
    write_json(folder / "instruments.json", {
        "unit": "m",
        "axes": "every instrument points along -z, its shaft lies at +z, +y is up",
        "laparoscope": {"surface": "laparoscope.obj", "collision": "laparoscope_collision.obj", "radius": float(metre(SCOPE_RADIUS)),
                        "length": float(metre(SCOPE_LENGTH))},
        "cannula": {"surface": "cannula.obj", "origin": "where the abdominal wall holds it"},
        "tools": [mouth(save, shaft, each) for each in (
            Mouth("grasper", ALLIGATOR, half_rod([(-0.6, 0.6), (-1.2, 0.8), (-4.0, 0.65), (-6.6, 0.5), (-7.05, 0.2)]), 7.1, 40.0, size=larger),
            Mouth("dissector", POINTED, half_rod([(-0.6, 0.6), (-1.2, 0.79), (-2.8, 0.62), (-4.4, 0.44), (-6.0, 0.26), (-6.22, 0.1)]), 6.26,
                  40.0, size=larger, shape=bent),
            Mouth("scissors", BLADE, BLADE_FOR_COLLISION, 6.7, 35.0, BLADE_EDGE, larger))]})
