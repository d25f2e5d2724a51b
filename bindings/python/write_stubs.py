"""Writes the stubs of what has no source: filasofia/_defs.pyi, from the fields() lists in the built module.

    write_stubs.py FOLDER_OF_THE_MODULE OUTPUT
"""
import sys
from pathlib import Path

sys.path.insert(0, sys.argv[1])
import _core  # noqa: E402  the built module, without its package

HEAD = '''"""Written by write_stubs.py."""
from typing import Any, Literal, Sequence
from typing_extensions import Self

from filasofia._core import TetMesh, TriangleMesh

Vec3 = Sequence[float]
Quat = Sequence[float]

class Def:
    def replace(this, /, **changes: Any) -> Self: ...
    def __eq__(self, other: object) -> bool: ...
    __hash__: None  # type: ignore[assignment]

class BodyId(int): ...
class AttachmentId(int): ...
class ShownId(int): ...
'''



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
    if read_as(typing) == typing:
        return [f"    {field}: {typing}", f'    """{text}"""']
    return [
        "    @property",
        f"    def {field}(self) -> {read_as(typing)}:",
        f'        """{text}"""',
        f"    @{field}.setter",
        f"    def {field}(self, value: {typing}) -> None: ...",
    ]


names = ["Def", *(name for name, _ in _core.schema()), "BodyId", "AttachmentId", "ShownId"]
lines = [HEAD, f"__all__ = {names}\n"]
for name, fields in _core.schema():
    lines.append(f"class {name}(Def):")
    for field, typing, bound, meaning in fields:
        lines += field_lines(field, typing, f'{bound}{". " if bound else ""}{meaning}')
    arguments = "".join(f", {field}: {typing} = ..." for field, typing, _, _ in fields)
    lines.append(f"    def __init__(this{arguments}) -> None: ...\n")
Path(sys.argv[2]).write_text("\n".join(lines))
