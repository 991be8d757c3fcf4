# SPDX-License-Identifier: GPL-3.0-or-later
"""Which physical effect is missing?"""

from __future__ import annotations

from typing import Any

import pandas as pd

from ._call import Call, PathLike
from ._check import problems
from ._document import Result, table
from ._fit import ModelLike, errors, model_argument
from ._program import Progress
from ._take import Take

FORMAT = "excursion-diagnosis"


class Judgement(Result):
    """A verdict, and what the check said of the take."""

    @property
    def verdict(self) -> str:
        """One of "missing-effect", "complete", "unknown-effect" or "bad-measurement"."""
        return str(self.document["verdict"])

    @property
    def sentence(self) -> str:
        """The verdict in words."""
        return str(self.document["sentence"])

    @property
    def problems(self) -> pd.DataFrame:
        """One row a fault: ``kind``, ``channel`` (None: all), ``value``, ``unit``, ``fatal``, ``sentence``."""
        return problems(self.document.get("problems"))

    def _words(self) -> str:
        return f"{self.verdict}: {self.sentence}"


class Diagnosis(Judgement):
    """The verdict on a model, and the effects that it may lack, best first."""

    @property
    def missing(self) -> str | None:
        """Id of the effect that is missing; None where the verdict is another one."""
        return self.document["ranking"][0]["effect"] if self.verdict == "missing-effect" else None

    @property
    def reason(self) -> str:
        """Why this effect, in a sentence that can be checked on a plot; empty where none is named."""
        return self.document["ranking"][0]["reason"] if self.missing else ""

    @property
    def error(self) -> pd.DataFrame:
        """Of the model as it is, by channel: ``db``, ``noiseFloorDb`` in dB of it, ``chiSquaredPerValue``
        (1: noise)."""
        return errors(self.document["error"])

    @property
    def indistinguishable(self) -> list[str]:
        """Effects that the take cannot tell from the one that is named; ``measure_next`` says what would."""
        return list(self.document["indistinguishable"])

    @property
    def measure_next(self) -> str:
        return str(self.document["measureNext"])

    @property
    def remainder(self) -> dict[str, Any] | None:
        """What the model leaves, in words and figures, as Docs/Formats.md describes it."""
        return self.document.get("remainder")

    def table(self) -> pd.DataFrame:
        """One row an effect, best first: ``confidence`` (0 to 1), whether it was ``refitted``, the error in dB with it
        by channel (after the refit, else as predicted), ``significant``, and ``reason``."""
        rows = []
        for one in self.document["ranking"]:
            with_it = one["confirmedErrorDb"] or one["predictedErrorDb"] or {}
            rows.append(
                {
                    "effect": one["effect"],
                    "confidence": one["confidence"],
                    "refitted": one["confirmedErrorDb"] is not None,
                    **{f"{channel} dB": db for channel, db in with_it.items()},
                    "significant": one["significant"],
                    "reason": one["reason"],
                }
            )
        return table(rows, "effect")


def diagnose(take: Take | PathLike, model: ModelLike, *, progress: Progress | None = None) -> Diagnosis:
    """Names the physical effect that a model is missing.

    A take that is not fit for use gets the verdict "bad-measurement".
    """
    with Call(progress) as call:
        return Diagnosis(call.run("diagnose", [call.take(take)], {"--model": model_argument(call, model)}, FORMAT))
