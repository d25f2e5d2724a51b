"""The picture printed on the gauze of pattern cutting: 100 x 100 mm of weave with two circles, between which is cut.
Needs nothing but Python. Usage: gauze.py FILE"""
import struct
import sys
import zlib

SIZE = 512               # [pixels]
SIDE = 100.0             # [mm]
CIRCLES = (19.0, 21.0)   # [mm] radii of the lines
WIDTH = 0.45             # [mm] of a line
PALE, DARK, INK = (222, 221, 212), (196, 195, 186), (28, 36, 92)


def colour(column, row):
    x, y = ((each + 0.5) / SIZE - 0.5 for each in (column, row))
    radius = SIDE * (x * x + y * y) ** 0.5
    if any(abs(radius - each) < 0.5 * WIDTH for each in CIRCLES):
        return INK
    return PALE if (column // 2 + row // 2) % 2 else DARK  # threads over and under


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def main(file):
    rows = b"".join(b"\0" + bytes(value for column in range(SIZE) for value in colour(column, row)) for row in range(SIZE))
    with open(file, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", SIZE, SIZE, 8, 2, 0, 0, 0))
                  + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    main(sys.argv[1])
