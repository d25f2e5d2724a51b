"""Writes the stubs of what has no source: filasofia/_defs.pyi, from the fields() lists in the built module, and
filasofia/_core.pyi, from nanobind's stub: it takes NumPy's arrays, too, and knows which event a callback gets.

    write_stubs.py FOLDER_OF_THE_MODULE STUB_OF_NANOBIND OUTPUT_FOLDER
"""
import sys
from pathlib import Path

sys.path.insert(0, sys.argv[1])
import _core  # noqa: E402  the built module, without its package

HEAD = '''"""Written by write_stubs.py."""
from typing import Any, Literal, Sequence, TypedDict

from numpy.typing import NDArray
from typing_extensions import Self

from filasofia._core import Indices, Numbers, Rows, TetMesh, TriangleMesh

Vec3 = Numbers
Quat = Numbers

class Def:
    def replace(this, /, **changes: Any) -> Self: ...
    def __eq__(self, other: object) -> bool: ...
    __hash__: None  # type: ignore[assignment]

class BodyId(int): ...
class AttachmentId(int): ...
class ShownId(int): ...
'''

#: What the C++ takes for a list of numbers, in nanobind's stub.
CORE_HEAD = '''
Numbers = Sequence[float] | numpy.typing.NDArray[Any]
Indices = Sequence[int] | numpy.typing.NDArray[Any]
Rows = Sequence[Numbers] | numpy.typing.NDArray[Any]
Event = TypeVar("Event")

'''

CORE_CHANGES = (
    ("Sequence[Sequence[float]]", "Rows"),
    ("Sequence[float]", "Numbers"),
    ("Sequence[int]", "Indices"),
    ("Sequence[filasofia.NodalForce]", "Sequence[filasofia.NodalForce] | Rows"),
    ("event: type, callback: Callable[[Any], object]", "event: type[Event], callback: Callable[[Event], object]"),
)

KEYWORDS = ("PhysicsDef", "ShowDef", "MetricTrackerDef", "ReplayDef")  # functions take their fields by keyword


def core(stub: str) -> str:
    """The stub of nanobind with what its signatures do not say; an error if one of them is no longer there."""
    for old, new in CORE_CHANGES:
        if old not in stub:
            sys.exit(f"write_stubs.py: the stub of _core must have {old!r}, got none")
        stub = stub.replace(old, new)
    imports, first, rest = stub.partition("\nclass ")
    return imports.replace("from typing import ", "from typing import TypeVar, ", 1) + CORE_HEAD + first + rest


def taken(typing: str) -> str:
    """What a field takes: arrays, too."""
    for old, new in (("Sequence[Vec3]", "Rows"), ("Sequence[float]", "Numbers"), ("Sequence[int]", "Indices")):
        typing = typing.replace(old, new)
    return typing.replace("Sequence[Pose | Numbers]", "Sequence[Pose | Numbers] | NDArray[Any]")


def read_as(typing: str) -> str:
    """What a field gives; it takes more: any sequence for a list, numbers for a pose or a colour."""
    if typing in ("Vec3", "Quat"):
        return f"tuple[{', '.join(['float'] * (3 if typing == 'Vec3' else 4))}]"
    if typing.startswith("Sequence[") and " | " not in typing.split("]", 1)[1]:
        return f"list[{read_as(typing[len('Sequence['):-1])}]"
    if " | " not in typing or typing.startswith("Literal["):
        return typing
    return " | ".join(read_as(each) for each in typing.split(" | ") if each != "Sequence[float]")


def field_lines(field: str, typing: str, text: str) -> list[str]:
    """An attribute, or a property if what is read differs from what is taken."""
    if read_as(typing) == taken(typing):
        return [f"    {field}: {typing}", f'    """{text}"""']
    return [
        "    @property",
        f"    def {field}(self) -> {read_as(typing)}:",
        f'        """{text}"""',
        f"    @{field}.setter",
        f"    def {field}(self, value: {taken(typing)}) -> None: ...",
    ]


names = ["Def", *(name for name, _ in _core.schema()), "BodyId", "AttachmentId", "ShownId"]
lines = [HEAD, f"__all__ = {names}\n"]
for name, fields in _core.schema():
    lines.append(f"class {name}(Def):")
    for field, typing, bound, meaning in fields:
        lines += field_lines(field, typing, f'{bound}{". " if bound else ""}{meaning}')
    arguments = "".join(f", {field}: {taken(typing)} = ..." for field, typing, _, _ in fields)
    lines.append(f"    def __init__(this{arguments}) -> None: ...\n")
    if name in KEYWORDS:
        lines.append(f"class {name}Fields(TypedDict, total=False):")
        lines += [f"    {field}: {taken(typing)}" for field, typing, _, _ in fields] + [""]
folder = Path(sys.argv[3])
(folder / "_defs.pyi").write_text("\n".join(lines))
(folder / "_core.pyi").write_text(core(Path(sys.argv[2]).read_text()))
