"""Simulation: the class of C++ with the keywords of the Defs that it takes."""

from __future__ import annotations

import enum as _enum
import os as _os
import typing as _typing

from . import _core, _defs

if _typing.TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray
    from typing_extensions import Unpack

    from ._core import Numbers
    from ._pictures import Film, Picture


def _only(kind: _typing.Any, given: _typing.Any, named: _typing.Mapping[str, _typing.Any]) -> _typing.Any:
    """A Def from what was given: the Def itself, or its fields by keyword."""
    if given is None:
        return kind(**named)
    if named:
        raise TypeError(f"give a {kind.__name__} or its fields, not both")
    return given


class DepthImage(_typing.NamedTuple):
    """Depth and segmentation of a picture. A notebook shows the depth: what is near is bright."""

    depth: NDArray[numpy.float32]  #: (height, width) [m], along the viewing direction; inf where nothing is seen
    bodies: NDArray[numpy.uint32]  #: (height, width), the BodyId of what is seen; 0 where there is none

    def _repr_png_(self) -> bytes:
        import numpy as np

        from . import _png

        seen = np.isfinite(self.depth)
        near = 1 / self.depth[seen]
        grey = np.zeros(self.depth.shape, np.uint8)
        if near.size:
            low, high = near.min(), near.max()
            grey[seen] = 55 + 200 * (near - low) / max(high - low, 1e-12)
        return _png.png(np.repeat(grey[..., None], 3, axis=2))


class Simulation(_core.Simulation):
    """A headless simulation: bodies, steps, commands, events, frames and pictures.

    Its keywords are the fields of PhysicsDef (rate, gravity, threads, contact, ...), and `look`, a LookDef.
    """

    def __init__(
        self,
        physics: _defs.PhysicsDef | None = None,
        *,
        look: _defs.LookDef | None = None,
        **fields: Unpack[_defs.PhysicsDefFields],
    ):
        super().__init__(_only(_defs.PhysicsDef, physics, fields), look)

    def show(
        self, body: _defs.BodyId, definition: _defs.ShowDef | None = None, **fields: Unpack[_defs.ShowDefFields]
    ) -> _defs.ShownId:
        """Draws a body as a ShowDef, or its fields, say. Without any call of it, pictures show all bodies.

        After a picture that showed all bodies it replaces what that picture showed of this one; the others stay.
        """
        return self._show(body, _only(_defs.ShowDef, definition, fields))  # type: ignore[attr-defined, no-any-return]

    def render(
        self,
        width: int = 640,
        height: int = 480,
        *,
        pose: _defs.Pose | Numbers | None = None,
        camera: _defs.CameraDef | None = None,
    ) -> Picture:
        """A picture of the present state: (height, width, 3), uint8, sRGB. Notebooks show it; save() writes a PNG.

        `pose` is where the camera is (look_at() makes one), `camera` a CameraDef, its lens; without them the picture is
        that of the look, which frames what is shown when the first picture is made.
        """
        from ._pictures import Picture  # here, because it is made of NumPy's array, and NumPy is slow to import

        return self._render(_defs.PictureDef(width, height, pose, camera)).view(Picture)  # type: ignore[attr-defined, no-any-return]

    def film(
        self,
        seconds: float,
        *,
        fps: float = 25.0,
        width: int = 320,
        height: int = 240,
        pose: _defs.Pose | Numbers | None = None,
        camera: _defs.CameraDef | None = None,
    ) -> Film:
        """Runs for `seconds` and returns pictures of it, `fps` for each simulated second. Notebooks show it moving.

        As many steps as round(seconds / dt). More pictures than steps there are not: fps is at most 1 / dt.
        """
        from ._pictures import Film

        for name, value in (("seconds", seconds), ("fps", fps)):
            if not hasattr(value, "__float__"):
                raise TypeError(f"film: {name} must be a number, got {value!r}")
        steps = round(seconds / self.dt) if 0 < seconds < 1e6 else 0
        if steps < 1:
            raise _core.Error(f"film: seconds must be in [{self.dt:.6g}, 1e6), got {seconds!r}")
        if not 0 < fps * self.dt <= 1:
            raise _core.Error(f"film: fps must be in (0, {1 / self.dt:.6g}], got {fps!r}")
        how: dict[str, _typing.Any] = {"pose": pose, "camera": camera}
        pictures, made = [self.render(width, height, **how)], 0
        for i in range(1, int(steps * self.dt * fps + 1e-9) + 1):
            due = round(i / fps / self.dt)
            self.step(due - made)
            made = due
            pictures.append(self.render(width, height, **how))
        if made < steps:
            self.step(steps - made)
        return Film(pictures, fps)

    def render_depth(
        self,
        width: int = 640,
        height: int = 480,
        *,
        pose: _defs.Pose | Numbers | None = None,
        camera: _defs.CameraDef | None = None,
    ) -> DepthImage:
        """What each pixel of render() shows: how far away it is, and which body it belongs to.

        The values are those at the pixels' centres. Transparent bodies count like others; debug lines do not.
        """
        return DepthImage(*self._render_depth(_defs.PictureDef(width, height, pose, camera)))  # type: ignore[attr-defined]

    def measure(
        self,
        definition: _defs.MetricTrackerDef | None = None,
        *,
        trainee: str = "",
        task: str = "",
        steps: _typing.Sequence[str] = (),
        targets: _typing.Sequence[str] = (),
        watched: _typing.Sequence[str] = (),
        force_limit: float | None = None,
        **fields: Unpack[_defs.MetricTrackerDefFields],
    ) -> None:
        """Writes what bodies do into a session file, until close(): a MetricTrackerDef, or its fields (bodies, file).

        `steps` are those of the task, each to be marked once; `targets` the names of bodies that are to be cut or torn;
        `watched` further kinds of events that mark() will report, each time that they happen ("perforation", ...);
        `force_limit` [N] is what the tissue withstands. Call it before the first step. measures() computes the numbers,
        `filasofia report` the page.
        """
        definition = _only(_defs.MetricTrackerDef, definition, fields)
        for name, names in (("steps", steps), ("targets", targets), ("watched", watched)):
            if isinstance(names, (str, bytes)) or not hasattr(names, "__iter__"):  # a text is a list of its letters
                raise TypeError(f"measure: {name} must be a list of texts, got {names!r}")
        given = (trainee, task, list(steps), list(targets), list(watched), force_limit)
        self._measure(definition, *given)  # type: ignore[attr-defined]

    def __repr__(self) -> str:
        try:
            if self._foreign:  # type: ignore[attr-defined]
                return "<Simulation of another process>"
            return f"<Simulation of {len(self.bodies)} bodies at {self.time:.6g} s>"
        except _core.Error:  # perhaps another thread has closed it just now
            return f"<closed Simulation at {self.time:.6g} s>"
        except TypeError:
            return "<Simulation that was not initialised>"


def load(
    file: str | _os.PathLike[str],
    *,
    any_folder: bool = False,
    threads: int | None = None,
    strict: bool = False,
    package: str | _os.PathLike[str] | None = None,
    unit: float | None = None,
    measures: str | _os.PathLike[str] | None = None,
    sensors: str | _os.PathLike[str] | None = None,
    physics: _defs.PhysicsDef | None = None,
    look: _defs.LookDef | None = None,
) -> Simulation:
    """A simulation of the scene in a file (docs/guide/scenes.md); `bodies` are in the order of the file.

    The file may also be a robot in URDF, a model of MuJoCo or a scene of SOFA (docs/guide/import.md). What is not read
    of it is told on standard error or, if `strict`, raises Error; `package` is the folder that package:// names, and
    `unit` [m] what a scene of SOFA calls a unit of length, 0.001 for millimetres.

    Files that the scene names must be in its folder, unless `any_folder`. `threads` replaces those of the scene, with
    the same bits. `measures` is a .jsonl or .csv file that close() completes: what the scene measures; `sensors` a
    .csv file with what its sensors read over time. A task that is over does not stop step(). `physics` and `look`
    replace those of the scene as a whole; `threads` is then that of `physics`.
    Raises Error "FILE:LINE:COLUMN: ...".
    """
    if file is None:
        raise TypeError("load: file must be a text, got None")
    if physics is not None and threads is not None:
        raise TypeError("load: give threads or physics, not both")
    simulation = Simulation.__new__(Simulation)
    _core.Simulation.__init__(
        simulation,
        physics=physics,
        look=look,
        scene=file,
        any_folder=any_folder,
        threads=threads,
        strict=strict,
        package=package,
        unit=unit,
        measures=measures,
        sensors=sensors,
    )
    return simulation


def replay(definition: _defs.ReplayDef | None = None, **fields: Unpack[_defs.ReplayDefFields]) -> _core.ReplayReport:
    """Replays a recording as fast as possible: a ReplayDef, or its fields (file, check, ...)."""
    definition = _only(_defs.ReplayDef, definition, fields)
    if isinstance(definition, _defs.ReplayDef) and not definition.file:
        raise _core.Error("replay: file must name a recording, got ''")
    return _core.replay(definition)


# nanobind's flags print as numbers; Python's as names.
_core.StepFlag.__repr__ = _enum.Flag.__repr__  # type: ignore
_core.StepFlag.__str__ = _enum.Flag.__str__  # type: ignore
for _each in (DepthImage, Simulation, load, replay):
    _each.__module__ = "filasofia"
