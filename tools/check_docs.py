#!/usr/bin/env python3
"""Fail when the README is longer than 600 words or its program is not examples/01_bunny, a link in a page leads
nowhere, a page names a path of the repository that does not exist, a source names a page that does not exist,
where-is-what.md names something that its file does not contain, or the guide's table lacks an elastic law.
Usage: check_docs.py <root>"""
import re
import sys
from pathlib import Path

root = Path(sys.argv[1])
bad = []
readme = (root / "README.md").read_text()
if (root / "examples/01_bunny/main.cpp").read_text().strip() not in readme:
    bad.append("README.md does not hold examples/01_bunny/main.cpp as it is")
if (words := len(readme.split())) > 600:
    bad.append(f"README.md has {words} words; 600 are enough")
for page in [*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("assets/**/*.md")]:
    text = page.read_text()
    prose = re.sub(r"```.*?```|`[^`]*`|^    [^\n]*$", "", text, flags=re.S | re.M)  # a lambda is no link
    for target in re.findall(r"\]\(([^)#\s]+)", prose):
        if "://" not in target and not (page.parent / target).exists():
            bad.append(f"{page.relative_to(root)}: the link to {target} leads nowhere")
    for path in re.findall(r"`((?:src|include|tests|apps|docs|examples)/[\w./-]+)`", text):
        if not (root / path).exists():
            bad.append(f"{page.relative_to(root)}: there is no {path}")
for folder in ("src", "include", "apps", "tests", "bench"):
    for source in [each for each in (root / folder).rglob("*") if each.suffix in {".h", ".cpp", ".py", ".txt"}]:
        for path in re.findall(r"\bdocs/[\w./-]+\.md\b", source.read_text()):
            if not (root / path).exists():
                bad.append(f"{source.relative_to(root)}: there is no {path}")
where = root / "docs/design/where-is-what.md"
for path, names in re.findall(r"^\|[^|]*\| `([^`]+)` \| (.*) \|$", where.read_text(), re.M):
    source = (root / path).read_text() if (root / path).is_file() else ""
    for name in re.findall(r"`(?:\w+::)*(\w+)`", names):
        if source and not re.search(rf"\b{name}\b", source):
            bad.append(f"{where.relative_to(root)}: {path} does not contain {name}")
laws = (root / "include/filasofia/physics/elastic_law.h").read_text()
for law in re.search(r"using ElasticLaw\s*=\s*std::variant<([^>]*)>", laws)[1].split(","):
    if not re.search(rf"^\| .*`{law.strip()}`", (root / "docs/guide/tissue.md").read_text(), re.M):
        bad.append(f"docs/guide/tissue.md: the table of laws lacks {law.strip()}")
print("\n".join(dict.fromkeys(bad)))
sys.exit(bool(bad))
