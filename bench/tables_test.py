#!/usr/bin/env python3
"""Tests bench/tables.py on pages made up here: what differs is found, what is written is accepted."""
import json
import tempfile
from pathlib import Path

import tables

RESULTS = {"bench": "made up", "machine": "none", "limits": [{"limit": "a step takes at most 2 ms", "met": False, "measured": "highest 3 ms"}]}
PAGE = "# Page\n\n<!-- table: limits made_up.json -->\n{}\n<!-- end -->\n"
GOOD = "- **missed**: a step takes at most 2 ms; measured: highest 3 ms"


def findings(text, write=False):
    """What tables.py says of a page of docs/lab with this text, and the page after it."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        (root / "bench/results").mkdir(parents=True)
        (root / "docs/lab").mkdir(parents=True)
        (root / "bench/results/made_up.json").write_text(json.dumps(RESULTS))
        page = root / "docs/lab/page.md"
        page.write_text(text)
        return tables.visit(page, root, write), page.read_text()


def main():
    assert findings(PAGE.format(GOOD))[0] == []
    found = findings(PAGE.format(GOOD.replace("3 ms", "1 ms")))[0]
    assert len(found) == 1 and found[0].startswith("docs/lab/page.md:4: has "), found
    assert findings(PAGE.format("stale\nlines"), write=True) == ([], PAGE.format(GOOD))
    assert len(findings(PAGE.format(GOOD).replace("limits", "nothing"))[0]) == 1, "an unknown table"
    assert len(findings(PAGE.format(GOOD).replace("made_up", "lost"))[0]) == 1, "a file that is not there"
    assert len(findings(PAGE.format(GOOD).replace("<!-- end -->", ""))[0]) == 1, "a table that nothing closes"
    figures = "# Page\n\n{}\n\n## Part\n\n| scene | [ms] |\n|---|---|\n| one | 1.5 |\n"
    assert len(findings(figures.format("By nobody."))[0]) == 1, "figures without a source"
    assert findings(figures.format("Printed by `a program` on 2026-11-22."))[0] == []
    assert findings(figures.format("Words.").replace("1.5", "none"))[0] == [], "a table of words needs no source"


main()
