"""Pictures as files: PNG, and animated PNG, without another library."""

from __future__ import annotations

import os
import struct
import typing
import zlib

import numpy

from . import _core

if typing.TYPE_CHECKING:
    from numpy.typing import NDArray


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _head(picture: NDArray[numpy.uint8]) -> bytes:
    height, width, _ = picture.shape
    return b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0))


def _packed(picture: NDArray[numpy.uint8]) -> bytes:
    """Each row as its difference from the row above (filter 2), which packs well."""
    height, width, _ = picture.shape
    rows = numpy.asarray(picture).reshape(height, 3 * width)
    filtered = numpy.full((height, 3 * width + 1), 2, numpy.uint8)
    filtered[0, 1:] = rows[0]
    numpy.subtract(rows[1:], rows[:-1], out=filtered[1:, 1:])
    return zlib.compress(filtered.tobytes())


def png(picture: NDArray[numpy.uint8]) -> bytes:
    """A picture, (height, width, 3) uint8, as the bytes of a PNG."""
    return _head(picture) + _chunk(b"IDAT", _packed(picture)) + _chunk(b"IEND", b"")


def _changed(before: NDArray[numpy.uint8], now: NDArray[numpy.uint8]) -> tuple[int, int, int, int]:
    """left, top, right, bottom of what differs; at least one pixel."""
    different = (before != now).any(axis=-1)
    if not different.any():
        return 0, 0, 1, 1
    rows, columns = numpy.flatnonzero(different.any(axis=1)), numpy.flatnonzero(different.any(axis=0))
    return int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1


def animated_png(pictures: typing.Sequence[NDArray[numpy.uint8]], fps: float) -> bytes:
    """Pictures of one size as an animated PNG, which repeats for ever; browsers show it, others its first picture."""
    out = [_head(pictures[0]), _chunk(b"acTL", struct.pack(">2I", len(pictures), 0))]
    number = 0
    for i, picture in enumerate(pictures):
        height, width, _ = picture.shape
        left, top, right, bottom = _changed(pictures[i - 1], picture) if i else (0, 0, width, height)
        place = struct.pack(">5I", number, right - left, bottom - top, left, top)
        out.append(_chunk(b"fcTL", place + struct.pack(">2H2B", round(1000 / fps), 1000, 0, 0)))
        data = _packed(picture[top:bottom, left:right])
        out.append(_chunk(b"fdAT", struct.pack(">I", number + 1) + data) if i else _chunk(b"IDAT", data))
        number += 2 if i else 1
    return b"".join(out) + _chunk(b"IEND", b"")


def check_name(file: str | os.PathLike[str], what: str) -> None:
    """Error if the name says that it is something else."""
    name = os.fspath(file)
    if not isinstance(name, str) or "\0" in name or not name.lower().endswith(".png"):
        raise _core.Error(f"{what}: file must end in .png, got {name!r}")


def write(file: str | os.PathLike[str], data: bytes) -> None:
    with open(file, "wb") as out:
        out.write(data)
