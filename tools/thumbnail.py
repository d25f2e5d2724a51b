#!/usr/bin/env python3
"""Makes a picture of 128 x 96 pixels for a start screen: thumbnail.py IN.png X Y WIDTH OUT.png

It shows the part of IN (a PNG of 8-bit RGB) whose upper left corner is at X, Y and which is WIDTH wide, and three quarters of it high."""
import struct
import sys
import zlib

from shrink_png import chunk, read

ACROSS, DOWN = 128, 96


def mean(rows, left, top, right, bottom):
    """The mean colour of a rectangle of pixels; parts of pixels count as parts."""
    total, weight = [0.0, 0.0, 0.0], 0.0
    for y in range(int(top), min(int(bottom) + 1, len(rows))):
        high = min(bottom, y + 1) - max(top, y)
        for x in range(int(left), min(int(right) + 1, len(rows[0]) // 3)):
            part = high * (min(right, x + 1) - max(left, x))
            if part > 0:
                weight += part
                for k in range(3):
                    total[k] += part * rows[y][3 * x + k]
    return bytes(round(each / weight) for each in total)


def main(source, x, y, width, out):
    rows, step = read(source)[2], int(width) / ACROSS
    lines = b""
    for row in range(DOWN):
        top = int(y) + row * step
        lines += b"\0" + b"".join(mean(rows, int(x) + column * step, top, int(x) + (column + 1) * step, top + step) for column in range(ACROSS))
    head = struct.pack(">IIBBBBB", ACROSS, DOWN, 8, 2, 0, 0, 0)
    with open(out, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines, 9)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    main(*sys.argv[1:])
