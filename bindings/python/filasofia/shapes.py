"""Simple bodies without files, centred on the origin."""

from ._core import arc, bladder, block, box, capsule, cylinder, ellipsoid, revolved, sheet, sphere, tube, vessel

__all__ = ["arc", "bladder", "block", "box", "capsule", "cylinder", "ellipsoid", "revolved", "sheet", "sphere", "tube", "vessel"]
