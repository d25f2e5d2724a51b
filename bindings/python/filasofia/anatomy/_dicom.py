"""Segmentations in DICOM (SEG), binary, fractional or label maps, by highdicom. What other programs of a hospital exchange."""

from __future__ import annotations

import io as _io
import typing as _typing

import numpy as np

from filasofia import Error

from ._needs import need
from ._types import Array

_SEGMENTATIONS = (b"1.2.840.10008.5.1.4.1.1.66.4", b"1.2.840.10008.5.1.4.1.1.66.7")  # storage classes: segments, label map


def is_segmentation(data: bytes) -> bool:
    """Whether a file begins like a DICOM-SEG: the storage class is among the first elements (PS3.10, 7.1)."""
    return data[128:132] == b"DICM" and any(uid in data[:1024] for uid in _SEGMENTATIONS)


def read_segmentation(data: bytes, file: str, most_bytes: int) -> tuple[Array, Array, dict[int, str]]:
    """Array, affine [m] in the patient's axes of DICOM (left, back, head), and the segments' names."""
    dicom = need("highdicom", "highdicom", f"{file}: a DICOM-SEG")
    try:
        segmentation = dicom.seg.segread(_io.BytesIO(data))
        geometry = segmentation.get_volume_geometry()
        if geometry is None:
            raise Error(f"{file}: its frames are no regular stack of slices; export it as a label map")
        fractional = str(segmentation.segmentation_type.value) == "FRACTIONAL"
        numbers = [int(n) for n in segmentation.segment_numbers]
        each = 4.0 * len(numbers) if fractional else 2.0
        if np.prod([float(n) for n in geometry.spatial_shape]) * each > most_bytes:
            sizes = " x ".join(map(str, geometry.spatial_shape))
            raise Error(f"{file}: {sizes} voxels of {len(numbers)} segments are announced; at most {most_bytes} bytes are read")
        if fractional:
            array = _most_likely(np.asarray(segmentation.get_volume(combine_segments=False).array), numbers)
        else:
            array = np.asarray(segmentation.get_volume(combine_segments=True).array)
        affine = np.array(geometry.affine, float)
        names = _names(segmentation, numbers)
    except Error:
        raise
    except Exception as problem:  # pydicom and highdicom raise many kinds for damaged files
        said = (str(problem).strip().splitlines() or [""])[0][:200]
        if "overlap" in said.lower():
            raise Error(f"{file}: its segments overlap; export them as a label map") from None
        raise Error(f"{file}: highdicom cannot read it: {type(problem).__name__}: {said}") from None
    affine[:3] *= 1e-3
    return array, affine, names


def _most_likely(shares: Array, numbers: list[int]) -> Array:
    """The segment with the largest share of a voxel, if that is half of it."""
    best = shares.argmax(axis=-1)
    largest = np.take_along_axis(shares, best[..., None], axis=-1)[..., 0]
    return np.where(largest >= 0.5, np.asarray(numbers, np.int32)[best], 0)


def _names(segmentation: _typing.Any, numbers: list[int]) -> dict[int, str]:
    """Labels of the segments; two kidneys that are both called so get their numbers."""
    given = {n: str(segmentation.get_segment_description(n).segment_label).strip() for n in numbers if n}
    words = list(given.values())
    return {n: name if words.count(name) == 1 else f"{name}_{n}" for n, name in given.items()}
