"""Endometrial polyps and a myoma as implicit shapes. Millimetres; the origin is the middle of the base on the wall, +y points away
from the wall. Each goes ROOT deep into the wall: what lies at y <= 0 is the base, by which it is attached."""
import numpy as np

from implicit import capsule, ellipsoid, smooth_max, smooth_min

ROOT = 1.0  # [mm]


def rooted(f):
    return lambda p: smooth_max(f(p), -ROOT - p[:, 1], 0.8)


def bumpy(f, height, pitch, phase):
    """Knobs on the surface: `height` to each side, `pitch` apart, none near the base."""
    def shape(p):
        k = 2.0 * np.pi / pitch
        x, y, z = (k * p[:, i] + phase * (i + 1) for i in range(3))
        knobs = np.sin(x) * np.sin(y) + np.sin(y + 1.0) * np.sin(z) + np.sin(z + 2.0) * np.sin(x)
        return f(p) - height * knobs / 1.5 * np.clip((p[:, 1] - 1.0) / 3.0, 0.0, 1.0)
    return shape


def sessile(height, half_width):
    """Broad at the wall, no stalk."""
    centre = np.array([0.0, 0.25 * height, 0.0])
    dome = lambda p: ellipsoid(p, centre, np.array([half_width, 0.75 * height, 0.9 * half_width]))
    foot = lambda p: capsule(p, (0.0, -3.0, 0.0), (0.0, 0.2, 0.0), 0.8 * half_width, 0.8 * half_width)
    return rooted(lambda p: smooth_min(dome(p), foot(p), 1.5))


def pedunculated(height, stalk, half_width, lean):
    """A head on a stalk; `lean` is how far the head hangs over to +x."""
    length = 0.38 * height  # of the stalk
    head_half = 0.5 * (height - length) + 0.4
    middle = np.array([lean, height - head_half, 0.0])

    def shape(p):
        head = ellipsoid(p, middle, np.array([half_width, head_half, 0.85 * half_width]))
        rod = capsule(p, (0.0, -3.0, 0.0), (0.6 * lean, length, 0.0), stalk, 0.9 * stalk)
        neck = capsule(p, (0.6 * lean, length, 0.0), middle, 0.9 * stalk, 0.9 * stalk)
        flare = ellipsoid(p, np.array([0.0, -0.8, 0.0]), np.array([1.9 * stalk, 1.6, 1.9 * stalk]))
        return smooth_min(smooth_min(smooth_min(rod, neck, 0.3), head, 1.6), flare, 1.6)
    return rooted(shape)


def lobed(height, stalk, lobes):
    """Several lobes (middle and half axes) on one short stalk."""
    def shape(p):
        parts = capsule(p, (0.0, -3.0, 0.0), (0.0, 0.45 * height, 0.0), stalk, 0.85 * stalk)
        for middle, semi in lobes:
            parts = smooth_min(parts, ellipsoid(p, np.array(middle), np.array(semi)), 1.3)
        return smooth_min(parts, ellipsoid(p, np.array([0.0, -0.8, 0.0]), np.array([1.7 * stalk, 1.6, 1.7 * stalk])), 1.6)
    return rooted(shape)


# name: kind, shape, edge length of the tetrahedra and of the picture [mm], tetrahedra, radius of stalk or foot [mm]
POLYPS = {
    "polyp_sessile_5": ("sessile", bumpy(sessile(5.0, 3.4), 0.12, 3.1, 0.4), 1.9, 0.42, 160, 2.7),
    "polyp_sessile_9": ("sessile", bumpy(sessile(8.0, 5.0), 0.16, 4.6, 1.7), 2.3, 0.55, 280, 4.0),
    "polyp_pedunculated_8": ("pedunculated", bumpy(pedunculated(8.0, 1.1, 2.4, 0.5), 0.07, 3.2, 0.9), 1.5, 0.42, 240, 1.1),
    "polyp_pedunculated_12": ("pedunculated", bumpy(pedunculated(12.0, 1.4, 3.3, 1.2), 0.10, 4.4, 2.1), 1.9, 0.5, 360, 1.4),
    "polyp_pedunculated_18": ("pedunculated", bumpy(pedunculated(18.0, 1.7, 4.3, 2.2), 0.14, 5.5, 3.0), 2.3, 0.65, 500, 1.7),
    "polyp_lobed_13": ("lobed", bumpy(lobed(13.0, 1.8, [((-2.2, 7.2, 0.6), (3.0, 3.6, 2.6)), ((2.3, 8.2, -0.4), (2.9, 4.2, 2.7)),
                                                        ((0.2, 10.6, 1.2), (2.3, 2.5, 2.2))]), 0.10, 3.8, 0.2), 1.9, 0.5, 500, 1.8),
    "polyp_lobed_20": ("lobed", bumpy(lobed(20.0, 2.2, [((-3.0, 9.5, 0.8), (3.6, 5.0, 3.2)), ((3.1, 11.5, -0.6), (3.5, 5.6, 3.3)),
                                                        ((0.0, 16.4, 0.9), (3.2, 3.7, 2.9)), ((0.4, 9.0, 3.0), (2.6, 3.6, 2.2))]),
                                      0.14, 4.8, 1.2), 2.4, 0.65, 560, 2.2),
}

# A submucous myoma on a broad base, a fifth of which is in the wall (type 1 of the FIGO). Its tetrahedra are fine enough for a
# wire loop of 4.8 mm. Edge length and tetrahedra as above.
MYOMAS = {
    "myoma_11": (bumpy(rooted(lambda p: ellipsoid(p, np.array([0.0, -0.3, 0.0]), np.array([5.6, 6.3, 5.3]))), 0.1, 5.0, 0.6), 1.2, 2200),
}
