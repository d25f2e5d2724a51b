"""Picture and Film: arrays that notebooks show inline."""

from __future__ import annotations

import math
import os
import typing

import numpy

from . import _core, _png

if typing.TYPE_CHECKING:
    from numpy.typing import NDArray

    Pixels = NDArray[numpy.uint8]
else:
    Pixels = numpy.ndarray


class Picture(Pixels):
    """A picture: an array (height, width, 3), uint8, sRGB, that a notebook shows if it is the last line of a cell.

    What is computed from it is an ordinary array or number; parts of it are pictures, too, if they have the shape of one.
    """

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes it as a PNG: the name must end in .png."""
        _png.check_name(file, "picture")
        if not self._shown():
            raise _core.Error(f"picture: it must be (height, width, 3), uint8, got {self.shape}, {self.dtype}")
        _png.write(file, _png.png(self))

    def __array_wrap__(self, array: typing.Any, context: typing.Any = None, return_scalar: bool = False) -> typing.Any:
        """What NumPy calls with a result: without it, a mean would be a picture of no pixel."""
        if array is self:
            return self
        plain = numpy.asarray(array)
        return plain[()] if plain.ndim == 0 else plain

    def _shown(self) -> bool:
        return self.ndim == 3 and self.shape[2] == 3 and self.dtype == numpy.uint8 and self.size > 0

    def _repr_png_(self) -> bytes | None:
        return _png.png(self) if self._shown() else None


class Film(typing.Sequence[Picture]):
    """Pictures of a run, one after the other: a notebook shows them moving.

    They may come from anywhere: Film([sim.render(320, 240), ...], fps=25).
    """

    def __init__(self, pictures: typing.Iterable[NDArray[numpy.uint8]], fps: float = 25.0):
        if not hasattr(pictures, "__iter__"):
            raise TypeError(f"film: pictures must be a list of them, got {pictures!r}")
        if not hasattr(fps, "__float__"):
            raise TypeError(f"film: fps must be a number, got {fps!r}")
        self.pictures = [numpy.asarray(each).view(Picture) for each in pictures]
        self.fps = float(fps)
        if not math.isfinite(self.fps) or not 0.1 <= self.fps <= 1000:
            raise _core.Error(f"film: fps must be in [0.1, 1000], got {fps!r}")
        if not self.pictures:
            raise _core.Error("film: there must be at least one picture, got 0")
        for i, each in enumerate(self.pictures):
            if not each._shown() or each.shape != self.pictures[0].shape:
                raise _core.Error(
                    f"film: pictures must all be (height, width, 3), uint8, of one size, got {each.shape}, {each.dtype}"
                    f" for picture {i}"
                )

    def __len__(self) -> int:
        return len(self.pictures)

    @typing.overload
    def __getitem__(self, index: int) -> Picture: ...
    @typing.overload
    def __getitem__(self, index: slice) -> Film: ...
    def __getitem__(self, index: int | slice) -> Picture | Film:
        return Film(self.pictures[index], self.fps) if isinstance(index, slice) else self.pictures[index]

    def strip(self, count: int = 5) -> Picture:
        """`count` of the pictures, evenly spread in time, beside each other, as a page of paper has them."""
        if not hasattr(count, "__index__") or count < 1:
            raise _core.Error(f"film: count must be a whole number >= 1, got {count!r}")
        chosen = numpy.linspace(0, len(self) - 1, count).round().astype(int)
        return numpy.concatenate([self.pictures[i] for i in chosen], axis=1).view(Picture)

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes an animated PNG, .png, too: browsers show it moving, other programs its first picture."""
        _png.check_name(file, "film")
        _png.write(file, _png.animated_png(self.pictures, self.fps))

    def _repr_png_(self) -> bytes:
        return _png.animated_png(self.pictures, self.fps)

    def __repr__(self) -> str:
        height, width, _ = self.pictures[0].shape
        return f"<Film of {len(self)} pictures of {width} x {height}, {len(self) / self.fps:.3g} s>"


for _each in (Picture, Film):
    _each.__module__ = "filasofia"
