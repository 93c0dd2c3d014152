"""The notebooks run from the first cell to the last."""

import os

import pytest

from conftest import ROOT

nbclient = pytest.importorskip("nbclient", reason="nbclient is not installed")
jupytext = pytest.importorskip("jupytext", reason="jupytext is not installed")
pytest.importorskip("ipykernel", reason="ipykernel is not installed")
pytest.importorskip("pandas", reason="pandas is not installed")

FOLDER = ROOT / "bindings/python/notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.py"))


def test_there_are_notebooks():
    assert len(NOTEBOOKS) == 3


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, monkeypatch, tmp_path):
    if "flagred.sklearn" in path.read_text(encoding="utf-8"):
        pytest.importorskip("sklearn", reason="scikit-learn is not installed: `pip install flagred[sklearn]`")
    for folder in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR"):
        monkeypatch.setenv(folder, os.fspath(tmp_path))
    notebook = jupytext.read(path)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert len(cells) >= 4
    done = nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": os.fspath(FOLDER)}}).execute()
    assert all(cell.execution_count for cell in done.cells if cell.cell_type == "code")
    assert any(cell.outputs for cell in done.cells if cell.cell_type == "code")
