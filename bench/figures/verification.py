"""`test_verification`: what the physics is held against, its bounds, and what was measured."""
import os

from .markdown import table


def common(sentences):
    """How many characters all sentences share at their beginning, up to a comma or colon: "cutting, "."""
    shared = os.path.commonprefix(list(sentences))
    return max(shared.rfind(", "), shared.rfind(": ")) + 2 if ", " in shared or ": " in shared else 0


def topic(data, name):
    """The figures of one file of tests/verification, as its lines say; equal lines share a row."""
    rows = {}
    for each in data["topics"][name]:
        digits = 2 if abs(each["value"]) < 0.1 else 4
        rows.setdefault((each["what"], each["bound"]), []).append(f'{each["value"]:.{digits}g}')
    skip = common(what for what, _ in rows)
    return table(["Quantity", "Bound", "Measured"],
                 [[what[skip:].replace("|", "\\|"), "-" if bound == "none" else bound, "; ".join(values)]
                  for (what, bound), values in rows.items()])


class Topics(dict):
    def __missing__(self, name):
        return lambda data: topic(data, name)


TABLES = Topics()
