"""From an image to an organ that moves: docs/guide/patient.md is the guide.

Label maps and surfaces become tetrahedra of several organs that share nodes where they touch, and scene files. Needs SciPy:
pip install 'filasofia[anatomy]'."""

from __future__ import annotations

from . import phantoms
from ._anatomy import Anatomy, Organ, Quality, fitting_size, mesh_labels, thickness
from ._draw import draw
from ._input import anatomy_of
from ._labels import LabelMap
from ._lines import centre_line
from ._names import kind_of, read_names
from ._picture import Picture
from ._read import read_labels
from ._scene import write_scene
from ._solids import mesh_surfaces
from ._write import write_anatomy, write_labels, write_msh, write_obj

__all__ = [
    "Anatomy",
    "LabelMap",
    "Organ",
    "Picture",
    "Quality",
    "anatomy_of",
    "centre_line",
    "draw",
    "fitting_size",
    "kind_of",
    "mesh_labels",
    "mesh_surfaces",
    "phantoms",
    "read_labels",
    "read_names",
    "thickness",
    "write_anatomy",
    "write_labels",
    "write_msh",
    "write_obj",
    "write_scene",
]
