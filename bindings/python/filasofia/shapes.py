"""Simple bodies without files, centred on the origin."""

from ._core import arc, block, box, capsule, cylinder, ellipsoid, sheet, sphere, tube, vessel

__all__ = ["arc", "block", "box", "capsule", "cylinder", "ellipsoid", "sheet", "sphere", "tube", "vessel"]
