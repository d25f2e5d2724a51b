"""Filasofia: real-time surgical simulation. SI units everywhere; docs/guide/python.md is the guide."""

from __future__ import annotations

import atexit as _atexit
import os as _os
import typing as _typing

from . import _core, _defs, shapes
from ._core import (
    AerosolBalance,
    ArticulatedInstrument,
    AttachmentBreak,
    BleedingEvent,
    BloodBalance,
    BodySolve,
    BreakEvent,
    BurnEvent,
    ClipApplier,
    ClipChange,
    ClipEvent,
    ClipReport,
    ContactEvent,
    ContactPairReport,
    ContactReport,
    CutEvent,
    DistensionBalance,
    DistensionEvent,
    DuctBalance,
    DuctReport,
    DuctEvent,
    Endoscope,
    EnergyBalance,
    EnergyEvent,
    Error,
    FileFailedEvent,
    Frame,
    HeatBalance,
    InstrumentTie,
    Intersection,
    IntersectionEvent,
    InvertedElements,
    KnotHands,
    Laparoscope,
    LaparoscopicInstrument,
    LensState,
    LoosePiece,
    MechanicalEnergy,
    PhysicsUpdateEvent,
    ReplayReport,
    RigidBodyFrame,
    RunReport,
    Rupture,
    SavedState,
    SmokeBalance,
    SoftBodyFrame,
    SpecimenBag,
    StepFlag,
    StepReport,
    StrainedElements,
    SuctionIrrigator,
    TaskProgress,
    TearEvent,
    TetMesh,
    Tissue,
    TopologyReport,
    TriangleMesh,
    TrocarHands,
    TrocarReport,
    UltrasonicShears,
    Unrest,
    WireLoop,
    axis_angle,
    hexadecimal,
    load_tet_mesh,
    load_triangle_mesh,
    look_at,
    measures,
    save_scene,
    tissue,
    tissues,
)
from ._defs import *  # noqa: F403  the Defs, a class for each
from ._log import log_to
from ._simulation import DepthImage, Simulation, load, replay
from . import viewer  # noqa: E402  after Simulation, which it uses

if _typing.TYPE_CHECKING:
    from ._pictures import Film, Picture

    __version__: str

__all__ = [
    "DepthImage",
    "Film",
    "Picture",
    "Simulation",
    "asset",
    "load",
    "replay",
    "AerosolBalance",
    "ArticulatedInstrument",
    "AttachmentBreak",
    "BleedingEvent",
    "BloodBalance",
    "BodySolve",
    "BreakEvent",
    "BurnEvent",
    "ClipApplier",
    "ClipChange",
    "ClipEvent",
    "ClipReport",
    "ContactEvent",
    "ContactPairReport",
    "ContactReport",
    "CutEvent",
    "DistensionBalance",
    "DistensionEvent",
    "DuctBalance",
    "DuctReport",
    "DuctEvent",
    "Endoscope",
    "EnergyBalance",
    "EnergyEvent",
    "Error",
    "FileFailedEvent",
    "Frame",
    "HeatBalance",
    "InstrumentTie",
    "Intersection",
    "IntersectionEvent",
    "InvertedElements",
    "KnotHands",
    "Laparoscope",
    "LaparoscopicInstrument",
    "LensState",
    "LoosePiece",
    "MechanicalEnergy",
    "PhysicsUpdateEvent",
    "ReplayReport",
    "RigidBodyFrame",
    "RunReport",
    "Rupture",
    "SavedState",
    "SmokeBalance",
    "SoftBodyFrame",
    "SpecimenBag",
    "StepFlag",
    "StepReport",
    "StrainedElements",
    "SuctionIrrigator",
    "TaskProgress",
    "TearEvent",
    "TetMesh",
    "Tissue",
    "TopologyReport",
    "TriangleMesh",
    "TrocarHands",
    "TrocarReport",
    "UltrasonicShears",
    "Unrest",
    "WireLoop",
    "axis_angle",
    "hexadecimal",
    "load_tet_mesh",
    "load_triangle_mesh",
    "log_to",
    "look_at",
    "measures",
    "save_scene",
    "shapes",
    "tissue",
    "tissues",
]
__all__ += _defs.__all__


def asset(name: str) -> str:
    """The path of a file that comes with Filasofia, such as "meshes/bunny_3004.msh"."""
    return _core.asset(name, _os.path.join(_os.path.dirname(__file__), "data"))


if not _typing.TYPE_CHECKING:  # a type checker would take every wrong name for one of these

    def __getattr__(name: str) -> _typing.Any:
        if name in ("Film", "Picture"):  # made of NumPy's arrays, and NumPy is slow to import
            from . import _pictures

            return getattr(_pictures, name)
        if name != "__version__":
            known = [each for each in __all__ if not name.startswith("_")]
            raise AttributeError(f"module 'filasofia' has no attribute '{name}'{_core.did_you_mean(name, known)}")
        from importlib.metadata import version  # slow, too, and seldom asked for

        return version("filasofia")


def _own_names() -> set[str]:
    """What Errors of C++ call by its name in Python: our fields, functions and methods. All other words are users'."""
    owners = [shapes, viewer, *(each for each in globals().values() if isinstance(each, type))]
    return set(globals()).union(*(dir(each) for each in owners))


_core.set_own_names(sorted(_own_names()))
# Before the interpreter ends: a thread of a simulation must not find it gone.
_atexit.register(_core._log_to, None)  # type: ignore[attr-defined]  # the last, as the others may log
_atexit.register(_core.close_all)
