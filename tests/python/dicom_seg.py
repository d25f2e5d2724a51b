"""Writes a label map as DICOM-SEG with highdicom, on top of the empty slices of a CT."""
import highdicom
import numpy as np
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.sr.codedict import codes
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid


def slices(map_):
    """One image per k; axes in millimetres to the left, the back and the head."""
    affine = np.diag([-1e3, -1e3, 1e3, 1.0]) @ map_.affine
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    study, series, frame = generate_uid(), generate_uid(), generate_uid()
    for k in range(map_.array.shape[2]):
        image = Dataset()
        image.file_meta = FileMetaDataset()
        image.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
        image.SOPClassUID, image.SOPInstanceUID = CTImageStorage, generate_uid()
        image.StudyInstanceUID, image.SeriesInstanceUID, image.FrameOfReferenceUID = study, series, frame
        image.PatientName, image.PatientID, image.PatientBirthDate, image.PatientSex = "Phantom^A", "1", "20000101", "O"
        image.StudyDate, image.StudyTime, image.StudyID, image.AccessionNumber = "20260101", "000000", "1", "1"
        image.ReferringPhysicianName, image.Manufacturer, image.PositionReferenceIndicator = "", "none", None
        image.Modality, image.SeriesNumber, image.InstanceNumber = "CT", 1, k + 1
        image.Columns, image.Rows = map_.array.shape[:2]
        image.PixelSpacing, image.SliceThickness = [float(spacing[1]), float(spacing[0])], float(spacing[2])
        image.ImageOrientationPatient = [*(affine[:3, 0] / spacing[0]), *(affine[:3, 1] / spacing[1])]
        image.ImagePositionPatient = [*(affine[:3, 2] * k + affine[:3, 3])]
        image.SamplesPerPixel, image.PhotometricInterpretation, image.PixelRepresentation = 1, "MONOCHROME2", 0
        image.BitsAllocated, image.BitsStored, image.HighBit = 16, 16, 15
        image.PixelData = np.zeros((image.Rows, image.Columns), np.uint16).tobytes()
        yield image


def write(map_, file, kind, names=None, overlap=False):
    """`kind` is BINARY, FRACTIONAL or LABELMAP. With `overlap` the first segment covers the second, too."""
    names = names or map_.names
    segments = [highdicom.seg.SegmentDescription(n, names[label], codes.SCT.Organ, codes.SCT.Liver, "MANUAL") for n, label in enumerate(map_.labels, 1)]
    voxels = map_.array.transpose(2, 1, 0)
    shares = np.stack([voxels == label for label in map_.labels], -1)
    shares[..., 0] |= shares[..., 1] & overlap
    pixels = {
        "BINARY": lambda: shares.astype(np.uint8),
        "FRACTIONAL": lambda: 0.8 * shares.astype(np.float32),
        "LABELMAP": lambda: (shares * np.arange(1, len(map_.labels) + 1)).sum(-1).astype(np.uint8),
    }[kind]()
    highdicom.seg.Segmentation(
        list(slices(map_)), pixels, kind, segments, generate_uid(), 2, generate_uid(), 1, "none", "none", "1", "1"
    ).save_as(file)  # fmt: skip
