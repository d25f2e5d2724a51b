"""The programs of the guide do what it says."""
import os
import re
import shutil

import filasofia as fs


def test_the_programs_of_the_guide_run(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # they write files
    shutil.copy(os.path.join(os.environ["FILASOFIA_ROOT"], "examples/scenes/biopsy.json"), tmp_path)
    with open(os.path.join(os.environ["FILASOFIA_ROOT"], "docs/guide/python.md")) as page:
        blocks = re.findall(r"```python\n(.*?)```", page.read(), flags=re.S)
    assert len(blocks) >= 6
    names = {}
    for block in blocks:  # each continues where the one before ended
        exec(compile(block, "docs/guide/python.md", "exec"), names)
    assert "after 0.300 s the lowest point hangs at" in capsys.readouterr().out
    assert names["sim"].frame.step == names["sim"].steps


def test_every_name_in_the_guide_exists():
    with open(os.path.join(os.environ["FILASOFIA_ROOT"], "docs/guide/python.md")) as page:
        text = page.read()
    for name in set(re.findall(r"\bfs\.(\w+)", text)):
        assert hasattr(fs, name), name
    for name in set(re.findall(r"\bsim\.(\w+)", text)):
        assert hasattr(fs.Simulation, name), name


def test_the_errors_in_the_guide_are_what_is_said():
    lines = []
    for act in (
        lambda: fs.Simulation(threads=1).add(bad),
        lambda: fs.FemMaterial(youngs_modulus=1),
        lambda: fs.Simulation(threads=1).step(1.5),
    ):
        try:
            bad = fs.SoftBodyDef(name="liver", mesh=fs.shapes.block((1, 1, 1)))
            object.__setattr__(bad.material, "poisson_ratio", 0.5)
            act()
        except (fs.Error, TypeError) as problem:
            lines.append(str(problem))
    with open(os.path.join(os.environ["FILASOFIA_ROOT"], "docs/guide/python.md")) as page:
        text = page.read()
    assert len(lines) == 3 and all(f"    {line}\n" in text for line in lines), lines
