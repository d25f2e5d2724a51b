#!/usr/bin/env python3
"""Fail when comments or docs leave the house's English: sentences that begin with "Of", too few "if", long sentences or lines.

Usage: check_prose.py <root> [<path> ...]
Without paths it judges the whole tree against the bounds. With paths it prints the figures of those files and where each
finding stands; the ratios are then shown and not judged, as a single file may be too short for them.
"""
import re
import sys
from pathlib import Path

OF_PER_10K = 3        # sentences that begin with "Of"
IF_PER_10K = 40       # occurrences of "if"
DOC_LINE = 160        # characters
DOC_SENTENCE = 40     # words
CODE_FOLDERS = ("src", "include", "apps", "tests", "examples", "bench", "bindings")
WORD = re.compile(r"[A-Za-z][A-Za-z'’-]*")
TOKEN = re.compile(r'R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|//[^\n]*|/\*.*?\*/', re.S)


def code_prose(text):
    """(line, paragraph) of every comment; neighbouring lines of whole-line comments are one paragraph."""
    paragraphs, last = [], None
    for match in TOKEN.finditer(text):
        comment = match.group()
        if not comment.startswith("/"):
            continue
        line = text.count("\n", 0, match.start()) + 1
        whole = text[text.rfind("\n", 0, match.start()) + 1:match.start()].strip() == ""
        words = re.sub(r"^/[/*]+<?|\*/$", "", comment).strip()
        if not words:
            last = None
        elif whole and last == line - 1:
            paragraphs[-1][1] += " " + words
            last = line
        else:
            paragraphs.append([line, words])
            last = line if whole else None
    return paragraphs


def doc_prose(text):
    """(line, paragraph) of a Markdown page: without code, one paragraph for each list item and each cell of a table."""
    paragraphs, fenced, open_paragraph = [], False, False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced, open_paragraph = not fenced, False
            continue
        if fenced or (line.startswith("    ") and not open_paragraph):
            continue
        stripped = line.strip()
        if stripped.startswith("|"):
            paragraphs += [[number, cell.strip()] for cell in stripped.strip("|").split("|") if cell.strip(" -:")]
            open_paragraph = False
        elif not stripped or stripped.startswith(("#", "![")):
            open_paragraph = False
        elif open_paragraph and not re.match(r"([-*+]|\d+\.)\s", stripped):
            paragraphs[-1][1] += " " + stripped
        else:
            paragraphs.append([number, re.sub(r"^([-*+]|\d+\.)\s+", "", stripped)])
            open_paragraph = True
    return paragraphs


def plain(paragraph):
    paragraph = re.sub(r"`[^`]*`", "code", paragraph)
    paragraph = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", paragraph)
    paragraph = re.sub(r"[*_]{1,2}", "", paragraph)
    return re.sub(r"\b(e\.g|i\.e|cf|vs|et al|Fig|Eq|approx)\.", r"\1", paragraph)


def sentences(paragraph):
    return [s for s in re.split(r"(?<=[.!?;:])\s+", plain(paragraph)) if WORD.search(s)]


def judge(path, root, is_doc):
    """Words, ifs, and the findings [(kind, line, text)] of one file."""
    text = path.read_text()
    words = ifs = 0
    findings = []
    for line, paragraph in (doc_prose if is_doc else code_prose)(text):
        here = WORD.findall(plain(paragraph))
        words += len(here)
        ifs += sum(word.lower() == "if" for word in here)
        for sentence in sentences(paragraph):
            if re.match(r"(\[[^\]]*\])?[\W_]*of\b", sentence, re.I):  # "[m] of a rigid body" has no subject either
                findings.append(("Of", line, sentence))
        if is_doc:
            for sentence in re.split(r"(?<=[.!?])\s+", plain(paragraph)):
                count = len(WORD.findall(sentence))
                if count > DOC_SENTENCE:
                    findings.append((f"{count} words", line, sentence))
    if is_doc:
        findings += [(f"{len(each)} characters", number, each) for number, each in enumerate(text.splitlines(), 1)
                     if len(each) > DOC_LINE]
    return words, ifs, [(kind, f"{path.relative_to(root)}:{line}", sentence) for kind, line, sentence in findings]


def files_of(root, paths):
    given = [Path(each).resolve() for each in paths] or [root / each for each in (*CODE_FOLDERS, "docs")] + list(root.glob("*.md"))
    found = []
    for each in given:
        found += sorted(each.rglob("*")) if each.is_dir() else [each]
    return [each for each in found if each.suffix in {".h", ".cpp", ".md"} and "build" not in each.relative_to(root).parts]


def main():
    root = Path(sys.argv[1]).resolve()
    paths = sys.argv[2:]
    totals = {"comments": [0, 0, []], "docs": [0, 0, []]}
    for path in files_of(root, paths):
        total = totals["docs" if path.suffix == ".md" else "comments"]
        words, ifs, findings = judge(path, root, path.suffix == ".md")
        total[0] += words
        total[1] += ifs
        total[2] += findings
    failed = False
    for name, (words, ifs, findings) in totals.items():
        if not words:
            continue
        openings = [each for each in findings if each[0] == "Of"]
        others = [each for each in findings if each[0] != "Of"]
        per_10k = 1e4 / words
        print(f"{name}: {words} words; per 10,000 words {len(openings) * per_10k:.1f} sentences begin with Of (at most "
              f"{OF_PER_10K}), {ifs * per_10k:.1f} if (at least {IF_PER_10K}); {len(others)} long sentences and lines (none)")
        bad = len(openings) * per_10k > OF_PER_10K or ifs * per_10k < IF_PER_10K or others
        failed = failed or (bad and not paths) or (others and paths)
        for kind, place, sentence in (findings if bad or paths else []):
            print(f"  {place}: {kind}: {sentence[:150]}")
    return failed


if __name__ == "__main__":
    sys.exit(bool(main()))
