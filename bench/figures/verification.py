"""`test_verification`: what the physics is held against, its bounds, and what was measured."""
from .markdown import table


def bound_of(text):
    return "-" if text == "none" else text if " to " in text else f"at most {text}"


def topic(data, name):
    """The figures of one file of tests/verification, as its lines say; equal lines share a row."""
    rows = {}
    for each in data["topics"][name]:
        digits = 2 if abs(each["value"]) < 0.1 else 4
        rows.setdefault((each["what"], each["bound"]), []).append(f'{each["value"]:.{digits}g}')
    return table(["Quantity", "Bound", "Measured"],
                 [[what.replace("|", "\\|"), bound_of(bound), "; ".join(values)] for (what, bound), values in rows.items()])


class Topics(dict):
    def __missing__(self, name):
        return lambda data: topic(data, name)


TABLES = Topics()
