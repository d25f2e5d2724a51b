"""Damaged label maps: every one is read, or refused with an Error. Anything else is a finding.

    python tests/python/fuzz_labels.py [--count 1000000] [--seed 0] [--only nifti]
"""
import argparse
import gzip
import random
import sys
import time
import warnings

import numpy as np

import filasofia as fs
from filasofia import anatomy
from filasofia.anatomy import _read

SHAPE = (5, 4, 3)
INTERESTING = [0, 1, 2, 3, 127, 128, 255, 256, 32767, 32768, 65535, 2**31 - 1, 2**31, 2**32 - 1, 2**63 - 1]


def seeds(folder):
    """Bytes of small files by reader."""
    array = np.zeros(SHAPE, np.uint8)
    array[1:4, 1:3, 1] = 3
    plain = str(folder) + "/seed.nii"
    anatomy.write_labels(anatomy.LabelMap(array), plain)
    with open(plain, "rb") as stream:
        nifti = stream.read()
    raw = array.tobytes(order="F")
    sizes = " ".join(map(str, SHAPE))
    nrrd = (
        "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: " + sizes + "\nspace directions: (1,0,0) (0,1,0) (0,0,2)\n"
        "encoding: {}\nspace origin: (0,0,0)\nSegment0_Name:=liver\nSegment0_LabelValue:=3\n\n"
    )
    layered = nrrd.replace("dimension: 3", "dimension: 4\nkinds: list domain domain domain").replace("sizes: ", "sizes: 1 ").replace("(1,0,0)", "none (1,0,0)")
    meta = "ObjectType = Image\nNDims = 3\nDimSize = " + sizes + "\nElementSpacing = 1 1 2\nElementType = MET_UCHAR\nCompressedData = {}\nElementDataFile = LOCAL\n"
    return {
        "nifti": [nifti, gzip.compress(nifti, mtime=0)],
        "nrrd": [nrrd.format("raw").encode() + raw, nrrd.format("gzip").encode() + gzip.compress(raw, mtime=0), layered.format("raw").encode() + raw],
        "meta": [meta.format("False").encode() + raw, meta.format("True").encode() + __import__("zlib").compress(raw)],
    }


def mutated(data, chance):
    """One to eight changes: bytes, numbers, cuts, repetitions; packed files half of the time inside."""
    packed = data[:2] == b"\x1f\x8b" and chance.random() < 0.5
    out = bytearray(gzip.decompress(data) if packed else data)
    for _ in range(chance.randint(1, 8)):
        kind, at = chance.randrange(7), chance.randrange(max(1, len(out)))
        if kind == 0 and out:
            out[at] = chance.randrange(256)
        elif kind == 1 and out:
            out[at] ^= 1 << chance.randrange(8)
        elif kind == 2:
            width = chance.choice([1, 2, 4, 8])
            value = (chance.choice(INTERESTING) * chance.choice([1, -1])) % 256**width
            out[at : at + width] = value.to_bytes(width, chance.choice(["little", "big"]))
        elif kind == 3:
            del out[at:]
        elif kind == 4:
            del out[at : at + chance.randint(1, 16)]
        elif kind == 5:
            out[at:at] = out[at : at + chance.randint(1, 64)]
        else:
            out[at:at] = str(chance.choice(INTERESTING)).encode()
    return gzip.compress(bytes(out), 1, mtime=0) if packed else bytes(out)


READERS = {
    "nifti": lambda data: _read.parse_nifti(data, "fuzz.nii"),
    "nrrd": lambda data: _read.parse_nrrd(data, "fuzz.nrrd")[:2],
    "meta": lambda data: _read.parse_meta(data, "fuzz.mha"),
}


def run(reader, files, count, seed, limit=64 << 20):
    """How many were read and how many refused. Raises what a reader should not."""
    chance, read, refused = random.Random(f"{reader} {seed}"), 0, 0
    for turn in range(count):
        data = mutated(chance.choice(files), chance)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                array, affine = READERS[reader](data)
                assert array.nbytes <= limit, f"{array.nbytes} bytes from a file of {len(data)}"
                anatomy.LabelMap(array, affine)
            read += 1
        except fs.Error as problem:
            assert "\n" not in str(problem) and len(str(problem)) < 400, repr(problem)
            refused += 1
        except BaseException:
            print(f"finding: {reader}, seed {seed}, turn {turn}: {data!r}", file=sys.stderr)
            raise
    return read, refused


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", choices=list(READERS))
    words = parser.parse_args()
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        files = seeds(folder)
    for reader in [words.only] if words.only else READERS:
        begin = time.perf_counter()
        read, refused = run(reader, files[reader], words.count, words.seed)
        print(f"{reader}: {words.count} executions in {time.perf_counter() - begin:.0f} s: {read} read, {refused} refused, no finding", flush=True)


if __name__ == "__main__":
    main()
