#!/usr/bin/env python3
"""Figures of the code and the docs: sizes of functions, files and headers, casts, repeated code, words and prose.

Usage: house_figures.py <root>               as JSON
       house_figures.py <root> --markdown    as a Markdown table
Needs universal-ctags for functions and types; without it those are left out.
"""
import json
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

import check_prose

LONG, MANY, RUN = 80, 6, 8  # lines of a function, its parameters, lines of a repetition
TYPES = {"class", "struct", "enum"}


def sources(folder):
    return [path for path in sorted(folder.rglob("*")) if path.suffix in {".h", ".cpp"}]


def tags(files):
    """What ctags finds in these files, each as its JSON says."""
    command = ["ctags", "--output-format=json", "--fields=+neSK", "--kinds-c++=fcsg", "--language-force=C++", "-f", "-", "-L", "-"]
    found = subprocess.run(command, input="\n".join(map(str, files)), capture_output=True, text=True, check=True).stdout
    return [json.loads(line) for line in found.splitlines() if line.startswith("{")]


def parameters(signature):
    """How many parameters a signature has: commas outside all brackets, and one more."""
    inner, depth, commas = signature[1:signature.rfind(")")].strip(), 0, 0
    for before, char in zip(" " + inner, inner):
        depth += (char in "(<[{") - (char in ")]}" or (char == ">" and before != "-"))
        commas += char == "," and depth == 0
    return 0 if inner in ("", "void") else commas + 1


def percentile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def functions(files):
    found = [tag for tag in tags(files) if tag["kind"] == "function" and "end" in tag]
    lengths = [tag["end"] - tag["line"] + 1 for tag in found]
    counts = [parameters(tag.get("signature", "()")) for tag in found]
    return {"count": len(found), "lines median": statistics.median(lengths), "lines p90": percentile(lengths, 0.9),
            "lines max": max(lengths), f"over {LONG} lines": sum(length > LONG for length in lengths),
            f"over {MANY} parameters": sum(count > MANY for count in counts), "parameters max": max(counts)}


def code_lines(path):
    """(line number, text) of what is code, with blanks squeezed."""
    for number, line in enumerate(path.read_text().splitlines(), 1):
        text = re.sub(r"\s+", " ", re.sub(r"//.*", "", line)).strip()
        if len(text) > 1 and not text.startswith(("#", "using ", "namespace ", "}")):
            yield number, text


def repeated(files):
    """Lines inside runs of at least RUN lines of code that also stand elsewhere."""
    windows, lines = {}, {path: list(code_lines(path)) for path in files}
    for path, code in lines.items():
        for start in range(len(code) - RUN + 1):
            windows.setdefault(tuple(text for _, text in code[start:start + RUN]), []).append((path, start))
    return len({(path, start + i) for places in windows.values() if len(places) > 1 for path, start in places for i in range(RUN)})


def kinds_of_lines(files):
    lines = [line.strip() for path in files for line in path.read_text().splitlines()]
    return {"files": len(files), "lines": len(lines),
            "comment-only lines [%]": round(100 * sum(line.startswith(("//", "/*", "*")) for line in lines) / len(lines), 1),
            "blank lines [%]": round(100 * sum(not line for line in lines) / len(lines), 1)}


def prose(root):
    result = {}
    for name, is_doc in (("comments", False), ("docs", True)):
        judged = [check_prose.judge(path, root, is_doc) for path in check_prose.files_of(root, [])
                  if (path.suffix == ".md") == is_doc]
        words, ifs = sum(each[0] for each in judged), sum(each[1] for each in judged)
        findings = [kind for each in judged for kind, _, _ in each[2]]
        result[name] = {"words": words, "if per 10,000 words": round(1e4 * ifs / words, 1),
                        "sentences that begin with Of per 10,000 words": round(1e4 * findings.count("Of") / words, 1)}
        if is_doc:
            result[name] |= {f"sentences over {check_prose.DOC_SENTENCE} words": sum(kind.endswith("words") for kind in findings),
                             f"lines over {check_prose.DOC_LINE} characters": sum(kind.endswith("characters") for kind in findings)}
    return result


def figures(root):
    src, engine, include = root / "src", root / "src/filasofia/engine", root / "include"
    files, headers = sources(src), sources(include)
    lengths = [len(path.read_text().splitlines()) for path in files]
    folders = {"engine itself": sum(path.suffix in {".h", ".cpp"} for path in engine.iterdir())}
    folders |= {path.relative_to(src / "filasofia").as_posix(): sum(each.suffix in {".h", ".cpp"} for each in path.iterdir())
                for path in sorted(engine.rglob("*")) if path.is_dir()}
    result = {}
    if shutil.which("ctags"):
        result["functions of src"] = functions(files)
        result["functions of engine"] = functions(sources(engine))
    result["files of src"] = {"count": len(files), "lines median": statistics.median(lengths), "lines max": max(lengths)}
    result["files per folder"] = folders
    for name, group in (("src", files), ("engine", sources(engine)), ("include", headers)):
        result["lines of " + name] = kinds_of_lines(group)
    result["public headers"] = {"count": len(headers), "engine": len(sources(include / "filasofia/engine"))}
    if shutil.which("ctags"):
        result["public types"] = {"count": sum(tag["kind"] in TYPES for tag in tags(headers)),
                                  "engine": sum(tag["kind"] in TYPES for tag in tags(sources(include / "filasofia/engine")))}
    result["repeated code of src"] = {f"lines in runs of at least {RUN}": repeated(files)}
    result["static_cast<std::size_t>"] = {"src": sum(path.read_text().count("static_cast<std::size_t>") for path in files),
                                          "engine": sum(path.read_text().count("static_cast<std::size_t>") for path in sources(engine))}
    result["docs"] = {"pages": len(list((root / "docs").rglob("*.md"))),
                      "words": sum(len(path.read_text().split()) for path in (root / "docs").rglob("*.md")),
                      "words of README.md": len((root / "README.md").read_text().split()),
                      "lines of CHANGELOG.md": len((root / "CHANGELOG.md").read_text().splitlines())}
    result |= {"prose of " + name: values for name, values in prose(root).items()}
    return result


def main():
    arguments = [each for each in sys.argv[1:] if not each.startswith("--")]
    if len(arguments) != 1:
        sys.exit(__doc__)
    result = figures(Path(arguments[0]).resolve())
    if "--markdown" in sys.argv:
        print("| What | |\n|---|---|")
        for group, values in result.items():
            print("\n".join(f"| {group}: {name} | {value} |" for name, value in values.items()))
    else:
        print(json.dumps(result, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
