#!/usr/bin/env python3
"""Recompresses PNG files of 8-bit RGB to a smaller size without changing a pixel: shrink_png.py FILE..."""
import struct
import sys
import zlib


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


def predicted(kind, line, above, x):
    a = line[x - 3] if x >= 3 else 0
    b = above[x]
    c = above[x - 3] if x >= 3 else 0
    return (0, a, b, (a + b) >> 1, paeth(a, b, c))[kind]


def unfiltered(raw, width, height):
    stride, rows, above = 3 * width, [], bytes(3 * width)
    for y in range(height):
        at = y * (stride + 1)
        line = bytearray(raw[at + 1 : at + 1 + stride])
        for x in range(stride):
            line[x] = (line[x] + predicted(raw[at], line, above, x)) & 255
        rows.append(bytes(line))
        above = line
    return rows


def filtered(rows):
    """Encodes each row with the predictor whose errors, together with the bytes before them, have the smallest entropy."""
    out, above = bytearray(), bytes(len(rows[0]))
    for line in rows:
        best = None
        for kind in range(5):
            errors = bytes((line[x] - predicted(kind, line, above, x)) & 255 for x in range(len(line)))
            cost = sum(min(e, 256 - e) for e in errors)
            if best is None or cost < best[0]:
                best = (cost, kind, errors)
        out.append(best[1])
        out += best[2]
        above = line
    return bytes(out)


def packed(raw):
    best = None
    for level in (6, 9):
        for strategy in (zlib.Z_DEFAULT_STRATEGY, zlib.Z_FILTERED):
            coder = zlib.compressobj(level, zlib.DEFLATED, 15, 9, strategy)
            data = coder.compress(raw) + coder.flush()
            best = data if best is None or len(data) < len(best) else best
    return best


def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def read(path):
    """The bytes of the file, its header, and its rows of pixels."""
    with open(path, "rb") as file:
        data = file.read()
    parts = list(chunks(data))
    head = parts[0][1]
    width, height, depth, color = struct.unpack_from(">IIBB", head)
    if (depth, color) != (8, 2):
        sys.exit(f"{path}: is not a PNG of 8-bit RGB")
    raw = zlib.decompress(b"".join(body for name, body in parts if name == b"IDAT"))
    return data, head, unfiltered(raw, width, height)


def shrink(path):
    data, head, rows = read(path)
    body = packed(filtered(rows))
    small = data[:8] + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")
    if len(small) < len(data):
        with open(path, "wb") as file:
            file.write(small)
    print(f"{path}: {len(data)} -> {min(len(small), len(data))}")


if __name__ == "__main__":
    for each in sys.argv[1:]:
        shrink(each)
