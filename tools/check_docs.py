#!/usr/bin/env python3
"""Fail when the README's program is not examples/01_bunny, or a link in a page leads nowhere. Usage: check_docs.py <root>"""
import re
import sys
from pathlib import Path

root = Path(sys.argv[1])
bad = []
readme = (root / "README.md").read_text()
if (root / "examples/01_bunny/main.cpp").read_text().strip() not in readme:
    bad.append("README.md does not hold examples/01_bunny/main.cpp as it is")
for page in [*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("assets/**/*.md")]:
    prose = re.sub(r"```.*?```|`[^`]*`|^    .*$", "", page.read_text(), flags=re.S | re.M)  # a lambda is no link
    for target in re.findall(r"\]\(([^)#\s]+)", prose):
        if "://" not in target and not (page.parent / target).exists():
            bad.append(f"{page.relative_to(root)}: the link to {target} leads nowhere")
print("\n".join(bad))
sys.exit(bool(bad))
