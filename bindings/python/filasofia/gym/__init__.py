"""Environments for gymnasium (docs/guide/environments.md): importing this registers filasofia/Reach-v0 and 21 more."""

from __future__ import annotations

try:
    import gymnasium as _gymnasium
except ImportError:
    raise ImportError("filasofia.gym needs gymnasium: pip install filasofia[gym]") from None

from .cannulation import Cannulation
from .cuts import PolypRemoval, PrecisionCutting
from .environment import SurgicalEnv
from .gallbladder import Cholecystectomy, GallbladderDissection
from .hysteroscopy import HysteroscopicMyomectomy, HysteroscopicPolypectomy
from .judgement import Judgement
from .laparoscopy import ClipAndCut, PatternCutting, PegTransfer
from .state import EnvState
from .stitches import LigatingLoop, Suture
from .tasks import (
    BimanualTissueManipulation,
    DeflectSpheres,
    GraspLift,
    PickAndPlace,
    Reach,
    SearchForPoint,
    TissueManipulation,
    TissueRetraction,
)
from .threads import RopeThreading, ThreadInHole
from .tool import Joint, Tool
from .vector import VectorEnv

TASKS = (
    Reach,
    DeflectSpheres,
    SearchForPoint,
    TissueManipulation,
    TissueRetraction,
    BimanualTissueManipulation,
    PrecisionCutting,
    PickAndPlace,
    GraspLift,
    PolypRemoval,
    ThreadInHole,
    RopeThreading,
    LigatingLoop,
    Suture,
    PegTransfer,
    PatternCutting,
    ClipAndCut,
    Cannulation,
    GallbladderDissection,
    Cholecystectomy,
    HysteroscopicPolypectomy,
    HysteroscopicMyomectomy,
)

# Name by name, because type checkers read no more than that.
__all__ = [
    "TASKS",
    "BimanualTissueManipulation",
    "Cannulation",
    "Cholecystectomy",
    "ClipAndCut",
    "DeflectSpheres",
    "EnvState",
    "GallbladderDissection",
    "GraspLift",
    "HysteroscopicMyomectomy",
    "HysteroscopicPolypectomy",
    "Joint",
    "Judgement",
    "LigatingLoop",
    "PatternCutting",
    "PegTransfer",
    "PickAndPlace",
    "PolypRemoval",
    "PrecisionCutting",
    "Reach",
    "RopeThreading",
    "SearchForPoint",
    "Suture",
    "SurgicalEnv",
    "ThreadInHole",
    "TissueManipulation",
    "TissueRetraction",
    "Tool",
    "VectorEnv",
]

for _each in TASKS:
    _gymnasium.register(
        id=f"filasofia/{_each.__name__}-v0",
        entry_point=f"filasofia.gym:{_each.__name__}",
        vector_entry_point=f"filasofia.gym.vectors:{_each.__name__}",
    )
