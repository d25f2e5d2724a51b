"""Names of types. NumPy's own names of array types differ between its versions."""

from __future__ import annotations

import typing as _typing

Array = _typing.Any  # a numpy.ndarray
Tell = _typing.Callable[[str], None]  # is told what happens


def silent(line: str) -> None:
    """Tells nobody."""
