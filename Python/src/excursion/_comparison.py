# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a model and a take part."""

from __future__ import annotations

from typing import Any

import pandas as pd

from ._call import Call, PathLike
from ._check import problems
from ._document import Result, number, numbers, table
from ._errors import Error
from ._fit import ModelLike, errors, known, model_argument
from ._program import Progress
from ._take import Samples, Take

FORMAT = "excursion-comparison"


class ResidualCurve:
    """What the model lacks, as a force or a voltage, sorted by a motion or the current; at the loudest level."""

    def __init__(self, found: dict[str, Any]) -> None:
        self.residual: str = found["residual"]  #: force or voltage; over time stiffness or resistance
        self.unit: str = found["unit"]  #: of ``mean`` and ``scatter``
        self.against: str = found["against"]  #: x, v, i or t
        self.against_unit: str = found["againstUnit"]  #: of ``at``
        self.at: Samples = numbers(found["at"])
        self.mean: Samples = numbers(found["mean"])  #: of each bin
        self.scatter: Samples = numbers(found["scatter"])  #: standard deviation within each bin
        self.db: float = number(found.get("db"))  #: rms over that of what drives

    def __repr__(self) -> str:
        return f"<excursion.ResidualCurve: {self.residual} over {self.against}>"


class Comparison(Result):
    """The errors of a model by channel, level, parity and frequency, and what it lacks sorted by motion."""

    @property
    def error(self) -> pd.DataFrame:
        """By channel, over all levels: ``db``, ``noiseFloorDb`` in dB of it, ``chiSquaredPerValue`` (1: only noise)."""
        return errors(self.document["error"])

    @property
    def levels(self) -> Samples:
        """V rms of each level, quiet to loud; 0 where the take has none."""
        return numbers(self.document["levels"])

    @property
    def channels(self) -> list[str]:
        return [channel["quantity"] for channel in self.document["channels"]]

    @property
    def problems(self) -> pd.DataFrame:
        """What the check said of the take."""
        return problems(self.document.get("problems"))

    def table(self) -> pd.DataFrame:
        """Over channel and level (V rms): error ``db`` and ``noiseFloorDb`` in dB of the channel,
        ``chiSquaredPerValue``, and the error on ``linear``, ``odd`` and ``even`` lines in dB."""
        rows = []
        for channel in self.document["channels"]:
            for level in channel["levels"]:
                kinds = {key: value for key, value in (level.get("kinds") or {}).items() if key != "noise"}
                rows.append({"channel": channel["quantity"], "level": level["rms"], **known(level["error"]), **kinds})
        return table(rows, ["channel", "level"])

    def spectrum(self, channel: str | None = None, level: int = -1) -> pd.DataFrame:
        """Rms of ``measured``, ``model``, ``error``, ``noise`` by band in the channel's unit, over the frequency in Hz.

        :param channel: by default the first
        :param level: number of the level, 0 the quietest, -1 the loudest
        """
        wanted = channel if channel is not None else self.channels[0]
        for found in self.document["channels"]:
            if found["quantity"] == wanted:
                spectrum = found["levels"][level]["spectrum"]
                columns = {key: numbers(values) for key, values in spectrum.items() if values and key != "frequency"}
                return pd.DataFrame(columns, index=pd.Index(numbers(spectrum["frequency"]), name="frequency"))
        raise Error(f"The comparison has no channel {wanted!r}; it has {', '.join(self.channels)}.", "usage")

    @property
    def residuals(self) -> list[ResidualCurve]:
        """Residual force and voltage over x, v and i, where the take allows them."""
        return [ResidualCurve(found) for found in self.document.get("residuals") or []]

    @property
    def residuals_over_time(self) -> list[ResidualCurve]:
        """Resistance and stiffness that each section of the take lacks, over its time; ``scatter`` is the error."""
        return [ResidualCurve(found) for found in self.document.get("residualsOverTime") or []]

    def plot(self, level: int = -1, figure: Any = None) -> Any:
        """Measured, model, error and noise of each channel over frequency; the matplotlib axes."""
        from ._plots import draw_comparison

        return draw_comparison(self, level, figure=figure)

    def plot_residuals(self, figure: Any = None) -> Any:
        """Residual force and voltage over motion, with their scatter; the matplotlib axes."""
        from ._plots import draw_residuals

        return draw_residuals(self, figure=figure)

    def _words(self) -> str:
        return "error " + ", ".join(f"{key} {number(one['db']):.1f} dB" for key, one in self.document["error"].items())


def compare(take: Take | PathLike, model: ModelLike, *, progress: Progress | None = None) -> Comparison:
    """Where a model and a take part, by how much, and in which way."""
    with Call(progress) as call:
        return Comparison(call.run("compare", [call.take(take)], {"--model": model_argument(call, model)}, FORMAT))
