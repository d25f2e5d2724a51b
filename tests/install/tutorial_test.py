"""Builds every program of docs/guide/tutorial.md as its reader would, runs every command and compares its output.

    tutorial_test.py PAGE PREFIX FOLDER [--short] [words for cmake ...]   # builds in FOLDER, against the Filasofia in PREFIX
    tutorial_test.py PAGE --write FOLDER                        # only writes the chapters' programs

With --short, runs of more than 1,000 steps and what needs their files are left out. The page's chapter 1 tells its reader how its blocks are used; this program does the same.
"""
import copy
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

NUMBER = re.compile(r"\d+(?:\.\d+)?")


def fail(*words):
    sys.exit("tutorial: " + " ".join(str(word) for word in words))


class Program:
    """A file of sections, each from its line `---- name` to the next such line."""

    def __init__(self, comment, last=None):
        self.mark = re.compile(rf"\s*{comment} ---- (\w+)(?: \((.*)\))?$")
        self.last = last  # a new section is inserted before this one
        self.sections = {}

    def text(self):
        return "\n".join(line for lines in self.sections.values() for line in lines) + "\n"

    def changed(self, block, where):
        """The program with a block of the page inserted, and whether the block is kept for later chapters."""
        out = copy.copy(self)
        out.sections = dict(self.sections)
        name, stays = None, True
        for line in block:
            head = self.mark.match(line)
            if head:
                name, stays = head[1], stays and head[2] is None
                out.place(name)
            elif name is None:
                fail(where, "the block begins without a section:", line)
            out.sections[name].append(line)
        out.sections = {each: lines for each, lines in out.sections.items() if any(l.strip() for l in lines[1:])}
        return out, stays

    def place(self, name):
        if name in self.sections or self.last not in self.sections:
            self.sections[name] = []
            return
        end = self.sections.pop(self.last)
        self.sections[name] = []
        self.sections[self.last] = end


class Page:
    def __init__(self, path):
        self.main, self.cmake = Program("//", "run"), Program("#")
        self.runs = []  # (where, program's text, command, expected lines)
        chapter, kind, block = "", None, []
        for number, line in enumerate(Path(path).read_text().splitlines(), 1):
            if kind is None and line.startswith("## "):
                chapter = line[3:]
            if not line.startswith("```"):
                block.append(line)
            elif kind is None:
                kind, block, start = line[3:], [], number
                if kind not in ("cpp", "cmake", "console"):
                    fail(f"line {number}: a block of kind '{kind}'")
            else:
                self.take(kind, block, f"line {start}, '{chapter}':")
                kind = None

    def take(self, kind, block, where):
        if kind == "cpp":
            self.current, stays = self.main.changed(block, where)
            self.main = self.current if stays else self.main
        elif kind == "cmake":
            self.cmake, _ = self.cmake.changed(block, where)
        else:
            for line in block:
                if line.startswith("$ "):
                    self.runs.append((where, self.current.text(), line[2:], []))
                else:
                    self.runs[-1][3].append(line)

    def programs(self):
        """The programs that are run, each once, except the last one."""
        final = self.main.text()
        return [text for text in dict.fromkeys(text for _, text, _, _ in self.runs) if text != final]

    def write(self, folder):
        folder.mkdir(parents=True)
        cmake = self.cmake.text()
        for i, text in enumerate(self.programs()):
            (folder / f"stage{i}.cpp").write_text(text)
            cmake += f"add_executable(stage{i} stage{i}.cpp)\ntarget_link_libraries(stage{i} PRIVATE Filasofia::filasofia)\n"
            # The reader's own program has no precompiled header, so a missing include must be an error.
            cmake += f"target_precompile_headers(stage{i} " + (
                "REUSE_FROM stage0)\n" if i else "PRIVATE <filasofia/filasofia.h>)\n")
        (folder / "main.cpp").write_text(self.main.text())
        (folder / "CMakeLists.txt").write_text(cmake)


def same(expected, printed):
    """Whether `printed` contains `expected`; numbers may differ by a tenth or by 1.5 of the last decimal, as solvers may improve."""
    wanted, there = (" ".join(NUMBER.sub("#", line).split()) for line in (expected, printed))
    at = there.find(wanted)
    if at < 0:
        return False
    for a, b in zip(NUMBER.findall(expected), NUMBER.findall(printed)[there[:at].count("#"):]):
        decimals = len(a.partition(".")[2])
        if abs(float(a) - float(b)) > max(0.1 * float(a), 1.5 * 10.0**-decimals if decimals else 0.0):
            return False
    return True


def run(words, where, folder, environment):
    done = subprocess.run([str(word) for word in words], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", timeout=900)
    if done.returncode:
        fail(where, shlex.join(map(str, words)), f"ended with {done.returncode}:\n{done.stdout}")
    return done.stdout


def is_short(command):
    """Whether a command makes at most 1,000 steps and needs no file of a run that makes more."""
    steps = re.search(r"--steps (\d+)", command)
    return int(steps[1]) <= 1000 if steps else command.startswith("cmake")


def main(path, prefix, folder, *options):
    short = options[:1] == ("--short",)
    options = options[short:]
    page, prefix, folder = Page(path), Path(prefix).resolve(), Path(folder).resolve()
    shutil.rmtree(folder, ignore_errors=True)
    if not page.runs:
        fail("the page has no command")
    page.write(folder)
    environment = {k: v for k, v in os.environ.items() if not k.startswith("FILASOFIA_")}
    # "A mesh of your own, in millimetres."
    mesh = (prefix / "share/filasofia/meshes/hysteroscopy/uterus_1702.msh").read_text().split("$Nodes\n")
    nodes, rest = mesh[1].split("$EndNodes")
    count, *lines = nodes.splitlines()
    scaled = [" ".join([n, *(repr(1e3 * float(x)) for x in xyz)]) for n, *xyz in map(str.split, lines)]
    (folder / "organ.msh").write_text(f"{mesh[0]}$Nodes\n{count}\n" + "\n".join(scaled) + f"\n$EndNodes{rest}")

    programs = {text: folder / f"build/stage{i}" for i, text in enumerate(page.programs())}
    runs = [each for each in page.runs if not short or is_short(each[2])]
    for where, text, command, expected in runs:
        words = [word.replace("/opt/filasofia", str(prefix)) for word in shlex.split(command)]
        if words[0] == "cmake":  # once, for all chapters' programs
            words += options if "-S" in words else []
        elif words[0] == "build/simulator":
            words[0] = programs.get(text, folder / "build/simulator")
        elif words[0] == "filasofia":
            words[0] = prefix / "bin/filasofia"
        elif words[0] != "ctest":
            fail(where, "a command that is not known here:", command)
        print(where, command, flush=True)
        printed = run(words, where, folder, environment).splitlines()
        left = iter(printed)
        for line in expected:  # in this order, possibly with other lines between them
            if not any(same(line, each) for each in left):
                fail(where, command, "\ndoes not print:", line, "\nbut:\n" + "\n".join(printed))
    length = f"{len(page.main.text().splitlines())} lines in the end"
    if length not in " ".join(Path(path).read_text().split()):
        fail("the page does not say that the program has", length)
    print(len(runs), "commands do what the page says")


if sys.argv[2] == "--write":
    Page(sys.argv[1]).write(Path(sys.argv[3]))
else:
    main(*sys.argv[1:])
