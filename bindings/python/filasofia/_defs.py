"""The Defs: one class for each struct of C++ that has a fields() list, made of that list when the package is imported.

A field is checked when it is set, and everything again when the Def is used: so a list may be changed in place.
"""

from __future__ import annotations

import copy as _copy
import inspect as _inspect

from . import _core


class Def:
    """What all Defs have in common: keywords, checked attributes, repr, ==, copy and pickle."""

    __slots__ = ()
    _number = -1
    _names: tuple[str, ...] = ()
    _index: dict[str, int] = {}

    def __init__(this, /, *values, **named):  # a field may be called self
        defaults = _core.defaults(this._number)
        for name, value in zip(this._names, defaults):
            object.__setattr__(this, name, value)
        if len(values) > len(this._names):
            raise TypeError(f"{type(this).__name__} has {len(this._names)} fields, got {len(values)} values")
        for name, value in zip(this._names, values):
            if name in named:
                raise TypeError(f"{type(this).__name__}: {name} is given twice")
            setattr(this, name, value)
        for name, value in named.items():
            if name not in this._index:
                raise TypeError(this._unknown(name))
            setattr(this, name, value)

    def __setattr__(self, name, value):
        index = self._index.get(name)
        if index is None:
            raise AttributeError(self._unknown(name))
        object.__setattr__(self, name, _core.check_field(self._number, index, value))

    def __delattr__(self, name):
        raise AttributeError(f"{type(self).__name__}: a field cannot be deleted, got {name}")

    @classmethod
    def _unknown(cls, name):
        return f"{cls.__name__} has no field '{name}'{_core.did_you_mean_one_of(name, list(cls._names))}"

    def replace(this, /, **changes):
        """A deep copy with other values of some fields."""
        made = _copy.deepcopy(this)
        for name, value in changes.items():
            setattr(made, name, value)
        return made

    __replace__ = replace  # copy.replace() of Python 3.13

    def __reduce__(self):  # for copy and pickle
        return _restored, (type(self), tuple(getattr(self, name) for name in self._names))

    def __repr__(self):
        defaults = zip(self._names, _core.defaults(self._number))
        given = [(name, getattr(self, name), default) for name, default in defaults]
        return f"{type(self).__name__}({', '.join(f'{n}={v!r}' for n, v, d in given if not v == d)})"

    def __eq__(self, other):
        if type(self) is not type(other):
            return NotImplemented
        return all(getattr(self, name) == getattr(other, name) for name in self._names)

    __hash__ = None  # its values may change


def _restored(kind, values):
    """Not checked, as some defaults are not legal: an empty Box."""
    made = kind.__new__(kind)
    for name, value in zip(kind._names, values):
        object.__setattr__(made, name, value)
    return made


class _Id(int):
    """A number that a simulation gives; it names nothing in another simulation."""

    __slots__ = ()

    def __repr__(self):
        return f"{type(self).__name__}({int(self)})"

    __str__ = __repr__


class BodyId(_Id):
    """Names a body."""

    __slots__ = ()


class AttachmentId(_Id):
    """Names an attachment."""

    __slots__ = ()


class ShownId(_Id):
    """Names what one call of Simulation.show() draws."""

    __slots__ = ()


def _doc(fields):
    lines = []
    for name, typing, bound, meaning in fields:
        lines.append(f"{name}: {typing}{', ' + bound if bound else ''}")
        lines.append(f"    {meaning}")
    return "\n".join(lines) if lines else "It has no fields."


class _Signature:
    """The signature of a Def with its defaults, for help() and inspect: made when it is asked for."""

    def __get__(self, _, owner):
        kind = _inspect.Parameter.POSITIONAL_OR_KEYWORD
        pairs = zip(owner._names, _core.defaults(owner._number))
        return _inspect.Signature([_inspect.Parameter(name, kind, default=value) for name, value in pairs])


def _made(number, name, fields):
    names = tuple(field[0] for field in fields)
    return type(
        name,
        (Def,),
        {
            "__slots__": names,
            "__module__": "filasofia",
            "__doc__": _doc(fields),
            "__match_args__": names,
            "__annotations__": {field[0]: field[1] for field in fields},
            "_number": number,
            "_names": names,
            "_index": {each: i for i, each in enumerate(names)},
            "__signature__": _Signature(),
        },
    )


_classes = {name: _made(number, name, fields) for number, (name, fields) in enumerate(_core.schema())}
for _id in (BodyId, AttachmentId, ShownId):
    _id.__module__ = "filasofia"
    _classes[_id.__name__] = _id
_core.set_classes(_classes)
globals().update(_classes)
__all__ = ["Def", *_classes]
