"""A scene file of an anatomy: organs with tissues, bones that are fixed, what neighbours share, a camera and an instrument."""

from __future__ import annotations

import os as _os
import typing as _typing

import numpy as np

import filasofia as _fs

from . import _shapes
from ._anatomy import Anatomy
from ._names import NOMINAL_MODULUS, Kind, kind_of, plain
from ._types import Array
from ._write import file_names, write_json, write_msh, write_obj

Json = _typing.Dict[str, _typing.Any]

_HELD_SHARE = 0.06  # of the height of a body that nothing holds: so much of its back is held
_COLOURS = [
    ("liver hepat", (0.42, 0.13, 0.10)), ("gallbladder", (0.25, 0.36, 0.14)), ("spleen", (0.36, 0.10, 0.16)), ("kidney", (0.45, 0.18, 0.14)),
    ("aorta arter", (0.60, 0.12, 0.10)), ("vein vena portal", (0.22, 0.22, 0.48)), ("lung", (0.72, 0.45, 0.45)), ("heart", (0.52, 0.14, 0.12)),
    ("stomach", (0.70, 0.42, 0.36)), ("colon bowel duodenum", (0.68, 0.44, 0.38)), ("fat adipos skin", (0.80, 0.62, 0.34)), ("brain", (0.70, 0.56, 0.52)),
    ("bladder", (0.66, 0.50, 0.40)), ("pancreas", (0.72, 0.52, 0.34)), ("muscle psoas gluteus", (0.50, 0.16, 0.13)),
]  # fmt: skip


class Plan(_typing.NamedTuple):
    """What each organ is, and notes for what had to be assumed."""

    kinds: dict[str, Kind]
    notes: list[str]


def plan_of(anatomy: Anatomy, tissues: _typing.Mapping[str, str]) -> Plan:
    known = [each.name for each in _fs.tissues()]
    kinds, notes = {}, []
    for name in anatomy.names.values():
        kind = kind_of(name)
        if name in tissues:
            if tissues[name] not in (*known, "bone"):
                raise _fs.Error(f"organ '{name}': there is no tissue '{tissues[name]}'; there are bone, {', '.join(known)}")
            kind = Kind(None, bone=True) if tissues[name] == "bone" else Kind(tissues[name])
        if kind.note or (kind.tissue is None and not kind.bone):
            notes.append(f"'{name}' {kind.note or 'has no tissue in the library'}; it gets {NOMINAL_MODULUS / 1e3:g} kPa: change it in the scene")
        kinds[name] = kind
    return Plan(kinds, notes)


def _constants(kind: Kind) -> Json:
    if kind.tissue is None:
        return {"youngModulus": NOMINAL_MODULUS, "poissonRatio": 0.45, "density": 1050.0}
    tissue = _fs.tissue(kind.tissue)
    return {"youngModulus": tissue.material.young_modulus, "poissonRatio": tissue.material.poisson_ratio, "density": tissue.density}


def _material(names: list[str], plan: Plan) -> Json:
    """The first organ gives the law, the others are regions that differ in stiffness and density."""
    first = plan.kinds[names[0]]
    out: Json = {"tissue": first.tissue} if first.tissue else {k: v for k, v in _constants(first).items() if k != "density"}
    regions = [{"where": {"type": "Labelled", "name": name}, **_constants(plan.kinds[name])} for name in names[1:]]
    return {**out, "regions": regions} if regions else out


def _show(name: str, surface: str, bone: bool) -> Json:
    if bone:
        return {"surface": surface, "material": "BoneMaterial"}
    colour = colour_of(name)
    return {"surface": surface, "material": {"baseColor": list(colour), "subsurfaceColor": [0.8 * c for c in colour]}}


def colour_of(name: str) -> tuple[float, float, float]:
    return next((c for words, c in _COLOURS if any(word in plain(name) for word in words.split())), (0.62, 0.38, 0.30))


def groups_of(anatomy: Anatomy, plan: Plan, separate: bool) -> list[list[str]]:
    """Soft organs that hang together, the largest first; each for itself if `separate`."""
    soft = [name for name in anatomy.names.values() if not plan.kinds[name].bone]
    volume = {name: float(_shapes.volumes(anatomy.nodes, anatomy.tetrahedra[anatomy.labels == anatomy.label(name)]).sum()) for name in soft}
    soft.sort(key=lambda name: -volume[name])
    part = {name: name for name in soft}
    for first, second in anatomy.neighbours() if not separate else []:
        if first in part and second in part and part[first] != part[second]:
            old, new = part[second], part[first]
            part = {name: new if at == old else at for name, at in part.items()}
    out: dict[str, list[str]] = {}
    for name in soft:
        out.setdefault(part[name], []).append(name)
    return list(out.values())


def _attachments(anatomy: Anatomy, name: str, numbers: Array, placed: list[tuple[str, Array, bool]], notes: list[str]) -> list[Json]:
    """Shared nodes are attached to the bodies that are already there, each to one of them: it is the same place. A body that
    nothing holds is held in space, at its back."""
    taken, out = np.zeros(len(numbers), bool), []
    for other, theirs, rigid in placed:
        _, i, j = np.intersect1d(numbers, theirs, return_indices=True)
        free = ~taken[i]
        taken[i] = True
        if free.any():
            pairs = {} if rigid else {"toNodes": j[free].tolist()}
            out.append({"to": other, "nodes": i[free].tolist(), **pairs})
    # Three nodes that touch something somewhere hold no organ.
    if taken.sum() < 4:
        y = anatomy.nodes[numbers, 1]
        held = np.flatnonzero((y <= y.min() + _HELD_SHARE * (y.max() - y.min())) & ~taken)
        notes.append(f"'{name}' touches nothing that holds it: {len(held)} nodes at its back are held in space")
        out.append({"nodes": held.tolist()})
    return out


def scene_of(anatomy: Anatomy, folder: str, tissues: _typing.Mapping[str, str], separate: bool, detail: int, gravity: bool) -> tuple[Json, list[str]]:
    """The scene, and what had to be assumed. Writes the meshes into `folder`."""
    plan = plan_of(anatomy, tissues)
    stems, beside = file_names(anatomy), _os.path.basename(folder)
    bodies: list[Json] = []
    placed: list[tuple[str, Array, bool]] = []
    for name, kind in plan.kinds.items():
        write_obj(_os.path.join(folder, stems[name] + ".obj"), anatomy.picture(name, detail))
        if kind.bone:
            bodies.append(_bone(anatomy, name, folder, stems[name], beside))
            placed.append((name, anatomy.organ(name).numbers, True))
    for names in groups_of(anatomy, plan, separate):
        mine = np.isin(anatomy.labels, [anatomy.label(name) for name in names])
        nodes, tetrahedra, numbers = _shapes.compact(anatomy.nodes, anatomy.tetrahedra[mine])
        stem = stems[names[0]] + ("_and_neighbours" if len(names) > 1 else "")
        write_msh(_os.path.join(folder, stem + ".msh"), nodes, tetrahedra, anatomy.labels[mine], {anatomy.label(name): name for name in names})
        body: Json = {"name": stem, "mesh": f"{beside}/{stem}.msh", "material": _material(names, plan)}
        if plan.kinds[names[0]].tissue is None:
            body["mass"] = {"type": "Density", "value": 1050.0}
        if not gravity:
            body["gravity"] = False  # the image shows the organs as they lie: their weight is in their shape
        body["attachments"] = _attachments(anatomy, stem, numbers, placed, plan.notes)
        body["collision"] = [{}]
        body["show"] = [_show(name, f"{beside}/{stems[name]}.obj", False) for name in names]
        placed.append((stem, numbers, False))
        bodies.append(body)
    return _around(anatomy, bodies), plan.notes


def _bone(anatomy: Anatomy, name: str, folder: str, stem: str, beside: str) -> Json:
    write_obj(_os.path.join(folder, stem + "_collision.obj"), anatomy.collision(name))
    body = {"type": "RigidBodyDef", "name": name, "elements": [[0, 0, 0]], "mesh": f"{beside}/{stem}_collision.obj", "collision": [{}]}
    return {**body, "show": [_show(name, f"{beside}/{stem}.obj", True)]}


def _around(anatomy: Anatomy, bodies: list[Json]) -> Json:
    low, high = anatomy.nodes.min(axis=0), anatomy.nodes.max(axis=0)
    middle, room = 0.5 * (low + high), high - low
    radius = min(0.004, 0.05 * float(room.max()))
    length = 7.5 * radius
    tip = [float(middle[0]), float(high[1] + max(0.25 * room.max(), 0.5 * length + 2.0 * radius)), float(middle[2])]
    return {
        "window": {"title": "Patient"},
        "look": {"around": [low.tolist(), high.tolist()], "direction": [0.35, 1.0, -0.75]},
        "bodies": [
            *bodies,
            {
                "type": "RigidBodyDef", "name": "probe", "elements": [tip], "mesh": {"type": "capsule", "radius": radius, "length": length},
                "dynamic": True, "mass": {"type": "TotalMass", "value": 0.05}, "gravity": False, "collision": [{}],
                "show": [{"material": "MetalMaterial"}],
            },
        ],
        "haptics": [{"body": "probe", "coupling": {"linearStiffness": 400}}],
    }  # fmt: skip


def write_scene(
    anatomy: Anatomy,
    file: str,
    tissues: _typing.Optional[_typing.Mapping[str, str]] = None,
    *,
    separate: bool = False,
    gravity: bool = False,
    detail: int = 2,
    overwrite: bool = False,
) -> list[str]:
    """Writes a scene file and its folder of meshes. Organs that touch are one body with regions; with `separate` each is
    a body of its own, attached node to node. An image shows organs as they lie, so gravity does not act again, unless
    `gravity` says so. Returns what had to be assumed."""
    if not file.lower().endswith(".json"):
        raise _fs.Error(f"{file}: a scene file must end with .json")
    folder = file[:-5] + "_files"
    for path in (file, folder):
        if _os.path.exists(path) and not overwrite:
            raise _fs.Error(f"{path}: is already there; --force (overwrite=True) replaces it")
    try:
        _os.makedirs(folder, exist_ok=True)
    except OSError as problem:
        raise _fs.Error(f"{folder}: {problem.strerror or problem}") from None
    scene, notes = scene_of(anatomy, folder, dict(tissues or {}), separate, detail, gravity)
    write_json(file, scene)
    return notes
