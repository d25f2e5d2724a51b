"""Anatomies made of formulas, with known surfaces: for tests, measurements and trying things out. They are no patients."""

from __future__ import annotations

import typing as _typing

import numpy as np

from ._labels import LabelMap
from ._types import Array

Shape = _typing.Callable[[Array], Array]  # signed distance [m], or something like it, negative inside


def ellipsoid(centre: _typing.Sequence[float], half_axes: _typing.Sequence[float]) -> Shape:
    """Near the surface the value is a distance to first order."""
    c, r = np.array(centre), np.array(half_axes)

    def value(p: Array) -> Array:
        q = (p - c) / r
        k = np.linalg.norm(q, axis=-1)
        return k * (k - 1.0) / np.maximum(np.linalg.norm(q / r, axis=-1), 1e-9)

    return value


def tube(points: _typing.Sequence[_typing.Sequence[float]], radius: float) -> Shape:
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
    """Voxels [m] of organs; where several are, it is the last one. `noise` is the share of voxels at rims that are wrong."""
    step = np.broadcast_to(np.asarray(spacing, float), 3)
    axes = [np.arange(low[k], high[k] + 0.5 * step[k], step[k]) for k in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    array = np.zeros(points.shape[:3], np.uint8)
    random = np.random.default_rng(seed)
    for label, shape in enumerate(organs.values(), 1):
        value = shape(points)
        if noise:
            value = np.where(random.random(value.shape) < noise, -value, value) if False else value + noise * random.normal(size=value.shape)
        array[value < 0.0] = label
    affine = np.diag([*step, 1.0])
    affine[:3, 3] = low
    return LabelMap(array, affine, names=dict(enumerate(organs, 1)), source="phantom")


def liver_and_gallbladder(spacing: float = 2e-3) -> LabelMap:
    """Three soft organs that touch and a bone behind them, 20 cm wide."""
    return label_map(
        {
            "liver": bumpy(ellipsoid((0, 0, 0), (0.09, 0.05, 0.06)), 0.004, 0.06, 1),
            "gallbladder": ellipsoid((0.03, 0.028, -0.05), (0.014, 0.014, 0.026)),
            "hepatic_vein": tube([(0.0, -0.01, 0.09), (0.0, 0.0, 0.02), (0.03, 0.0, -0.02)], 0.007),
            "vertebra": without(ellipsoid((0.0, -0.065, 0.0), (0.03, 0.025, 0.04)), ellipsoid((0, 0, 0), (0.09, 0.05, 0.06))),
        },
        (-0.1, -0.1, -0.09),
        (0.1, 0.06, 0.1),
        spacing,
    )
