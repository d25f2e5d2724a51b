"""Packages that only this part of Filasofia needs. They are imported when they are used; if one is missing, one line says
what to install."""

from __future__ import annotations

import importlib as _importlib
import typing as _typing

from filasofia import Error


def need(module: str, package: str, purpose: str) -> _typing.Any:
    """The module, or an Error that says how to get it."""
    try:
        return _importlib.import_module(module)
    except ImportError:
        raise Error(f"{purpose} needs the package {package}: pip install {package} (or pip install 'filasofia[anatomy]')") from None


def scipy_ndimage() -> _typing.Any:
    return need("scipy.ndimage", "scipy", "meshing")
