# SPDX-License-Identifier: GPL-3.0-or-later
"""What to play, virtual loudspeakers, and takes of other programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from ._call import Call, PathLike
from ._document import Result
from ._errors import Error
from ._program import Progress
from ._take import Excitation, Take
from ._takefile import read_take


class Plan(Result):
    """A multisine to play. ``take["voltage"]`` is what the loudspeaker is to get, in V."""

    def __init__(self, document: dict[str, Any], take: Take) -> None:
        super().__init__(document)
        self.take = take

    @property
    def excitation(self) -> Excitation:
        """To be given to the take of what was recorded: ``Take(rate, voltage=..., current=..., excitation=...)``."""
        assert self.take.excitation is not None
        return self.take.excitation

    def table(self) -> pd.DataFrame:
        """Over the level in V rms: where it ``starts`` in s, and the ``peak`` in V."""
        voltage, levels = self.take["voltage"], self.excitation.levels
        each = self.excitation.samples // len(levels)
        peaks = [float(np.max(np.abs(voltage[k * each : (k + 1) * each]))) for k in range(len(levels))]
        starts = [k * each / self.take.rate for k in range(len(levels))]
        return pd.DataFrame({"starts": starts, "peak": peaks}, index=pd.Index(levels, name="level"))

    def _words(self) -> str:
        loudest = self.excitation.levels[-1]
        return f"{self.document['seconds']:.4g} s, {self.document['lines']} lines, up to {loudest:.4g} V rms"


def excite(
    levels: float | Sequence[float] = (0.5, 1.5, 4.0),
    *,
    rate: float | None = None,
    period: int | None = None,
    periods: int | None = None,
    settle: int | None = None,
    realizations: int | None = None,
    band: tuple[float, float] | None = None,
    grid: str | None = None,
    shape: str | None = None,
    group: int | None = None,
    seed: int | None = None,
) -> Plan:
    """The multisine to play. What is left out is chosen as ``excursion excite --help`` says.

    :param levels: V rms, quiet to loud
    :param rate: Hz
    :param period: samples of one period
    :param periods: periods to be used in each realization, after ``settle`` periods for the loudspeaker to settle
    :param realizations: draws of the phases at each level
    :param band: lowest and highest frequency in Hz
    :param grid: which lines: full, odd, odd-odd, odd-random, R10, R20, R40, R80
    :param shape: amplitude over frequency: white, pink, red
    :param group: odd-random: odd lines in a group that misses one
    :param seed: of the lines and phases; the same seed gives the same signal
    """
    options = {
        "--levels": np.atleast_1d(levels).tolist(),
        "--rate": rate,
        "--period": period,
        "--periods": periods,
        "--settle": settle,
        "--realizations": realizations,
        "--band": band,
        "--grid": grid,
        "--shape": shape,
        "--group": group,
        "--seed": seed,
        "--out": "plan",
    }
    with Call() as call:
        return Plan(call.run("excite", [], options, "excursion-excite"), read_take(call.folder / "plan"))


class Virtual(Result):
    """A take of a virtual loudspeaker, and the truth about it."""

    def __init__(self, document: dict[str, Any], take: Take, truth: dict[str, Any]) -> None:
        super().__init__(document)
        self.take = take
        self.truth = truth  #: for after the diagnosis: driver, effects and laws, as Docs/Formats.md describes it

    @property
    def hidden(self) -> list[str]:
        """Ids of the effects that were hidden."""
        return [effect["id"] for effect in self.truth["effects"]]

    def table(self) -> pd.DataFrame:
        """The take, one column a quantity over the time in s."""
        return self.take.table()

    def _words(self) -> str:
        return f"{self.document['driver']}, seed {self.document['seed']}, {self.take!r}"


def virtual(
    seed: int,
    *,
    hidden: Mapping[str, float | None] | Sequence[str] | None = None,
    driver: str | None = None,
    channels: Sequence[str] | None = None,
    noise: float | None = None,
    rate: float | None = None,
    seconds: float | None = None,
    progress: Progress | None = None,
) -> Virtual:
    """A take of a virtual loudspeaker with something hidden in it. What is left out is drawn.

    :param seed: what is drawn, noise included
    :param hidden: effects to hide: a dict from ids to strengths (0.01 to 0.8, None: drawn), or a sequence of ids; an
        empty one hides nothing
    :param driver: micro, midrange, midbass, woofer, subwoofer or seed
    :param channels: what is recorded beside the voltage
    :param noise: of the sensors, dB against the loudest level
    :param rate: Hz
    :param seconds: length of the take, about
    """
    told: Any = hidden
    if hidden is not None and len(hidden) == 0:
        told = "none"
    options = {
        "--seed": int(seed),
        "--hidden": told,
        "--driver": driver,
        "--channels": channels,
        "--noise": noise,
        "--rate": rate,
        "--seconds": seconds,
        "--out": "take",
        "--truth": "truth.json",
    }
    with Call(progress) as call:
        document = call.run("virtual", [], options, "excursion-virtual")
        return Virtual(document, read_take(call.folder / "take"), call.read("truth.json", "excursion-truth"))


def import_take(
    file: PathLike, *, channels: Mapping[str, str] | None = None, rate: float | None = None, remove_mean: bool = False
) -> Take:
    """A take from a CSV or MAT file of another program.

    :param channels: from a column's name to a quantity and, after a colon, its unit, such as {"V2": "displacement:mm"};
        names that the program knows need none
    :param rate: Hz; needed where the file has no time column and no sample rate
    :param remove_mean: take the mean off every channel
    """
    for column, meant in (channels or {}).items():
        if not column or not meant:
            raise Error("Columns are mapped by a name to a quantity, such as {'V2': 'displacement:mm'}.", "usage")
    words = [word for column, meant in (channels or {}).items() for word in ("--map", f"{column}={meant}")]
    with Call() as call:
        call.run(
            "import",
            [call.path(file), *words],
            {"--rate": rate, "--remove-mean": remove_mean, "--out": "take"},
            "excursion-import",
        )
        return read_take(call.folder / "take")
