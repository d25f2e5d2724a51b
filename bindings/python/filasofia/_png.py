"""Pictures as files."""

from __future__ import annotations

import struct
import zlib


def write_png(file: str, picture: object) -> None:
    """Writes a picture, (height, width, 3) uint8, without another library."""
    height, width, _ = picture.shape  # type: ignore[attr-defined]
    rows = b"".join(b"\0" + row.tobytes() for row in picture)  # type: ignore[attr-defined]

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    with open(file, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)))
        out.write(chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
