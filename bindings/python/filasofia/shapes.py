"""Simple bodies without files, centred on the origin."""

from ._core import block, box, capsule, cylinder, ellipsoid, sheet, sphere, tube

__all__ = ["block", "box", "capsule", "cylinder", "ellipsoid", "sheet", "sphere", "tube"]
