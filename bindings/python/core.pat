# What nanobind's stubgen cannot see: the class that module.cpp makes with Python's own functions.
_core.__suffix__:
    class Error(ValueError):
        """What is wrong with the input, in one line that names object, field, bound and value."""

# What stubgen writes less exactly than mypy --strict wants it.
_core\.(TetMesh|TriangleMesh)\.__reduce__$:
    def __reduce__(self) -> tuple[Any, ...]: ...

_core\.schema$:
    def schema() -> list[Any]:
        """The Defs in the order in which each needs those before it."""

_core\.set_classes$:
    def set_classes(arg: dict[str, Any], /) -> None: ...

_core\.StepFlag\.__str__$:

_core\.StepFlag\.__repr__$:
    def __repr__(self) -> str: ...
