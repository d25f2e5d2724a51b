"""The package's types, with mypy: pip install mypy."""
import pathlib

import pytest

api = pytest.importorskip("mypy.api", reason="pip install mypy")

HERE = pathlib.Path(__file__).parent

WRONG = '''
import filasofia as fs
from filasofia import gym

fs.FemMaterail()
fs.FemMaterial(youngs_modulus=1e3)
fs.FemMaterial(young_modulus="soft")
fs.Simulation().step("often")
gym.Reeach()
x: str = fs.Simulation().frame.contacts["gap"]
'''


def check(file, tmp_path):
    out, problems, code = api.run(["--strict", f"--cache-dir={tmp_path}", str(file)])
    return out + problems, code


def test_a_correct_program_passes_and_a_wrong_one_has_an_error_in_every_line(tmp_path):
    out, code = check(HERE / "typed_program.py", tmp_path)
    assert code == 0, out
    wrong = tmp_path / "wrong.py"
    wrong.write_text(WRONG)
    out, _ = check(wrong, tmp_path)
    found = {int(line.split(":")[1]) for line in out.splitlines() if "error:" in line}
    assert found == set(range(5, 11)), out
