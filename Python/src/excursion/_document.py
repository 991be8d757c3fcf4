# SPDX-License-Identifier: GPL-3.0-or-later
"""The JSON documents that the program reads and writes; see Docs/Formats.md."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ._errors import Error

#: The documents are of this version.
VERSION = 1


def read_json(path: str | Path) -> dict[str, Any]:
    """The object in a JSON file."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except OSError as trouble:
        raise Error(f"'{path}' cannot be read ({trouble.strerror}).", "input") from trouble
    except UnicodeDecodeError as trouble:
        raise Error(f"'{path}' is not text in UTF-8.", "input") from trouble
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as trouble:
        raise Error(f"'{path}' is not a JSON document: {trouble}.", "input") from trouble
    if not isinstance(document, dict):
        raise Error(f"'{path}' is JSON but not an object.", "input")
    return document


def write_json(document: dict[str, Any], path: str | Path) -> None:
    """Written beside its place and renamed, so that nothing is ever half written."""
    path = Path(path)
    draft = path.with_name(path.name + ".tmp")
    try:
        draft.write_text(json.dumps(document, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
        draft.replace(path)
    except OSError as trouble:
        with contextlib.suppress(OSError):
            draft.unlink()
        raise Error(f"'{path}' cannot be written ({trouble.strerror}).", "input") from trouble


def require_format(document: dict[str, Any], formats: str | Sequence[str], source: str) -> None:
    """Refuses a document of another kind or version."""
    known = [formats] if isinstance(formats, str) else list(formats)
    found = document.get("format")
    if found not in known:
        raise Error(f"{source} is of the format {found!r}, expected {' or '.join(known)}.", "input")
    if document.get("version") != VERSION:
        raise Error(
            f"{source} is of version {document.get('version')!r} of {found}, expected {VERSION}; program and "
            "Python package must be of the same age.",
            "input",
        )


def numbers(values: Sequence[float | None] | None) -> NDArray[np.float64]:
    """An array of a list of a document; what is not known is NaN."""
    if values is None:
        return np.empty(0)
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def number(value: float | None) -> float:
    """A number of a document; NaN where it is not known."""
    return np.nan if value is None else float(value)


def table(rows: Sequence[dict[str, Any]], index: str | list[str] | None = None) -> pd.DataFrame:
    """One row an object, what is not known NaN, and one or more columns as the index."""
    frame = pd.DataFrame(list(rows))
    if not frame.empty:
        for column in frame.columns:  # numbers with null among them are numbers
            if frame[column].map(lambda cell: cell is None or type(cell) in (int, float)).all():
                frame[column] = pd.to_numeric(frame[column])
        if index is not None:
            frame = frame.set_index(index)
    return frame


class Result:
    """What a verb answered. ``document`` is the JSON document of the program as it is, described in Docs/Formats.md."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document

    def table(self) -> pd.DataFrame:
        """What a person would look at first."""
        raise NotImplementedError

    def _words(self) -> str:
        """One line about the result."""
        return str(self.document.get("sentence", self.document.get("format", "")))

    def __repr__(self) -> str:
        return f"<excursion.{type(self).__name__}: {self._words()}>"
