"""Shapes as functions that are negative inside, in millimetres, and about as steep as a distance.

Each takes an array of points (n, 3) and returns n numbers."""
import numpy as np


def smooth_min(a, b, k):
    """The smaller of two, rounded where they are nearer than k (union; k is about the fillet)."""
    h = np.maximum(k - np.abs(a - b), 0.0) / k
    return np.minimum(a, b) - 0.25 * k * h * h


def smooth_max(a, b, k):
    """The larger of two, rounded where they are nearer than k (intersection)."""
    return -smooth_min(-a, -b, k)


def steps(at, knots, values):
    """Values at knots, joined by curves that are level at every knot."""
    at = np.clip(at, knots[0], knots[-1])
    i = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, len(knots) - 2)
    knots, values = np.asarray(knots, float), np.asarray(values, float)
    s = (at - knots[i]) / (knots[i + 1] - knots[i])
    s = s * s * (3.0 - 2.0 * s)
    return values[i] + (values[i + 1] - values[i]) * s


def ellipsoid(p, centre, semi):
    q = p - centre
    k0 = np.sqrt(np.sum((q / semi) ** 2, axis=1))
    k1 = np.sqrt(np.sum((q / np.square(semi)) ** 2, axis=1))
    return np.where(k1 > 1e-9, k0 * (k0 - 1.0) / np.maximum(k1, 1e-9), -min(semi))


def capsule(p, a, b, ra, rb):
    """A rod from a to b with round ends, whose radius goes from ra to rb."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    s = np.clip((p - a) @ (b - a) / np.dot(b - a, b - a), 0.0, 1.0)
    return np.linalg.norm(p - (a + s[:, None] * (b - a)), axis=1) - (ra + s * (rb - ra))


def gradient(f, p, h=1e-3):
    g = np.empty_like(p)
    for k in range(3):
        step = np.zeros(3)
        step[k] = h
        g[:, k] = (f(p + step) - f(p - step)) / (2.0 * h)
    return g


def project(f, p, rounds=4, longest=0.5):
    """Points moved along the gradient until f is zero, at most `longest` per round."""
    p = p.copy()
    for _ in range(rounds):
        g = gradient(f, p)
        move = -f(p)[:, None] * g / np.maximum(np.sum(g * g, axis=1), 0.05)[:, None]
        length = np.linalg.norm(move, axis=1)
        p += move * np.minimum(1.0, longest / np.maximum(length, 1e-12))[:, None]
    return p
