#!/usr/bin/env python3
"""Makes a picture of 128 x 96 pixels for a start screen: thumbnail.py IN.png X Y WIDTH OUT.png

It shows the part of IN (a PNG of 8-bit RGB) whose upper left corner is at X, Y and which is WIDTH wide, and three quarters of it high."""
import struct
import sys
import zlib

ACROSS, DOWN = 128, 96


def chunks(data):
    at = 8
    while at < len(data):
        (size,) = struct.unpack_from(">I", data, at)
        yield data[at + 4 : at + 8], data[at + 8 : at + 8 + size]
        at += 12 + size


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def rows_of(path):
    with open(path, "rb") as file:
        parts = list(chunks(file.read()))
    width, height, depth, color = struct.unpack_from(">IIBB", parts[0][1])
    if (depth, color) != (8, 2):
        sys.exit(f"{path}: is not a PNG of 8-bit RGB")
    raw = zlib.decompress(b"".join(body for name, body in parts if name == b"IDAT"))
    stride, rows, above = 3 * width, [], bytes(3 * width)
    for y in range(height):
        at = y * (stride + 1)
        kind, line = raw[at], bytearray(raw[at + 1 : at + 1 + stride])
        for x in range(stride):
            a, b, c = (line[x - 3] if x >= 3 else 0), above[x], (above[x - 3] if x >= 3 else 0)
            line[x] = (line[x] + (0, a, b, (a + b) >> 1, paeth(a, b, c))[kind]) & 255
        rows.append(bytes(line))
        above = line
    return rows


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
    rows, step = rows_of(source), int(width) / ACROSS
    lines = b""
    for row in range(DOWN):
        top = int(y) + row * step
        lines += b"\0" + b"".join(mean(rows, int(x) + column * step, top, int(x) + (column + 1) * step, top + step) for column in range(ACROSS))
    chunk = lambda name, data: struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    head = struct.pack(">IIBBBBB", ACROSS, DOWN, 8, 2, 0, 0, 0)
    with open(out, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines, 9)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    main(*sys.argv[1:])
