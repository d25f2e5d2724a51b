"""A window in which a person watches a simulation that a program steps.

with filasofia.viewer.launch_passive(sim) as viewer:
    while viewer.is_running():
        sim.step()
"""

from __future__ import annotations

import typing as _typing

from . import _defs
from ._simulation import Simulation, _only


class Viewer:
    """An open viewer; launch_passive() makes it. The end of a `with` block closes it."""

    def __init__(self, sim: Simulation):
        self._sim = sim

    def is_running(self) -> bool:
        """Whether the window is open: the person may have closed it, or the simulation."""
        return self._sim._viewing()  # type: ignore[attr-defined, no-any-return]

    def sync(self) -> None:
        """Draws the present state now. The viewer shows the newest one at its own rate; this is for seeing every one."""
        self._sim._show_in_viewer()  # type: ignore[attr-defined]

    def close(self) -> None:
        """Closes the window; the simulation goes on."""
        self._sim._close_viewer()  # type: ignore[attr-defined]

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def launch_passive(sim: Simulation, definition: _defs.ViewerDef | None = None, **fields: _typing.Any) -> Viewer:
    """Opens a window that shows the simulation: a ViewerDef, or its fields (window, rate, ...).

    It draws on a thread of its own and changes nothing: the program steps as before, and gets the same bits. The mouse
    turns the camera, the wheel moves it, F12 writes a picture, Escape closes the window. It needs a display (X11); one
    simulation at a time can have a window.
    """
    if not isinstance(sim, Simulation):
        raise TypeError(f"launch_passive: sim must be a Simulation, got {sim!r}")
    sim._open_viewer(_only(_defs.ViewerDef, definition, fields))  # type: ignore[attr-defined]
    return Viewer(sim)
