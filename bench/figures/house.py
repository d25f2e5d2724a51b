"""`tools/house_figures.py`: figures of code and docs, before and after."""
from .markdown import table


def figures(before, after=None):
    """The second column stays empty until there is a second file. What only the second one has is added to the group."""
    after = after or {}

    def cell(data, group, name):
        value = data.get(group, {}).get(name, "")
        return f"{value:g}" if isinstance(value, float) else str(value)
    rows = []
    for group in dict.fromkeys([*before, *after]):
        for name in dict.fromkeys([*before.get(group, {}), *after.get(group, {})]):
            rows.append([f"{group}: {name}", cell(before, group, name), cell(after, group, name)])
    return table(["What", "Before", "After"], rows)


TABLES = {"figures": figures}
