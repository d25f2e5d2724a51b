"""filasofia mesh and filasofia scene new: python -m filasofia.anatomy does the same."""

from __future__ import annotations

import argparse
import os
import re
import sys
import time
import typing

import filasofia as fs
from filasofia import anatomy as _anatomy


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> typing.NoReturn:
        if "-o/--output" in message:
            message += ", for example: filasofia mesh liver.stl -o liver.msh"
        raise fs.Error(": ".join(filter(None, (self.prog.removeprefix("filasofia").strip(), message))))


def _length(word: str) -> float:
    found = re.fullmatch(r"([0-9.]+(?:e-?\d+)?)\s*(mm|cm|m)?", word)
    if not found or found[1].count(".") > 1:
        raise argparse.ArgumentTypeError(f"must be a length such as 4mm, got '{word}'")
    return float(found[1]) * {"mm": 1e-3, "cm": 1e-2}.get(found[2], 1.0)


def _parser() -> _Parser:
    parser = _Parser(prog="filasofia", description="From an image to an organ that moves.")
    commands = parser.add_subparsers(dest="command", required=True, parser_class=_Parser)
    mesh = commands.add_parser("mesh", help="tetrahedra of a label map, of surfaces or of another mesh")
    mesh.add_argument("-o", "--output", required=True, metavar="FILE.msh", help="the mesh, with organs as physical groups (Gmsh)")
    mesh.add_argument("--parts", metavar="FOLDER", help="also each organ's mesh, picture and collision surface, and report.json")
    scene = commands.add_parser("scene", help="scene files").add_subparsers(dest="action", required=True, parser_class=_Parser)
    new = scene.add_parser("new", help="a scene that runs, from a label map, surfaces or a mesh")
    new.add_argument("-o", "--output", metavar="FILE.json", help="the scene (default: INPUT.json in this folder)")
    new.add_argument("--separate", action="store_true", help="each organ is a body of its own, attached node to node")
    new.add_argument("--gravity", action="store_true", help="organs sag from the shape that the image shows")
    new.add_argument("--force", action="store_true", help="replaces the scene and its folder")
    for each in (mesh, new):
        each.add_argument("input", nargs="+", metavar="INPUT", help="a label map, a mesh of tetrahedra, or a surface for each organ")
        each.add_argument("--tetrahedra", type=int, metavar="N", help="about so many in all (default: 10000, or as many as the thinnest organ needs)")
        each.add_argument("--size", type=_length, metavar="LENGTH", help="size of the elements, such as 4mm, in place of a number")
        each.add_argument("--names", metavar="FILE", help="names of labels: an ITK-SNAP label file, or JSON")
        each.add_argument("--labels", metavar="LIST", help="only these, by number or name: 1,2,spleen")
        each.add_argument("--scale", type=float, metavar="UNIT", help="unit of a surface or mesh [m], 0.001 for millimetres")
        each.add_argument("--smoothing", type=float, default=0.8, metavar="VOXELS", help="smooths the voxels' stairs (default: 0.8)")
        each.add_argument("--picture", metavar="FILE.png", help="what went in beside what came out (needs OpenGL)")
        each.add_argument("--detail", type=int, default=2, choices=(0, 1, 2, 3), help="of what is drawn (default: 2)")
        each.add_argument("--quiet", action="store_true", help="no progress, no notes")
    return parser


def _made(words: argparse.Namespace, tell: typing.Callable[[str], None]) -> tuple[typing.Any, typing.Any, dict[str, str]]:
    for file in (words.output, words.picture):
        if file and not os.path.isdir(os.path.dirname(file) or "."):  # before the work, not after it
            raise fs.Error(f"{words.command}: the folder of '{file}' must exist")
    names, tissues = _anatomy.read_names(words.names) if words.names else ({}, {})
    made, map_ = _anatomy.anatomy_of(
        words.input, words.tetrahedra, size=words.size, scale=words.scale, names=names, smoothing=words.smoothing, tell=tell,
        labels=words.labels.split(",") if words.labels else None,
    )  # fmt: skip
    return made, map_, tissues


def _table(report: dict[str, typing.Any]) -> None:
    print(f"{'organ':24} {'tetrahedra':>10} {'volume':>10} {'error':>8} {'Hausdorff':>10} {'mean':>8}  angles")
    for name, each in report["organs"].items():
        error = 100.0 * (each["volume"] / each["wanted_volume"] - 1.0)
        print(
            f"{name[:24]:24} {each['tetrahedra']:10} {1e6 * each['volume']:7.2f} ml {error:+7.2f}% {1e3 * each['hausdorff']:7.2f} mm"
            f" {1e3 * each['mean_distance']:5.2f} mm  {each['least_angle']:.1f} to {each['largest_angle']:.1f} degrees"
        )


def _mesh(words: argparse.Namespace, tell: typing.Callable[[str], None]) -> None:
    if not words.output.lower().endswith(".msh"):
        raise fs.Error(f"mesh: --output must end with .msh, got '{words.output}'")
    made, map_, _ = _made(words, tell)
    report = _anatomy.write_anatomy(made, words.output, words.parts, words.detail)
    if words.picture:
        _anatomy.draw(made, map_, words.picture)
    _table(report)
    _notes(report["notes"], words.quiet)
    print(f"wrote {words.output}" + (f" and {words.parts}" if words.parts else ""))


def _scene(words: argparse.Namespace, tell: typing.Callable[[str], None]) -> None:
    file = words.output or re.sub(r"(\.nii|\.seg)?\.[A-Za-z0-9]+$", "", os.path.basename(words.input[0])) + ".json"
    if not words.force and os.path.exists(file):
        raise fs.Error(f"{file}: is already there; --force replaces it")
    made, map_, tissues = _made(words, tell)
    from ._write import report_of

    report = report_of(made)
    notes = _anatomy.write_scene(made, file, tissues, separate=words.separate, gravity=words.gravity, detail=words.detail, overwrite=words.force)
    if words.picture:
        _anatomy.draw(made, map_, words.picture)
    _table(report)
    _notes(report["notes"] + notes, words.quiet)
    print(f"wrote {file} and {file[:-5]}_files; it runs with: filasofia run {file}")


def _notes(notes: typing.Sequence[str], quiet: bool) -> None:
    for note in [] if quiet else notes:
        print(f"note: {note}")


def main(arguments: typing.Optional[typing.Sequence[str]] = None) -> int:
    start = time.monotonic()

    def tell(line: str) -> None:
        print(f"{time.monotonic() - start:6.1f} s  {line}", file=sys.stderr, flush=True)

    try:
        words = _parser().parse_args(arguments)
        (_mesh if words.command == "mesh" else _scene)(words, (lambda line: None) if words.quiet else tell)
    except fs.Error as problem:
        print(f"filasofia: {' '.join(str(problem).split())}", file=sys.stderr)
        return 2
    except MemoryError:
        print("filasofia: there is not enough memory; choose larger elements or fewer labels", file=sys.stderr)
        return 1
    except BrokenPipeError:
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
