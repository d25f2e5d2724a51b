"""What all tables share: cells, rows and limits in Markdown."""
import re
import textwrap

VERDICTS = {True: "met", False: "**missed**", None: "not judged"}
TERMS = {"the floor": "the lower bound", "the oracle": "the reference solver"}  # words of programs of that day


def table(head, rows):
    def line(cells):
        return "| " + " | ".join(cells) + " |"
    return [line(head), "|" + "---|" * len(head), *map(line, rows)]


def wrapped(text, first="", rest=""):
    return textwrap.wrap(text, 118, initial_indent=first, subsequent_indent=rest, break_long_words=False,
                         break_on_hyphens=False)


def ms(seconds, digits=3):
    return f"{1e3 * seconds:.{digits}f}"


def ratio(spread):
    """The median of the repetitions, with the lowest and the highest."""
    return f'{spread["median"]:.2f} ({spread["p1"]:.2f}-{spread["p99"]:.2f})'


def find(items, **wanted):
    """The first item whose fields have these values."""
    return next((item for item in items if all(item[key] == value for key, value in wanted.items())), None)


def terms(text):
    for old, new in TERMS.items():
        text = text.replace(old, new)
    return text


def limits(data):
    """The limits as the bench judged them: a list, because some are long."""
    lines = []
    for each in data["limits"]:
        measured = each["measured"].replace(";", ",")
        lines += wrapped(f'{VERDICTS[each["met"]]}: {terms(each["limit"])}; measured: {measured}', "- ", "  ")
    return lines


def verdict(data, *words):
    """One limit in a few words, "0.2 ms: **missed**": the limit whose sentence holds all of `words`."""
    each = next(each for each in data["limits"] if all(word in each["limit"] for word in words))
    bound = re.search(r"(?:at most|at least|within|<=|keeps) (?:the step of )?([\d.]+)( ms| %|/s)?", each["limit"])
    return f'{bound.group(1)}{bound.group(2) or ""}: {VERDICTS[each["met"]]}'
