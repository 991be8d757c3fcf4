# SPDX-License-Identifier: GPL-3.0-or-later
"""Is a take fit for use?"""

from __future__ import annotations

from typing import Any

import pandas as pd

from ._call import Call, PathLike
from ._document import Result, table
from ._take import Take


def problems(found: Any) -> pd.DataFrame:
    """What is wrong with a take: ``kind``, ``channel`` (None: all), ``value`` in ``unit``, ``fatal``, ``sentence``."""
    return pd.DataFrame(found or [], columns=["kind", "channel", "value", "unit", "fatal", "sentence"])


class Check(Result):
    """Whether a take is fit for use, and what its channels are like."""

    @property
    def fit_for_use(self) -> bool:
        return bool(self.document["fitForUse"])

    @property
    def verdict(self) -> str:
        """One sentence."""
        return str(self.document["verdict"])

    @property
    def problems(self) -> pd.DataFrame:
        """One row a fault: ``kind``, ``channel`` (None: all), ``value``, ``unit``, ``fatal``, ``sentence``."""
        return problems(self.document["problems"])

    def table(self) -> pd.DataFrame:
        """One row a channel: ``rms``, ``peak`` and ``offset`` in ``unit``, ``clippedSamples``, ``snrDb``,
        ``repeatabilityDb``, ``settlingDb`` in dB, ``driftPpm``, and ``delay`` in samples where one was found."""
        rows = []
        for channel in self.document["channels"]:
            row = {key: value for key, value in channel.items() if key not in ("bands", "delay")}
            rows.append({**row, "delay": (channel.get("delay") or {}).get("samples")})
        return table(rows, "quantity")

    @property
    def bands(self) -> pd.DataFrame:
        """The signal to noise ratio ``snrDb`` by octave, from ``low`` to ``high`` in Hz, over the quantity."""
        rows = [
            {"quantity": channel["quantity"], **band}
            for channel in self.document["channels"]
            for band in channel.get("bands", [])
        ]
        return table(rows, "quantity")

    def _words(self) -> str:
        return self.verdict


def check(take: Take | PathLike) -> Check:
    """Says whether a take is fit for use, and if not, which channel is at fault."""
    with Call() as call:
        return Check(call.run("check", [call.take(take)], {}, "excursion-check"))
