# SPDX-License-Identifier: GPL-3.0-or-later
"""Which effect makes which distortion?"""

from __future__ import annotations

from typing import Any

import pandas as pd

from ._call import Call, PathLike
from ._document import Result, number, numbers, table
from ._errors import Error
from ._fit import ModelLike, model_argument
from ._program import Progress
from ._take import Take

FORMAT = "excursion-whatif"

#: What the model as it is, is called beside the effects.
WHOLE = "as it is"


class WhatIf(Result):
    """The distortion of a model at the loudest of a take: as it is, without each effect, and of each effect alone."""

    @property
    def advice(self) -> str:
        """What to change in the driver, in words."""
        return str(self.document["advice"])

    @property
    def level(self) -> float:
        """V (or N) rms of what is played."""
        return number(self.document["level"])

    @property
    def channels(self) -> list[str]:
        return [found["channel"] for found in self.document["whole"]]

    def _variants(self, channel: str | None) -> dict[tuple[str, str], dict[str, Any]]:
        wanted = channel if channel is not None else self.channels[-1]
        if wanted not in self.channels:
            raise Error(f"There is no channel {wanted!r}; there are {', '.join(self.channels)}.", "usage")
        found = {(WHOLE, "whole"): self.document["whole"]}
        for effect in self.document["effects"]:
            for kind in ("without", "alone"):
                found[effect["effect"], kind] = effect[kind]
        return {key: one for key, variants in found.items() for one in variants if one["channel"] == wanted}

    def table(self, channel: str | None = None) -> pd.DataFrame:
        """Over the effect and the variant ("whole", "without" it, it "alone"): ``rms`` in the SI unit, ``evenDb`` and
        ``oddDb`` of distortion over the power, ``gainDb`` over the linear part.

        :param channel: by default the last, the sound where there is one
        """
        rows = [
            {
                "effect": effect,
                "variant": variant,
                **{key: value for key, value in one.items() if key in ("rms", "evenDb", "oddDb", "gainDb")},
            }
            for (effect, variant), one in self._variants(channel).items()
        ]
        return table(rows, ["effect", "variant"])

    def bands(self, effect: str = WHOLE, variant: str = "whole", channel: str | None = None) -> pd.DataFrame:
        """``even`` and ``odd`` distortion and ``gain`` in dB by band, over the frequency in Hz."""
        variants = self._variants(channel)
        if (effect, variant) not in variants:
            raise Error(
                f"There is no variant {(effect, variant)!r}; there are {', '.join(map(repr, variants))}.", "usage"
            )
        one = variants[effect, variant]
        return pd.DataFrame(
            {key: numbers(one[key]) for key in ("even", "odd", "gain")},
            index=pd.Index(numbers(one["frequency"]), name="frequency"),
        )

    @property
    def limits(self) -> pd.DataFrame:
        """Limits of the stroke, over their names: ``criterion``, ``inward`` and ``outward`` in m (NaN: not reached)."""
        return table(self.document["limits"], "name")

    def plot(self, channel: str | None = None, figure: Any = None) -> Any:
        """Even and odd distortion over frequency, as it is and without each effect; the matplotlib axes."""
        from ._plots import draw_whatif

        return draw_whatif(self, channel, figure=figure)

    def _words(self) -> str:
        return self.advice


def whatif(model: ModelLike, take: Take | PathLike, *, progress: Progress | None = None) -> WhatIf:
    """Which effect makes which distortion, how far the coil may go, and what to change.

    :param take: the loudest of it is played
    """
    with Call(progress) as call:
        return WhatIf(call.run("whatif", [model_argument(call, model), call.take(take)], {}, FORMAT))
