"""Which organ a label is, from a file of names, and what it is made of, from its name."""

from __future__ import annotations

import json as _json
import re as _re
import typing as _typing

from filasofia import Error

from ._read import read_bytes


class Kind(_typing.NamedTuple):
    """What an organ is: a tissue of the library or None, whether it is bone, and a note for what is not known."""

    tissue: _typing.Optional[str]
    bone: bool = False
    note: str = ""


NOMINAL_MODULUS = 10e3  # Pa, where no tissue of the library fits
_HOLLOW = "is a hollow organ that the map shows filled: the library has measured walls, not this"
# The first line with a word that the name contains decides. Words of the names of 3D Slicer, TotalSegmentator and others.
_KINDS: list[tuple[str, Kind]] = [
    ("cartilage", Kind("cartilage")),
    ("ligament tendon", Kind("ligament")),
    ("marrow", Kind(None)),
    ("myometri uterus", Kind("uterus")),
    ("cervix", Kind("cervix")),
    ("fibroid myoma", Kind("fibroid")),
    ("vertebra rib_ rib sacrum coccyx hip femur humerus scapula clavic sternum skull cranium mandib maxilla pelvis tibia fibula patella "
     "radius ulna bone spine teeth tooth", Kind(None, bone=True)),
    ("muscle gluteus autochthon iliopsoas psoas diaphragm", Kind("skeletal_muscle")),
    ("fat adipos", Kind("adipose")),
    ("artery_wall aorta_wall", Kind("artery_media")),
    ("vein_wall", Kind("vein")),
    ("bladder_wall", Kind("bladder")),
    ("colon_wall", Kind("colon")),
    ("bowel_wall", Kind("small_bowel")),
    ("stomach_wall", Kind("stomach")),
    ("gallbladder bladder stomach colon bowel duodenum esophag oesophag trachea aorta arter vein vena vessel heart atrium ventricle rectum", Kind(None, note=_HOLLOW)),
    ("kidney", Kind("kidney")),
    ("liver hepat", Kind("liver")),
    ("spleen", Kind("spleen")),
    ("lung", Kind("lung")),
    ("gray_matter grey_matter cortex", Kind("brain_grey")),
    ("brain white_matter cerebr", Kind("brain_white")),
]  # fmt: skip


def plain(name: str) -> str:
    """Lower case, words joined by _, as file names and names of bodies like it."""
    return _re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_") or "organ"


def kind_of(name: str) -> Kind:
    """What an organ of this name is made of."""
    short = "_" + plain(name) + "_"
    for words, kind in _KINDS:
        if any("_" + word in short for word in words.split()):
            return kind
    return Kind(None, note="is not a name that the tissue library is known to fit")


def read_names(file: str) -> tuple[dict[int, str], dict[str, str]]:
    """Names by label and tissues by name, from an ITK-SNAP label file or from JSON: {"1": "liver"} or {"1": {"name": "liver", "tissue": "liver"}}."""
    try:
        text = read_bytes(file).decode("utf-8")
    except UnicodeDecodeError:
        raise Error(f"{file}: must be text in UTF-8") from None
    names: dict[int, str] = {}
    tissues: dict[str, str] = {}
    if text.lstrip().startswith("{"):
        try:
            given = _json.loads(text)
        except (ValueError, RecursionError) as problem:
            raise Error(f"{file}: is not JSON: {problem}") from None
        for key, value in given.items():
            name = value.get("name") if isinstance(value, dict) else value
            if not (key.isascii() and key.isdigit()) or len(key) > 9 or not isinstance(name, str) or not name:
                raise Error(f"{file}: '{key[:40]}' must be a label, a whole number, with a name")
            names[int(key)] = name
            tissue = value.get("tissue") if isinstance(value, dict) else None
            if tissue is not None:
                tissues[name] = str(tissue)
        return names, tissues
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        found = _re.match(r'\s*(\d{1,9})\s.*"(.+)"\s*$', line)
        if not found:
            raise Error(f'{file}:{number}: a line of an ITK-SNAP label file has a label, seven numbers and a "name", got \'{line.strip()[:60]}\'')
        names[int(found[1])] = found[2]
    return names, tissues
