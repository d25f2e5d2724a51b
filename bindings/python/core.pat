# What nanobind's stubgen cannot see: the class that module.cpp makes with Python's own functions.
_core.__suffix__:
    class Error(ValueError):
        """What is wrong with the input, in one line that names object, field, bound and value."""
