# SPDX-License-Identifier: GPL-3.0-or-later
"""The notebook runs from its first cell to its last."""

from __future__ import annotations

import re
from pathlib import Path

import nbclient
import nbformat
import pytest

NOTEBOOK = Path(__file__).parents[1] / "examples" / "first-session.ipynb"


def test_it_is_kept_without_outputs():
    notebook = nbformat.read(NOTEBOOK, 4)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert len(cells) > 10
    assert all(not cell.outputs and cell.execution_count is None for cell in cells)


@pytest.mark.slow
def test_it_finds_and_linearizes(monkeypatch):
    monkeypatch.delenv("MPLBACKEND", raising=False)
    notebook = nbformat.read(NOTEBOOK, 4)
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    printed = "".join(output.text for output in outputs if output.output_type == "stream" and output.name == "stdout")
    assert "The take is fit for use." in printed
    assert "Force factor Bl(x) is missing." in printed
    assert "found: ['force-factor']  hidden: ['force-factor']" in printed
    before, after = map(float, re.findall(r"distortion of the sound: (\S+) dB before, (\S+) dB after", printed)[0])
    assert before > -30 and after < before - 60
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 8
