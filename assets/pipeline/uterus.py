"""The uterus as an implicit shape. Millimetres; the external os is the origin, +y points to the fundus, +z forwards
(anterior), +x to the patient's left. Where each number comes from: README.md beside this file."""
import numpy as np

from implicit import capsule, ellipsoid, smooth_max, smooth_min, steps

INTERNAL_OS = 27.0  # [mm] along y: the narrowest place
CAVITY_TOP = 62.0   # [mm] the fundus seen from inside
LENGTH = 75.0       # [mm] over all
CORNU = np.array([16.0, 61.8, 0.0])  # the left ostium: where the funnel of the cornu becomes the tube

# Half axes of the canal [mm] along x and z at these heights. The first knots lie outside, below the lips.
CANAL_Y = [-6.0, 0.0, 13.0, INTERNAL_OS, 36.0, 44.0]
CANAL_X = [2.2, 2.2, 3.4, 2.2, 3.0, 3.4]
CANAL_Z = [2.0, 2.0, 2.7, 1.8, 2.8, 3.4]


def canal_half_axes(y):
    return steps(y, CANAL_Y, CANAL_X), steps(y, CANAL_Y, CANAL_Z)


def cavity_half_width(y):
    """The sides bend inwards: about 1 mm of lateral indentation."""
    s = np.clip((y - 29.0) / 33.0, 0.0, 1.2)
    return 2.2 + 14.2 * s ** 1.25


def inner(p):
    """Canal, cavity and the two funnels: negative in the hollow."""
    x, y, z = np.abs(p[:, 0]), p[:, 1], p[:, 2]
    # A pillow: within `edge` of the rim it is rounded off, elsewhere `deep` to each side.
    w = cavity_half_width(y)
    top = CAVITY_TOP - 0.6 + 0.6 * (x / 16.0) ** 2
    rim = smooth_min((w - x) * 0.85, top - y, 2.0)
    deep = steps(y, [28.0, 47.0, 75.0], [2.4, 6.5, 6.5])
    edge = deep
    pillow = (np.sqrt((np.maximum(edge - rim, 0.0) / edge) ** 2 + (z / deep) ** 2) - 1.0) * deep
    pillow = smooth_max(pillow, 30.0 - y, 2.0)
    a, b = canal_half_axes(y)
    canal = (np.sqrt((x / a) ** 2 + (z / b) ** 2) - 1.0) * np.minimum(a, b)
    canal = smooth_max(canal, y - 42.0, 3.0)
    q = np.column_stack([x, y, z])
    funnel = capsule(q, (11.5, 58.2, 0.0), CORNU, 2.6, 0.95)
    tube = capsule(q, CORNU, CORNU + np.array([1.2, 0.6, 0.0]), 0.95, 0.75)
    return smooth_min(smooth_min(canal, pillow, 4.0), smooth_min(funnel, tube, 0.5), 2.5)


def outer(p):
    """What the organ looks like from outside, without its hollow."""
    x, y, z = np.abs(p[:, 0]), p[:, 1], p[:, 2]
    body = ellipsoid(p, np.array([0.0, 49.5, -0.8]), np.array([24.5, 25.5, 18.5]))
    narrowing = steps(y, [2.0, 26.0, 40.0], [0.0, 1.6, 0.0])
    r = np.sqrt(x * x + (z * 1.06) ** 2) - (13.0 - narrowing)
    rounding = 8.0
    q0, q1 = r + rounding, np.abs(y - 21.0) - 21.0 + rounding  # from y = 0 to 42
    cervix = np.sqrt(np.maximum(q0, 0.0) ** 2 + np.maximum(q1, 0.0) ** 2) + np.minimum(np.maximum(q0, q1), 0.0) - rounding
    horn = capsule(np.column_stack([x, y, z]), (12.0, 57.0, -0.5), (22.8, 63.2, -0.5), 9.0, 3.4)
    return smooth_min(smooth_min(body, cervix, 10.0), horn, 9.0)


LIPS = 3.2  # [mm] how far the edge of the external os is rounded


def wall(p):
    """The tissue: outside shape without the hollow."""
    return smooth_max(outer(p), -inner(p), LIPS)


def mucosa(p):
    """Positive where the surface belongs to the hollow, negative where it is the outside."""
    return outer(p) * -1.0 - inner(p)


def relief(p):
    """How far the lining stands out [mm], for the picture only: palmate folds in the canal, an uneven endometrium."""
    x, y, z = p[:, 0], p[:, 1], p[:, 2]
    angle = np.abs(np.arctan2(x, z) / np.pi)  # 0 in front, 1 behind: the folds rise obliquely from both midlines
    angle = np.minimum(angle, 1.0 - angle)
    window = steps(y, [3.0, 7.0, 22.0, 27.0], [0.0, 1.0, 1.0, 0.0])
    folds = 0.20 * window * np.sin(2.0 * np.pi * (y / 3.4 - 2.6 * angle))
    rough = (np.sin(1.1 * x + 0.5 * y + 1.0) * np.sin(0.9 * y - 0.4 * z) + np.sin(0.8 * z + 0.7 * x) * np.sin(1.3 * y + 2.0)
             + 0.6 * np.sin(2.1 * x - 1.1 * y) * np.sin(1.7 * z + 1.9 * y))
    return folds + 0.10 * steps(y, [26.0, 36.0, 80.0], [0.0, 1.0, 1.0]) * rough


def wall_for_pictures(p):
    side = np.clip(0.5 + mucosa(p) / 8.0, 0.0, 1.0)  # the outside stays smooth
    return wall(p) - side * side * relief(p)


def edge_length(p):
    """Wanted length of edges [mm] of the coarsest mesh: fine in the canal and at the ostia, coarse outside."""
    x, y, z = np.abs(p[:, 0]), p[:, 1], p[:, 2]
    inside = steps(y, [0.0, 27.0, 42.0], [2.2, 2.4, 4.3])
    inside = np.minimum(inside, 1.7 + 0.4 * np.maximum(np.linalg.norm(np.column_stack([x, y, z]) - CORNU, axis=1) - 2.0, 0.0))
    outside = np.minimum(9.0, 2.6 + 0.55 * np.maximum(np.linalg.norm(p, axis=1) - 4.0, 0.0))
    outside = np.minimum(outside, 4.4 + 0.33 * np.linalg.norm(np.column_stack([x, y, z]) - np.array([24.0, 64.0, 0.0]), axis=1))
    s = np.clip(0.5 + mucosa(p) / 8.0, 0.0, 1.0)
    return outside + (inside - outside) * s
