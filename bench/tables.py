#!/usr/bin/env python3
"""Writes the tables of figures of the Markdown pages from the results in bench/results, or checks that they are what the results say.

Usage: tables.py --check|--write <root>     all pages of the repository
       tables.py --print NAME... FILE...    one table, e.g. --print solver steps bench/results/solver_2core_epyc.json

In a page a table lies between two comments, and the files are those of bench/results:

    <!-- table: solver steps solver_2core_epyc.json -->
    ...
    <!-- end -->

`limits FILE` and `source FILE` exist for every bench: the limits with their verdicts, and the machine with a link to the results.
--check also fails for a table of figures in docs/lab that has no results behind it, unless the text above it in its section, or in
the opening of the page, names in one sentence the command that printed it and the date.
"""
import importlib
import json
import os
import re
import sys
from itertools import zip_longest
from pathlib import Path

from figures.markdown import limits, wrapped

START, END = re.compile(r"<!-- table: (.+?) -->$"), "<!-- end -->"
WIDTH = 160  # characters of a line


def load(path):
    text = path.read_text(encoding="utf-8")
    return json.loads(text) if path.suffix == ".json" else text


def source(page, path, data):
    link = os.path.relpath(path, page.parent)
    return wrapped(f'Machine: {data["machine"]}. All figures: [{path.name}]({link}).')


def lines_of(words, page, results):
    """The table that a marker asks for."""
    names = [word for word in words if not re.search(r"\.(json|txt)$", word)]
    paths = [results / word for word in words if word not in names]
    data = [load(path) for path in paths]
    if names == ["source"]:
        return source(page, paths[0], data[0])
    if names == ["limits"]:
        return limits(data[0])
    module = importlib.import_module("figures." + names[0])
    return module.TABLES[" ".join(names[1:])](*data)


def blocks(lines):
    """(first line, end, words) of each table between markers; end is the index of the line that closes it."""
    for index, line in enumerate(lines):
        if match := START.match(line):
            end = next((i for i in range(index + 1, len(lines)) if lines[i] == END), None)
            yield index + 1, end, match.group(1).split()


def pages_of(root):
    return [*sorted(root.glob("*.md")), *sorted((root / "docs").rglob("*.md"))]


def is_figure(cell):
    return re.match(r"[-~<+]?[\d.]+", cell.strip("* ")) is not None


def is_figures(rows):
    """Is it a table of figures: at least half of what stands beside the first column are numbers."""
    cells = [cell.strip() for row in rows[2:] for cell in row.strip().strip("|").split("|")[1:]]
    filled = [cell for cell in cells if cell]
    return sum(map(is_figure, filled)) * 2 >= len(filled) > 0


def unsourced(lines, inside):
    """Lines at which a table of figures begins for which nothing says where the figures come from."""
    opening = section = ""
    at_top, fenced, index = True, False, 0
    while index < len(lines):
        line = lines[index]
        fenced ^= line.startswith("```")
        if line.startswith("## "):
            at_top, section = False, ""
        elif line.startswith("|") and not fenced:
            end = index
            while end < len(lines) and lines[end].startswith("|"):
                end += 1
            stated = any(re.search(r"`[^`]+`", text) and re.search(r"\d{4}-\d\d-\d\d", text) for text in (opening, section))
            if not any(first <= index < last for first, last in inside) and is_figures(lines[index:end]) and not stated:
                yield index
            index = end - 1
        elif at_top:
            opening += line + "\n"
        else:
            section += line + "\n"
        index += 1


def visit(page, root, write):
    """The findings of one page; writes its tables instead if asked to."""
    lines = page.read_text(encoding="utf-8").splitlines()
    out, last, findings, inside = [], 0, [], []
    name = page.relative_to(root)
    for first, end, words in blocks(lines):
        try:
            if end is None:
                raise KeyError(f"no '{END}' closes it")
            wanted = lines_of(words, page, root / "bench/results")
        except (OSError, ImportError, KeyError, TypeError, ValueError, IndexError) as error:
            findings.append(f"{name}:{first}: table '{' '.join(words)}': {type(error).__name__}: {error}")
            continue
        inside.append((first, end))
        findings += [f"{name}:{first}: a line of {len(line)} characters, at most {WIDTH}: {line[:60]}..."
                     for line in wanted if len(line) > WIDTH]
        if not write:
            findings += [f"{name}:{first + 1 + index}: has '{has}', the results give '{gives}'"
                         for index, (has, gives) in enumerate(zip_longest(lines[first:end], wanted, fillvalue="nothing"))
                         if has != gives]
        out += lines[last:first] + wanted
        last = end
    if write and out:
        page.write_text("\n".join(out + lines[last:]) + "\n", encoding="utf-8")
    if not write and name.parts[:2] == ("docs", "lab"):
        findings += [f"{name}:{index + 1}: a table of figures, but no command and date say where they come from"
                     for index in unsourced(lines, inside)]
    return findings


def main():
    if len(sys.argv) > 3 and sys.argv[1] == "--print":
        print("\n".join(lines_of(sys.argv[2:], Path.cwd() / "page.md", Path.cwd())))
        return 0
    if len(sys.argv) != 3 or sys.argv[1] not in ("--check", "--write"):
        sys.exit(__doc__)
    root = Path(sys.argv[2]).resolve()
    findings = [finding for page in pages_of(root) for finding in visit(page, root, sys.argv[1] == "--write")]
    print("\n".join(findings) or f"{sys.argv[1][2:]}: every table is what the results say")
    return bool(findings)


if __name__ == "__main__":
    sys.exit(main())
