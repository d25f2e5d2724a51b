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

names = ["Def", *(name for name, _ in _core.schema()), "BodyId", "AttachmentId", "ShownId"]
lines = [HEAD, f"__all__ = {names}\n"]
for name, fields in _core.schema():
    lines.append(f"class {name}(Def):")
    for field, typing, bound, meaning in fields:
        lines.append(f"    {field}: {typing}")
        lines.append(f'    """{bound}{". " if bound else ""}{meaning}"""')
    arguments = "".join(f", {field}: {typing} = ..." for field, typing, _, _ in fields)
    lines.append(f"    def __init__(this{arguments}) -> None: ...\n")
Path(sys.argv[2]).write_text("\n".join(lines))
