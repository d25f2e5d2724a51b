"""Where lines of the log go, and how reports print themselves."""

from __future__ import annotations

import sys as _sys
import typing as _typing

from . import _core

if _typing.TYPE_CHECKING:
    import logging


def log_to(receiver: logging.Logger | _typing.Callable[[int, str], object] | None) -> None:
    """Sends the lines of the log to a logger of `logging`, or to a function of level and line, not to standard error.

    Levels are those of `logging`: INFO, WARNING, ERROR. Python's main thread takes the lines, in their order, as soon
    as it is not inside a call of the engine. If the function raises, its line and the exception go to standard error.
    None: standard error again.

        fs.log_to(logging.getLogger("filasofia"))
        fs.log_to(lambda level, line: None)      # nothing is told
    """
    import logging  # here, because it is slow to import

    if isinstance(receiver, logging.Logger):
        logger = receiver
        _core._log_to(lambda level, line: logger.log(level, "%s", line))  # type: ignore[attr-defined]
    elif receiver is None or callable(receiver):
        _core._log_to(None if receiver is None else _careful(receiver))  # type: ignore[attr-defined]
    else:
        raise TypeError(f"log_to: the receiver must be a logging.Logger, a function or None, got {receiver!r}")


def _careful(receiver: _typing.Callable[[int, str], object]) -> _typing.Callable[[int, str], None]:
    """A receiver that loses no line: what it was called for may be an error of the engine."""

    def take(level: int, line: str) -> None:
        try:
            receiver(level, line)
        except Exception as problem:
            said = f"log_to: {receiver!r} raised {type(problem).__name__}: {problem}; the line was: {line}"
            print(f"filasofia: {said}", file=_sys.stderr)

    return take


def _report_repr(report: _typing.Any) -> str:
    names = [name for name, each in vars(type(report)).items() if isinstance(each, property)]
    return f"{type(report).__name__}({', '.join(f'{name}={getattr(report, name)!r}' for name in names)})"


# Reports, events and states print their fields. What asks a simulation for them may raise, and does not.
_LIVE = (
    _core.Simulation,
    _core.ArticulatedInstrument,
    _core.ClipApplier,
    _core.Endoscope,
    _core.InstrumentTie,
    _core.KnotHands,
    _core.Laparoscope,
    _core.LaparoscopicInstrument,
    _core.SpecimenBag,
    _core.SuctionIrrigator,
    _core.TrocarHands,
    _core.UltrasonicShears,
    _core.WireLoop,
)
for _each in vars(_core).copy().values():
    if isinstance(_each, type) and _each.__repr__ is object.__repr__ and _each not in _LIVE:  # type: ignore[comparison-overlap]
        _each.__repr__ = _report_repr  # type: ignore[assignment]
log_to.__module__ = "filasofia"
