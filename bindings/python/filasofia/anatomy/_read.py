"""Readers of label maps: NIfTI (.nii, .nii.gz, .hdr/.img), NRRD (.nrrd, .nhdr) and MetaImage (.mha, .mhd) are read here, within bounds: what a
header announces is compared with what the file can hold before memory is asked for. DICOM-SEG goes to highdicom, other images to SimpleITK."""

from __future__ import annotations

import os as _os
import struct as _struct
import typing as _typing
import zlib as _zlib

import numpy as np

from filasofia import Error

from ._dicom import is_segmentation, read_segmentation
from ._labels import MOST_LABELS, LabelMap
from ._types import Array

MOST_BYTES = 4 << 30  # of an image in memory
_LARGEST_RATIO = 1032  # deflate cannot make a file smaller by more
_HEADER = 1 << 20  # of text headers

_NIFTI_TYPES = {2: "u1", 4: "i2", 8: "i4", 16: "f4", 64: "f8", 256: "i1", 512: "u2", 768: "u4", 1024: "i8", 1280: "u8"}
_NRRD_TYPES = {
    **dict.fromkeys(("signed char", "int8", "int8_t"), "i1"), **dict.fromkeys(("uchar", "unsigned char", "uint8", "uint8_t"), "u1"),
    **dict.fromkeys(("short", "short int", "signed short", "signed short int", "int16", "int16_t"), "i2"),
    **dict.fromkeys(("ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"), "u2"),
    **dict.fromkeys(("int", "signed int", "int32", "int32_t"), "i4"), **dict.fromkeys(("uint", "unsigned int", "uint32", "uint32_t"), "u4"),
    **dict.fromkeys(("longlong", "long long", "long long int", "signed long long", "int64", "int64_t"), "i8"),
    **dict.fromkeys(("ulonglong", "unsigned long long", "uint64", "uint64_t"), "u8"), "float": "f4", "double": "f8",
}  # fmt: skip
_META_TYPES = {
    "MET_CHAR": "i1", "MET_UCHAR": "u1", "MET_SHORT": "i2", "MET_USHORT": "u2", "MET_INT": "i4", "MET_UINT": "u4",
    "MET_LONG": "i4", "MET_ULONG": "u4", "MET_LONG_LONG": "i8", "MET_ULONG_LONG": "u8", "MET_FLOAT": "f4", "MET_DOUBLE": "f8",
}  # fmt: skip
_TO_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])  # axes of ITK and DICOM point to the left and to the back


def read_bytes(file: str) -> bytes:
    """The whole file, or an Error with its name."""
    try:
        regular, size = _os.path.isfile(file) or not _os.path.exists(file), _os.path.getsize(file)
        if regular and size <= MOST_BYTES:
            with open(file, "rb") as stream:
                return stream.read()
    except (OSError, ValueError) as problem:  # ValueError: a name with a zero in it
        raise Error(f"{file}: {getattr(problem, 'strerror', None) or problem}") from None
    raise Error(f"{file}: files may have {MOST_BYTES} bytes, got {size}" if regular else f"{file}: must be a file")


def _inflated(data: bytes, most: int, file: str, wrapper: int = 47) -> bytes:
    """Unpacked data, never more than `most` bytes; several members in a row are one."""
    out: list[bytes] = []
    size = 0
    while data and size < most:
        unpack = _zlib.decompressobj(wrapper)
        try:
            part = unpack.decompress(data, most - size)
        except _zlib.error as problem:
            raise Error(f"{file}: the compressed data are damaged: {problem}") from None
        if not unpack.eof and not unpack.unconsumed_tail:
            raise Error(f"{file}: the compressed data end early, after {size + len(part)} bytes")
        out.append(part)
        size += len(part)
        data = unpack.unused_data if unpack.eof else b""
    return b"".join(out)


def _counted(shape: _typing.Sequence[int], kind: str, available: int, packed: bool, file: str) -> int:
    """Bytes of an image, if the file can hold them."""
    for k, n in enumerate(shape):
        if not 1 <= n <= 65535:
            raise Error(f"{file}: size of axis {k + 1} must be in [1, 65535], got {n}")
    count = np.dtype(kind).itemsize
    for n in shape:
        count *= int(n)
    if count > MOST_BYTES:
        raise Error(f"{file}: the header announces {count} bytes of voxels; at most {MOST_BYTES} are read")
    if count > available * (_LARGEST_RATIO if packed else 1):
        raise Error(f"{file}: the header announces {count} bytes of voxels, but the file has {available} bytes of them{', compressed' * packed}")
    return count


def _voxels(data: bytes, kind: str, order: str, shape: _typing.Sequence[int], file: str) -> Array:
    count = int(np.prod([int(n) for n in shape]))
    needed = count * np.dtype(kind).itemsize
    if len(data) < needed:
        raise Error(f"{file}: {needed} bytes of voxels are announced, but {len(data)} are there")
    return np.frombuffer(data, np.dtype(order + kind), count).reshape(shape, order="F")


def _three(array: Array, file: str) -> Array:
    """Without axes of length 1 beyond the third."""
    while array.ndim > 3 and array.shape[-1] == 1:
        array = array[..., 0]
    if array.ndim != 3:
        raise Error(f"{file}: a label map must have 3 dimensions, got {array.ndim} ({' x '.join(map(str, array.shape))})")
    return array


@np.errstate(all="ignore")  # what is not finite is refused
def parse_nifti(data: bytes, file: str, voxels: _typing.Optional[bytes] = None) -> tuple[Array, Array]:
    """Array and affine [m] of NIfTI-1 and 2, packed or not. `voxels` are those of an .img file."""
    packed = data[:2] == b"\x1f\x8b"
    head = _inflated(data, 544, file) if packed else data[:544]
    if len(head) < 348:
        raise Error(f"{file}: a NIfTI header has 348 bytes, got {len(head)}")
    for order in "<>":
        version = {348: 1, 540: 2}.get(_struct.unpack(order + "i", head[:4])[0])
        if version:
            break
    else:
        raise Error(f"{file}: is not NIfTI: its first number must be 348 or 540, got {_struct.unpack('<i', head[:4])[0]}")
    if version == 2 and len(head) < 540:
        raise Error(f"{file}: a NIfTI-2 header has 540 bytes, got {len(head)}")

    def number(form: str, first: int, second: int) -> _typing.Any:
        values = _struct.unpack_from(order + form, head, first if version == 1 else second)
        return values if len(values) > 1 else values[0]

    dim = number("8h", 40, 0) if version == 1 else number("8q", 0, 16)
    if not 1 <= dim[0] <= 7:
        raise Error(f"{file}: dim[0] must be in [1, 7], got {dim[0]}")
    shape = [int(n) for n in dim[1 : dim[0] + 1]] + [1] * max(0, 3 - dim[0])
    code = number("h", 70, 12)
    if code not in _NIFTI_TYPES:
        raise Error(f"{file}: voxels of NIfTI datatype {code} are not labels; known are {sorted(_NIFTI_TYPES)}")
    kind = _NIFTI_TYPES[code]
    offset = number("f", 108, 0) if version == 1 else number("q", 0, 168)
    if voxels is not None:
        offset = 0 if not np.isfinite(offset) or offset < 0 else offset
    elif not (np.isfinite(offset) and 348 <= offset <= MOST_BYTES):
        raise Error(f"{file}: vox_offset must be in [348, {MOST_BYTES}], got {offset:g}")
    start = int(offset)
    body = data if voxels is None else voxels
    packed_body = body[:2] == b"\x1f\x8b"
    count = _counted(shape, kind, len(body) if packed_body else max(0, len(body) - start), packed_body, file)
    raw = (_inflated(body, start + count, file) if packed_body else body)[start : start + count]
    array = _three(_voxels(raw, kind, order, shape, file), file)
    slope, inter = number("2f", 112, 0) if version == 1 else number("2d", 0, 176)
    if np.isfinite(slope) and slope not in (0.0, 1.0) or (np.isfinite(inter) and slope != 0.0 and inter != 0.0):
        with np.errstate(over="ignore", invalid="ignore"):
            array = array * float(slope) + float(inter if np.isfinite(inter) else 0.0)
    return array, _nifti_affine(number, file)


def _nifti_affine(number: _typing.Callable[..., _typing.Any], file: str) -> Array:
    units = number("b", 123, 0) if number("i", 0, 0) == 348 else number("i", 0, 500)
    metres = {1: 1.0, 3: 1e-6}.get(units & 7, 1e-3)
    v1 = number("i", 0, 0) == 348
    sform = number("h", 254, 0) if v1 else number("i", 0, 348)
    qform = number("h", 252, 0) if v1 else number("i", 0, 344)
    pixdim = np.array(number("8f", 76, 0) if v1 else number("8d", 0, 104), float)
    affine = np.eye(4)
    if sform > 0:
        affine[:3] = np.array(number("12f", 280, 0) if v1 else number("12d", 0, 400), float).reshape(3, 4)
    elif qform > 0:
        b, c, d, *offset = np.array(number("6f", 256, 0) if v1 else number("6d", 0, 352), float)
        a = np.sqrt(max(0.0, 1.0 - b * b - c * c - d * d)) if np.isfinite([b, c, d]).all() and max(abs(b), abs(c), abs(d)) < 2 else 0.0
        turn = np.array([
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
        ])  # fmt: skip
        affine[:3, :3] = turn * pixdim[1:4] * np.array([1.0, 1.0, -1.0 if pixdim[0] < 0 else 1.0])
        affine[:3, 3] = offset
    else:
        affine[:3, :3] = np.diag(np.abs(pixdim[1:4]))
    if not np.isfinite(affine).all():
        raise Error(f"{file}: the place of the voxels (srow, quatern or pixdim) must be finite")
    affine[:3] *= metres
    return affine


def _lines(data: bytes, separator: str, end: _typing.Callable[[str], bool], file: str) -> tuple[dict[str, str], int]:
    """Fields of a text header, and where it ends."""
    fields: dict[str, str] = {}
    at = 0
    while at < min(len(data), _HEADER):
        stop = data.find(b"\n", at, _HEADER)
        if stop < 0:
            stop = len(data)
        line = data[at:stop].decode("latin-1").strip()
        at = stop + 1
        if separator in line and not line.startswith("#"):
            key, value = line.split(separator, 1)
            fields[key.strip().lower()] = value.strip().lstrip("=").strip()
        if end(line):
            return fields, at
    return fields, len(data)


def _numbers(fields: dict[str, str], key: str, count: int, file: str, standard: _typing.Optional[str] = None) -> Array:
    words = fields.get(key, standard)
    if words is None:
        raise Error(f"{file}: the header has no field '{key}'")
    try:
        out = np.array([float(word) for word in words.replace("(", " ").replace(")", " ").replace(",", " ").replace("none", " ").split()])
    except ValueError:
        raise Error(f"{file}: {key} must be {count} numbers, got '{words[:60]}'") from None
    if len(out) != count or not np.isfinite(out).all():
        raise Error(f"{file}: {key} must be {count} finite numbers, got '{words[:60]}'")
    return out


def _sizes(fields: dict[str, str], key: str, file: str, axes: int = 3) -> list[int]:
    words = fields.get(key, "").split()
    if len(words) != axes or not all(word.isascii() and word.isdigit() and len(word) < 12 for word in words):
        raise Error(f"{file}: {key} must be {axes} whole numbers > 0 (one label per voxel), got '{fields.get(key, '')[:60]}'")
    return [int(word) for word in words]


def _beside(file: str, name: str) -> bytes:
    """Data in a file of their own, which must lie in the folder of its header."""
    if _os.path.basename(name) != name or not name:
        raise Error(f"{file}: the file of the voxels must lie beside the header, got '{name}'")
    return read_bytes(_os.path.join(_os.path.dirname(file), name))


@np.errstate(all="ignore")  # what is not finite is refused
def parse_nrrd(data: bytes, file: str) -> tuple[Array, Array, dict[int, str]]:
    """Array, affine [m] and 3D Slicer's names of segments."""
    if not data.startswith(b"NRRD"):
        raise Error(f"{file}: is not NRRD: it must begin with NRRD")
    fields, at = _lines(data, ":", lambda line: line == "", file)
    layers = fields.get("kinds", "").split()[:1] == ["list"]  # 3D Slicer's way to save segments that overlap
    shape = _sizes(fields, "sizes", file, 3 + layers)
    kind = _NRRD_TYPES.get(fields.get("type", "").lower())
    if kind is None:
        raise Error(f"{file}: type '{fields.get('type', '')[:40]}' is not one of labels")
    encoding = fields.get("encoding", "").lower()
    if encoding not in ("raw", "gzip", "gz"):
        raise Error(f"{file}: encoding must be raw or gzip, got '{encoding[:40]}'")
    body = _beside(file, fields["data file"]) if "data file" in fields else data[at:]
    count = _counted(shape, kind, len(body), encoding != "raw", file)
    raw = body if encoding == "raw" else _inflated(body, count, file)
    array = _voxels(raw, kind, ">" if fields.get("endian", "little").lower() == "big" else "<", shape, file)
    affine = np.eye(4)
    if "space directions" in fields:
        affine[:3, :3] = _numbers(fields, "space directions", 9, file).reshape(3, 3).T
        affine[:3, 3] = _numbers(fields, "space origin", 3, file, "0 0 0")
    else:
        affine[:3, :3] = np.diag(_numbers(fields, "spacings", 3, file, "1 1 1"))
    affine[:3] *= 1e-3
    space = fields.get("space", "right-anterior-superior").lower().replace("_", "-")
    if space in ("left-posterior-superior", "lps"):
        affine = _TO_RAS @ affine
    elif space not in ("right-anterior-superior", "ras"):
        raise Error(f"{file}: space must be left-posterior-superior or right-anterior-superior, got '{space[:40]}'")
    segments = _segments(fields)
    if not layers:
        return array, affine, {label: name for name, label, _ in segments}
    if len(segments) > MOST_LABELS:
        raise Error(f"{file}: a map may have {MOST_LABELS} segments, got {len(segments)}")
    flat = np.zeros(shape[1:], np.int32)
    for number, (_, label, layer) in enumerate(segments, 1):
        if layer >= shape[0]:
            raise Error(f"{file}: Segment{number - 1}_Layer must be below {shape[0]}, got {layer}")
        flat[array[layer] == label] = number
    return flat, affine, {number: name for number, (name, _, _) in enumerate(segments, 1)}


def _segments(fields: dict[str, str]) -> list[tuple[str, int, int]]:
    """Name, label and layer of each, in the order of the file: where segments overlap the last one counts, as in 3D Slicer's export."""
    out = []
    for key, name in fields.items():
        if key.startswith("segment") and key.endswith("_name"):
            label, layer = (fields.get(f"{key[:-5]}_{word}", standard) for word, standard in (("labelvalue", ""), ("layer", "0")))
            if all(word.isascii() and word.isdigit() and len(word) < 10 for word in (label, layer)):
                out.append((name, int(label), int(layer)))
    return out


@np.errstate(all="ignore")  # what is not finite is refused
def parse_meta(data: bytes, file: str) -> tuple[Array, Array]:
    """Array and affine [m] of MetaImage."""
    fields, at = _lines(data, "=", lambda line: line.lower().startswith("elementdatafile"), file)
    if "elementdatafile" not in fields:
        raise Error(f"{file}: is not MetaImage: it has no ElementDataFile")
    shape = _sizes(fields, "dimsize", file)
    kind = _META_TYPES.get(fields.get("elementtype", "").upper())
    if kind is None or fields.get("elementnumberofchannels", "1") != "1":
        raise Error(f"{file}: ElementType '{fields.get('elementtype', '')[:40]}' is not one of labels")
    if fields.get("binarydata", "True").lower() != "true":
        raise Error(f"{file}: BinaryData must be True")
    name = fields["elementdatafile"]
    body = data[at:] if name.upper() == "LOCAL" else _beside(file, name)
    packed = fields.get("compresseddata", "False").lower() == "true"
    count = _counted(shape, kind, len(body), packed, file)
    raw = _inflated(body, count, file) if packed else body
    big = (fields.get("binarydatabyteordermsb", fields.get("elementbyteordermsb", "False"))).lower() == "true"
    array = _voxels(raw, kind, ">" if big else "<", shape, file)
    affine = np.eye(4)
    turn = next((key for key in ("transformmatrix", "orientation", "rotation") if key in fields), "transformmatrix")
    affine[:3, :3] = _numbers(fields, turn, 9, file, "1 0 0 0 1 0 0 0 1").reshape(3, 3).T * _numbers(fields, "elementspacing", 3, file, "1 1 1")
    place = next((key for key in ("offset", "origin", "position") if key in fields), "offset")
    affine[:3, 3] = _numbers(fields, place, 3, file, "0 0 0")
    affine[:3] *= 1e-3
    return array, _TO_RAS @ affine


def _with_simpleitk(file: str) -> tuple[Array, Array]:
    from ._needs import need

    itk = need("SimpleITK", "SimpleITK", f"{file}: this kind of image")
    reader = itk.ImageFileReader()
    reader.SetFileName(file)
    try:
        reader.ReadImageInformation()
        size, channels = reader.GetSize(), reader.GetNumberOfComponents()
        if len(size) != 3 or channels != 1:
            raise Error(f"{file}: a label map must have 3 dimensions and one number per voxel, got {len(size)} and {channels}")
        if np.prod([float(n) for n in size]) * 8 > MOST_BYTES:
            raise Error(f"{file}: the header announces {' x '.join(map(str, size))} voxels; at most {MOST_BYTES // 8} are read")
        image = reader.Execute()
    except RuntimeError as problem:
        raise Error(f"{file}: SimpleITK cannot read it: {str(problem).strip().splitlines()[-1]}") from None
    affine = np.eye(4)
    affine[:3, :3] = np.array(image.GetDirection()).reshape(3, 3) * np.array(image.GetSpacing())
    affine[:3, 3] = image.GetOrigin()
    affine[:3] *= 1e-3
    return itk.GetArrayFromImage(image).transpose(2, 1, 0), _TO_RAS @ affine


def read_labels(file: str, names: _typing.Optional[_typing.Mapping[int, str]] = None) -> LabelMap:
    """A label map from a file. Names are those of `names`, else those in the file, else label_1, label_2, …"""
    file = str(file)
    lower = file.lower()
    known: dict[int, str] = {}
    if lower.endswith((".nii", ".nii.gz")):
        array, affine = parse_nifti(read_bytes(file), file)
    elif lower.endswith(".hdr"):
        array, affine = parse_nifti(read_bytes(file), file, read_bytes(file[:-4] + ".img"))
    elif lower.endswith((".nrrd", ".nhdr")):
        array, affine, known = parse_nrrd(read_bytes(file), file)
    elif lower.endswith((".mha", ".mhd")):
        array, affine = parse_meta(read_bytes(file), file)
    elif is_segmentation(data := read_bytes(file)):
        array, affine, known = read_segmentation(data, file, MOST_BYTES)
        affine = _TO_RAS @ affine
    else:
        array, affine = _with_simpleitk(file)
    return LabelMap(array, affine, names={**known, **dict(names or {})}, source=file)
