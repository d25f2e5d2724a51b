"""What is wrong with the arguments of a call, in one line; the C++ of the package asks for it (call_errors.cpp)."""

from __future__ import annotations

import ast
import re
import typing

from . import _core

_KINDS: dict[str, tuple[typing.Any, str]] = {
    "int": (lambda value: hasattr(value, "__index__") and not isinstance(value, bool), "a whole number"),
    "float": (lambda value: hasattr(value, "__float__") and not isinstance(value, (bool, str)), "a number"),
    "bool": (lambda value: isinstance(value, bool), "True or False"),
    "str": (lambda value: isinstance(value, str), "a text"),
    "dict": (lambda value: isinstance(value, dict), "a dict"),
    "None": (lambda value: value is None, "None"),
}
_LISTS = {"Sequence[str]": ("str", "a list of texts"), "Sequence[int]": ("int", "whole numbers"), "Sequence[float]": ("float", "numbers")}
_LONG = r"(?:collections\.abc|numpy\.typing|typing|filasofia(?:\._core)?)\."  # before names that are known without it


def _wrong(annotation: str, value: typing.Any) -> str | None:
    """What the value must be, if it is not: None if it may be right."""
    words = []
    for each in annotation.split(" | "):
        if each in _LISTS:
            member, kind = _LISTS[each]
            if isinstance(value, (list, tuple)):
                right = all(_KINDS[member][0](one) for one in value)
            else:
                right = hasattr(value, "__len__") and not isinstance(value, (str, bytes, dict))  # an array, perhaps
        elif each in _KINDS:
            fits, kind = _KINDS[each]
            right = fits(value)
        else:
            right = True  # a class, or anything: the function itself says what is wrong with it
        if right:
            return None
        words.append(kind)
    return " or ".join(words)


def _shown(value: typing.Any) -> str:
    try:
        words = " ".join(repr(value).split())
    except Exception:
        return f"a {type(value).__name__}"
    return words if len(words) <= 60 else words[:57] + "..."


def _parsed(signature: str) -> tuple[ast.arguments, str]:
    """The arguments of a signature of nanobind's, and as it is shown."""
    signature = re.sub(r"\\\d+", "...", re.sub(_LONG, "", signature))  # nanobind's defaults are numbers
    function = typing.cast(ast.FunctionDef, ast.parse(signature + ": ...").body[0])
    return function.args, f"({ast.unparse(function.args)})"


def explain(function: typing.Any, given: list[typing.Any], named: dict[str, typing.Any]) -> str:
    """The line for a call that nanobind has refused."""
    name = function.__name__
    if name.startswith("__"):
        name = function.__qualname__.split(".")[-2]  # the class, of a constructor or operator
    name = name.lstrip("_")  # what a function of the same name in Python passes on
    arguments, shown = _parsed(function.__nb_signature__[0][0])
    every = [*arguments.posonlyargs, *arguments.args]
    if every and every[0].arg == "self":
        every, given = every[1:], given[1:]
        shown = re.sub(r"^\(self(, /)?(, )?", "(", shown)
    known = [each.arg for each in every if each not in arguments.posonlyargs]
    if len(given) > len(every):
        most = f"at most {len(every)} argument{'s' if len(every) != 1 else ''}" if every else "no arguments"
        return f"{name}: takes {most}, got {len(given)}"
    for word in named:
        if word not in known:
            return f"{name} has no argument {word!r}{_core.did_you_mean_one_of(word, known)}"
        if word in known[: len(given)]:
            return f"{name}: {word} is given twice"
    values = dict(zip((each.arg for each in every), given)) | named
    needed = len(every) - len(arguments.defaults)
    for i, each in enumerate(every):
        if each.arg not in values:
            if i < needed:
                return f"{name}: {each.arg} is missing: it takes {shown}"
            continue
        must = _wrong(ast.unparse(each.annotation) if each.annotation else "object", values[each.arg])
        if must:
            return f"{name}: {each.arg} must be {must}, got {_shown(values[each.arg])}"
    for each, default in zip(every[needed:], arguments.defaults):
        value = values.get(each.arg)
        if isinstance(default, ast.Tuple) and isinstance(value, (list, tuple)) and len(value) != len(default.elts):
            return f"{name}: {each.arg} must be {len(default.elts)} numbers, got {_shown(value)}"
    for word, value in values.items():
        if isinstance(value, int) and not 0 <= value < 2**31:
            return f"{name}: {word} must be a whole number that C++ can hold, got {_shown(value)}"
        if isinstance(value, (list, tuple)) and any(isinstance(one, int) and abs(one) >= 2**31 for one in value):
            return f"{name}: {word} must have whole numbers below 2^31, got {_shown(value)}"
    got = ", ".join([*map(_shown, given), *(f"{word}={_shown(value)}" for word, value in named.items())])
    return f"{name}: takes {shown}, got ({got})"
