# SPDX-License-Identifier: GPL-3.0-or-later
"""Diagnose, add and refit until nothing is missing."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from ._call import Call, PathLike
from ._comparison import Comparison
from ._diagnosis import Diagnosis, Judgement
from ._document import number, read_json, require_format, table
from ._fit import errors
from ._model import Model
from ._program import Progress
from ._take import Take
from ._whatif import WhatIf

FORMAT = "excursion-ladder"


class Rung:
    """One model of a ladder."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document = document
        self.added: str | None = document["added"]  #: id of the effect; None at the first
        self.model = Model(document["model"])
        self.comparison = Comparison(document["comparison"])
        self.diagnosis = Diagnosis(document["diagnosis"])

    @property
    def error(self) -> pd.DataFrame:
        """By channel: ``db`` and ``noiseFloorDb`` in dB of the channel, ``chiSquaredPerValue`` (1: only noise)."""
        return errors(self.document["error"])

    @property
    def chi_squared_per_value(self) -> float:
        """Mean squared error over squared noise, 1 at best; NaN where the take does not tell its noise."""
        comparison = self.document["comparison"]
        found = comparison.get("chiSquaredPerValue", comparison.get("chi"))  # ladders of before say "chi"
        return number(found if comparison["noiseKnown"] else None)

    def __repr__(self) -> str:
        return f"<excursion.Rung: {'+ ' + self.added if self.added else 'first model'}>"


class Ladder(Judgement):
    """Models from the linear one on, each with one more effect, and the verdict on the last."""

    def __init__(self, document: dict[str, Any], report: str = "") -> None:
        super().__init__(document)
        self.report = report  #: the page as HTML
        self.rungs = [Rung(rung) for rung in document["rungs"]]

    @staticmethod
    def read(folder: PathLike) -> Ladder:
        """A ladder that was kept: the folder that ``improve(out=...)`` or ``excursion improve`` wrote."""
        place = Path(folder)
        document = read_json(place / "ladder.json")
        require_format(document, FORMAT, f"'{place / 'ladder.json'}'")
        page = place / "report.html"
        return Ladder(document, page.read_text(encoding="utf-8") if page.is_file() else "")

    @property
    def model(self) -> Model | None:
        """Of the last rung; None where the take was not fit for use."""
        return self.rungs[-1].model if self.rungs else None

    @property
    def known(self) -> dict[str, float]:
        """The effects of the last model and the confidence in each, 0 to 1 (NaN: it was put in by hand)."""
        return {one["effect"]: number(one["confidence"]) for one in self.document.get("known", [])}

    @property
    def withdrawn(self) -> list[str]:
        """Effects that were added and taken back."""
        return list(self.document["withdrawn"])

    @property
    def whatif(self) -> WhatIf | None:
        """Which effect makes which distortion, by the last model; None where no effect distorts."""
        found = self.document.get("whatIf")
        return WhatIf(found) if found else None

    def table(self) -> pd.DataFrame:
        """One row a rung: what was ``added``, the error by channel in dB, and ``chiSquaredPerValue``; "noise" is the
        last row, where it is known."""
        rows: list[dict[str, Any]] = []
        for number_, rung in enumerate(self.rungs):
            error = {f"{channel} dB": one["db"] for channel, one in rung.document["error"].items()}
            left = {"chiSquaredPerValue": rung.chi_squared_per_value}
            rows.append({"rung": number_, "added": rung.added or "", **error, **left})
        if self.rungs:
            floor = {f"{channel} dB": one["noiseFloorDb"] for channel, one in self.rungs[-1].document["error"].items()}
            if all(db is not None for db in floor.values()):
                rows.append({"rung": "noise", "added": "", **floor, "chiSquaredPerValue": 1.0})
        return table(rows, "rung")

    def save_report(self, path: PathLike) -> None:
        """Writes the page, one HTML file with all its pictures."""
        Path(path).write_text(self.report, encoding="utf-8")

    def plot(self, figure: Any = None) -> Any:
        """The error by channel as it falls from rung to rung, over the noise; the matplotlib axes."""
        from ._plots import draw_ladder

        return draw_ladder(self, figure=figure)


def improve(
    take: Take | PathLike,
    *,
    with_effects: Sequence[str] = (),
    out: PathLike | None = None,
    progress: Progress | None = None,
) -> Ladder:
    """Diagnoses, adds and refits until nothing is missing.

    A take that is not fit for use gets the verdict "bad-measurement" and no model.

    :param with_effects: ids of effects that the first model has already
    :param out: folder to keep ladder.json, model.json and report.html in; by default nothing is kept
    :param progress: called with the share that is done and a phrase
    """
    with Call(progress) as call:
        place = call.path(out) if out is not None else "ladder"
        document = call.run(
            "improve",
            [call.take(take)],
            {"--effects": with_effects if len(with_effects) > 0 else None, "--out": place},
            FORMAT,
        )
        return Ladder(document, (call.folder / place / "report.html").read_text(encoding="utf-8"))
