"""examples/python/bunny.ipynb: its cells run, and its pictures are shown inline."""
import ast
import base64
import json
import os
import pathlib

import pytest

NOTEBOOK = pathlib.Path(os.environ["FILASOFIA_ROOT"]) / "examples" / "python" / "bunny.ipynb"


def cells():
    return [each for each in json.loads(NOTEBOOK.read_text())["cells"] if each["cell_type"] == "code"]


def test_the_notebook_has_no_outputs_in_the_repository():
    assert all(each["outputs"] == [] and each["execution_count"] is None for each in cells())
    ids = [each["id"] for each in json.loads(NOTEBOOK.read_text())["cells"]]
    assert len(set(ids)) == len(ids)


def run(source, names):
    """As a notebook does: the value of the last line, if it is an expression."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "bunny.ipynb", "exec"), names)
    return eval(compile(ast.Expression(last.value), "bunny.ipynb", "eval"), names) if last else None


def test_the_cells_of_the_notebook_show_pictures(capsys):
    names, shown = {}, []
    for each in cells():
        value = run("".join(each["source"]), names)
        if hasattr(value, "_repr_png_"):
            shown.append(value._repr_png_())
    assert len(shown) == 4 and all(each.startswith(b"\x89PNG") for each in shown)
    assert [b"acTL" in each for each in shown] == [False, True, False, False]  # the second one moves
    assert len(names["film"]) == 11 and names["film"][0].std() > 5
    assert "after 0.4 s the lowest point hangs at" in capsys.readouterr().out
    names["sim"].close()


def test_jupyter_runs_the_notebook_and_has_its_pictures():
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    import nbformat

    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbclient.NotebookClient(notebook, timeout=120).execute()
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    pictures = [base64.b64decode(each.data["image/png"]) for each in outputs if "image/png" in each.get("data", {})]
    assert len(pictures) == 4 and b"acTL" in pictures[1]
