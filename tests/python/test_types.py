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
fs.Simulation(raet=3)
fs.Simulation().show(fs.BodyId(1), cast_shadow=False)
fs.replay(flie="run.rec")
fs.Simulation().on(fs.ContactEvent, lambda event: print(event.froce))
fs.AttachmentDef(nodes="all")
'''


@pytest.fixture(scope="module")
def check(tmp_path_factory):
    cache = tmp_path_factory.mktemp("mypy")

    def run(*what):
        out, problems, code = api.run(["--strict", f"--cache-dir={cache}", *what])
        return out + problems, code

    return run


def test_a_correct_program_passes_and_a_wrong_one_has_an_error_in_every_line(check, tmp_path):
    out, code = check(str(HERE / "typed_program.py"))
    assert code == 0, out
    wrong = tmp_path / "wrong.py"
    wrong.write_text(WRONG)
    out, _ = check(str(wrong))
    found = {int(line.split(":")[1]) for line in out.splitlines() if "error:" in line}
    assert found == set(range(5, 16)), out


def test_the_package_itself_passes(check, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the installed one
    out, code = check("--ignore-missing-imports", "-p", "filasofia")  # not every library that it uses has types
    assert code == 0, out
