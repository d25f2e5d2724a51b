#!/usr/bin/env python3
"""Runs test_verification, one topic (file of tests/verification) after the other, and prints what it measured as JSON.

Usage: verification_results.py build/release/bin/test_verification MACHINE > bench/results/verification_NAME.json
MACHINE says processor, compiler and date; it stands above the tables.
"""
import json
import re
import subprocess
import sys
from pathlib import Path

LINE = re.compile(r"verification: (?P<what>.*): (?P<value>\S+) \(bound (?P<bound>.*)\)")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program, machine = sys.argv[1:]
    files = sorted((Path(__file__).parents[1] / "tests/verification").glob("*_test.cpp"))
    topics = {}
    for topic in (file.stem for file in files):
        run = subprocess.run([program, "-#", f"[#{topic}]"], capture_output=True, text=True)
        if run.returncode:
            sys.exit(f"{topic} failed:\n{run.stdout[-2000:]}")
        found = [match.groupdict() for match in map(LINE.fullmatch, run.stdout.splitlines()) if match]
        topics[topic] = [each | {"value": float(each["value"])} for each in found]
    print(json.dumps({"bench": "verification", "machine": machine, "topics": topics}, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
