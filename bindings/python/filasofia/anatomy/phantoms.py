"""Anatomies made of formulas, with known surfaces: for tests, measurements and trying things out. They are no patients."""

from __future__ import annotations

import typing as _typing

import numpy as np

from ._labels import LabelMap
from ._types import Array

Shape = _typing.Callable[[Array], Array]  # signed distance [m], or something like it, negative inside


def ellipsoid(centre: Array, half_axes: Array) -> Shape:
    """Near the surface the value is a distance to first order."""
    c, r = np.array(centre), np.array(half_axes)

    def value(p: Array) -> Array:
        q = (p - c) / r
        k = np.linalg.norm(q, axis=-1)
        return k * (k - 1.0) / np.maximum(np.linalg.norm(q / r, axis=-1), 1e-9)

    return value


def tube(points: Array, radius: float) -> Shape:
    """A capsule along each part of a line."""
    line = np.array(points, float)

    def value(p: Array) -> Array:
        out = np.full(p.shape[:-1], np.inf)
        for a, b in zip(line[:-1], line[1:]):
            s = np.clip(((p - a) @ (b - a)) / ((b - a) @ (b - a)), 0.0, 1.0)
            out = np.minimum(out, np.linalg.norm(p - a - s[..., None] * (b - a), axis=-1))
        return out - radius

    return value


def union(*shapes: Shape) -> Shape:
    return lambda p: np.minimum.reduce([shape(p) for shape in shapes])


def without(shape: Shape, *others: Shape) -> Shape:
    return lambda p: np.maximum.reduce([shape(p), *(-other(p) for other in others)])


def both(*shapes: Shape) -> Shape:
    return lambda p: np.maximum.reduce([shape(p) for shape in shapes])


def bumpy(shape: Shape, height: float, length: float, seed: int) -> Shape:
    """With waves of a height and a length on it."""
    random = np.random.default_rng(seed)
    turns = random.normal(size=(5, 3))
    turns *= 2.0 * np.pi / length / np.linalg.norm(turns, axis=1)[:, None]
    phase = random.uniform(0.0, 2.0 * np.pi, 5)
    return lambda p: shape(p) + height * np.sin(p @ turns.T + phase).mean(axis=-1)


def label_map(
    organs: _typing.Mapping[str, Shape],
    low: _typing.Sequence[float],
    high: _typing.Sequence[float],
    spacing: _typing.Union[float, _typing.Sequence[float]] = 1e-3,
    noise: float = 0.0,
    seed: int = 0,
) -> LabelMap:
    """Voxels [m] of organs; where several are, it is the last one. `noise` [m] is the
    standard deviation of the distances that decide."""
    step = np.broadcast_to(np.asarray(spacing, float), 3)
    axes = [np.arange(low[k], high[k] + 0.5 * step[k], step[k]) for k in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    array = np.zeros(points.shape[:3], np.uint8)
    random = np.random.default_rng(seed)
    for label, shape in enumerate(organs.values(), 1):
        value = shape(points)
        if noise:
            value = value + noise * random.normal(size=value.shape)
        array[value < 0.0] = label
    affine = np.diag([*step, 1.0])
    affine[:3, 3] = low
    return LabelMap(array, affine, names=dict(enumerate(organs, 1)), source="phantom")


def liver_and_gallbladder(spacing: float = 2e-3) -> LabelMap:
    """Three soft organs that touch and a bone behind them, 20 cm wide."""
    liver = bumpy(ellipsoid((0, 0, 0), (0.09, 0.05, 0.06)), 0.004, 0.06, 1)
    organs = {
        "liver": liver,
        "gallbladder": ellipsoid((0.03, 0.028, -0.05), (0.014, 0.014, 0.026)),
        "hepatic_vein": tube([(0.0, -0.01, 0.09), (0.0, 0.0, 0.02), (0.03, 0.0, -0.02)], 0.009),
        "vertebra": without(ellipsoid((0.0, -0.065, 0.0), (0.03, 0.025, 0.04)), ellipsoid((0, 0, 0), (0.09, 0.05, 0.06))),
    }
    return label_map(organs, (-0.1, -0.1, -0.09), (0.1, 0.06, 0.1), spacing)


def abdomen(spacing: float = 2e-3) -> LabelMap:
    """Seventeen organs where they are in an adult, of about their sizes; smooth shapes, not a patient. x is right, y front, z head."""
    spine = [tube([(0, -0.075, z), (0, -0.075, z + 0.024)], 0.021) for z in (-0.11, -0.074, -0.038, -0.002, 0.034, 0.07)]
    discs = [tube([(0, -0.075, z - 0.012), (0, -0.075, z + 0.036)], 0.0185) for z in (-0.11, -0.074, -0.038, -0.002, 0.034)]
    kidney = both(ellipsoid((0, 0, 0), (0.026, 0.024, 0.055)), lambda p: 0.022 - np.linalg.norm((p - [-0.034, 0.004, 0.0]) * [1, 1, 0.6], axis=-1))

    def placed(shape: Shape, at: _typing.Sequence[float], mirror: float = 1.0) -> Shape:
        return lambda p: shape((p - np.array(at)) * np.array([mirror, 1.0, 1.0]))

    liver = bumpy(both(ellipsoid((0.055, 0.0, 0.045), (0.095, 0.07, 0.075)), ellipsoid((0.02, 0.02, 0.09), (0.16, 0.12, 0.11))), 0.003, 0.07, 1)
    stomach = tube([(-0.045, -0.005, 0.1), (-0.075, 0.015, 0.06), (-0.06, 0.035, 0.0), (-0.015, 0.045, -0.025)], 0.028)
    colon = tube([(0.095, 0.01, -0.12), (0.1, 0.01, -0.05), (0.06, 0.05, -0.055), (0.0, 0.055, -0.075), (-0.07, 0.045, -0.05), (-0.105, -0.005, -0.02),
                  (-0.11, -0.01, -0.12)], 0.019)  # fmt: skip
    pancreas = tube([(0.045, -0.012, -0.015), (0.0, -0.005, 0.0), (-0.07, -0.03, 0.03)], 0.012)
    organs: dict[str, Shape] = {f"vertebra_L{5 - i}" if i < 5 else "vertebra_T12": shape for i, shape in enumerate(spine)}
    organs["intervertebral_cartilage"] = without(union(*discs), *spine)
    organs["kidney_right"] = placed(kidney, (0.065, -0.055, -0.03))
    organs["kidney_left"] = placed(kidney, (-0.065, -0.055, -0.015), -1.0)
    organs["spleen"] = bumpy(ellipsoid((-0.105, -0.04, 0.06), (0.024, 0.04, 0.055)), 0.002, 0.05, 2)
    organs["colon"] = colon
    organs["stomach"] = stomach
    organs["liver"] = without(liver, organs["kidney_right"], stomach, colon)
    organs["gallbladder"] = ellipsoid((0.06, 0.045, -0.02), (0.016, 0.017, 0.032))
    organs["pancreas"] = without(pancreas, stomach)
    organs["vena_cava"] = without(tube([(0.022, -0.045, -0.12), (0.022, -0.042, 0.0), (0.025, -0.03, 0.11)], 0.011), *spine)
    organs["aorta"] = without(tube([(-0.018, -0.042, -0.12), (-0.015, -0.043, 0.11)], 0.010), *spine)
    return label_map(organs, (-0.14, -0.1, -0.135), (0.155, 0.085, 0.125), spacing)


def vessel(spacing: float = 1e-3) -> LabelMap:
    """A Y of 8 and 6 mm."""
    return label_map(
        {"portal_vein": union(tube([(0, 0, -0.05), (0, 0, 0)], 0.008), tube([(0, 0, 0), (0.03, 0, 0.04)], 0.006), tube([(0, 0, 0), (-0.03, 0.01, 0.04)], 0.006))},
        (-0.045, -0.015, -0.065), (0.045, 0.025, 0.055), spacing,
    )  # fmt: skip


def _moved(shape: Shape, at: Array, turn: Array) -> Shape:
    return lambda p: shape((p - at) @ turn)


def _any_anatomy(random: np.random.Generator, seed: int) -> _typing.Optional[LabelMap]:
    organs: dict[str, Shape] = {}
    for i in range(int(random.integers(1, 6))):
        at = random.uniform(-0.03, 0.03, 3)
        kind = random.integers(0, 4)
        if kind == 0:
            shape = ellipsoid(at, random.uniform(0.01, 0.04, 3))
        elif kind == 1:
            shape = bumpy(ellipsoid(at, random.uniform(0.015, 0.04, 3)), random.uniform(0.0005, 0.003), random.uniform(0.015, 0.05), seed)
        elif kind == 2:
            shape = tube(at + np.cumsum(random.normal(scale=0.015, size=(4, 3)), axis=0), random.uniform(0.003, 0.008))
        else:
            turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
            axes = np.array([random.uniform(0.02, 0.04), random.uniform(0.02, 0.04), random.uniform(0.002, 0.005)])
            shape = _moved(ellipsoid((0, 0, 0), axes), at, turn)
        organs[f"organ_{i + 1}"] = shape
    spacing = random.choice([0.00125, 0.0015, 0.002]) * np.array([1.0, 1.0, random.choice([1.0, 1.0, 2.5])])
    noise = float(random.choice([0.0, 0.0, 0.0003, 0.0008]))
    map_ = label_map(organs, (-0.07, -0.07, -0.07), (0.07, 0.07, 0.07), spacing, noise, seed)
    # What others have covered but for a few voxels is no organ that anybody would segment.
    large = [label for label in map_.labels if (map_.array == label).sum() >= 200]
    return map_.only(large) if large else None


def random_anatomy(seed: int) -> LabelMap:
    """One to five organs that touch, overlap or stand alone: ellipsoids with bumps, tubes, sheets; with noise, and voxels that need not be cubes."""
    random = np.random.default_rng(seed)
    while (map_ := _any_anatomy(random, seed)) is None:
        pass
    return map_
