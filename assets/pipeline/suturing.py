"""The instruments of laparoscopic suturing, 5 mm wide: needle driver, pick-ups and suture scissors. They are cut as those of
5 Fr in instruments.py and then enlarged. Sizes: README.md beside this file."""
import numpy as np

from instruments import (BLADE, BLADE_EDGE, BLADE_FOR_COLLISION, JAW, Mouth, PIVOT_BEHIND, TOOL_END, TOOL_LENGTH, TOOL_RADIUS, half_rod,
                         lengthened, mouth, shaft_collision, solid, teeth, writer)
from output import metre, write_json

TIMES = 3.0            # a shaft of 4.98 mm
SCISSORS_LENGTH = 0.7  # blades of suture scissors are short


def larger(vertices):
    return vertices * TIMES


def short_blade(vertices):
    """As `larger`; beyond the end of the tang the blade is shorter."""
    v = np.array(vertices, float)
    beyond = v[:, 2] < -1.0
    v[beyond, 2] = -1.0 + SCISSORS_LENGTH * (v[beyond, 2] + 1.0)
    return larger(v)


def larger_shaft(vertices):
    """As `larger`, but no longer than it was: its end, two rings, stays where it is."""
    v = larger(np.array(vertices, float))
    end = vertices[:, 2] > TOOL_LENGTH - 1.0
    v[end, 2] = vertices[end, 2]
    return v


# Needle driver: short, stout jaws with a fine pattern, flat where they hold the needle.
STOUT = JAW.format(body="""
Cone(10) = {0, 0, -0.9, 0, 0, -2.9, 0.83, 0.62};
Sphere(11) = {0, 0, -3.8, 0.62};
BooleanUnion(1) = { Volume{10}; Delete; } { Volume{11}; Delete; };
""", teeth=teeth(-1.5, -4.2, 0.18, 0.04))

# Pick-ups: long, pointed jaws with teeth at their tips only.
POINTED = JAW.format(body="""
Cone(10) = {0, 0, -0.9, 0, 0, -5.1, 0.83, 0.26};
Sphere(11) = {0, 0, -6.0, 0.26};
BooleanUnion(1) = { Volume{10}; Delete; } { Volume{11}; Delete; };
""", teeth=teeth(-5.0, -6.2, 0.2, 0.06))


def make(folder, report):
    save = writer(folder, report)
    v, faces = lengthened(*solid(TOOL_END, 0.35, 18), PIVOT_BEHIND, TOOL_LENGTH)
    save("shaft.obj", (larger_shaft(v), faces), "shaft of needle driver, pick-ups and suture scissors")
    v, faces = shaft_collision()
    save("shaft_collision.obj", (larger_shaft(v), faces), "that shaft for collision")
    shaft = {"shaft": "shaft.obj", "shaftCollision": "shaft_collision.obj", "radius": float(metre(TIMES * TOOL_RADIUS)),
             "length": float(metre(TOOL_LENGTH))}
    write_json(folder / "instruments.json", {
        "unit": "m",
        "axes": "every instrument points along -z, its shaft lies at +z, +y is up",
        "tools": [mouth(save, shaft, each) for each in (
            Mouth("needle driver", STOUT, half_rod([(-0.6, 0.6), (-1.2, 0.8), (-3.8, 0.62), (-4.38, 0.2)]), 4.42, 35.0, size=larger),
            Mouth("pick ups", POINTED, half_rod([(-0.6, 0.6), (-1.2, 0.79), (-6.0, 0.26), (-6.22, 0.1)]), 6.26, 35.0, size=larger),
            Mouth("suture scissors", BLADE, BLADE_FOR_COLLISION, 6.7, 35.0, BLADE_EDGE, short_blade))]})
