"""What the scripts do around the package."""

import os
import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(os.environ["FILASOFIA_ROOT"])

# Makes an environment whose own python notes what pip is asked for, and fails if that is "broken".
PYTHON = """#!/bin/sh
mkdir -p "$3/bin"
cat >"$3/bin/python" <<'END'
#!/bin/sh
shift 4
echo "$@" >>"$LOG"
[ "$*" != broken ]
END
chmod +x "$3/bin/python"
echo made >>"$LOG"
"""


def test_an_environment_gets_packages_that_are_asked_for_later(tmp_path):
    log, python = tmp_path / "log", tmp_path / "python"
    python.write_text(PYTHON)
    python.chmod(0o755)

    def ask(*packages):
        """What is done for it, and whether it worked."""
        log.write_text("")
        done = subprocess.run(
            ["bash", "-euc", 'source "$0/scripts/common.sh"; python_environment "$@"', ROOT, tmp_path / "place", *packages],
            env={**os.environ, "PYTHON": str(python), "LOG": str(log)},
            capture_output=True,
            text=True,
        )
        assert (done.returncode == 0) == (done.stderr == ""), done.stderr
        return log.read_text().splitlines(), done.returncode == 0

    assert ask("numpy", "nanobind>=2.5") == (["made", "numpy nanobind>=2.5"], True)
    assert ask("numpy", "nanobind>=2.5") == ([], True)
    assert ask("numpy", "nanobind>=3") == (["numpy nanobind>=3"], True)
    assert ask("broken") == (["broken"], False)
    assert ask("broken") == (["broken"], False)  # it is not taken for made
    assert ask("numpy", "scipy") == (["numpy scipy"], True)


@pytest.mark.parametrize("picture", ["demo.jpg", "nowhere/demo.png", ""])
def test_the_demo_refuses_a_wrong_file_before_its_run(picture, tmp_path):
    words = [sys.executable, "-m", "filasofia.demo", "--picture", picture]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"--picture must be a .png in a folder that exists, got {picture!r}" in done.stderr


def test_the_first_program_of_the_guide_has_at_most_twelve_lines():
    page = (ROOT / "docs/guide/python.md").read_text()
    program = re.search(r"## Twelve lines\n\n```python\n(.*?)```", page, re.S)[1]
    assert len([line for line in program.splitlines() if line]) <= 12
