# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes: what was played, and what was measured."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from ._errors import Error

Samples = NDArray[np.float64]

#: Each quantity and the units that an array of it may be in: the first is the one that a take holds.
#: V for displacement and force is for an electrical analogue, and stays V.
QUANTITIES: dict[str, dict[str, float]] = {
    "voltage": {"V": 1.0, "mV": 1e-3},
    "current": {"A": 1.0, "mA": 1e-3},
    "displacement": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "V": 1.0},
    "velocity": {"m/s": 1.0, "mm/s": 1e-3, "mps": 1.0, "mmps": 1e-3},
    "acceleration": {"m/s^2": 1.0, "m/s2": 1.0, "m/s²": 1.0, "mps2": 1.0},
    "pressure": {"Pa": 1.0, "mPa": 1e-3, "kPa": 1e3},
    "force": {"N": 1.0, "mN": 1e-3, "V": 1.0},
}


def unit_of(quantity: str, unit: str | None) -> tuple[str, float]:
    """The unit that a take holds, and the factor that leads there."""
    known = QUANTITIES[quantity]
    if unit is None:
        return next(iter(known)), 1.0
    if unit not in known:
        same = [name for name in known if name.lower() == unit.lower()]
        if len(same) != 1:
            raise Error(f"The unit {unit!r} is none of {quantity}; expected {', '.join(known)}.", "input")
        unit = same[0]
    return (unit if unit == "V" else next(iter(known))), known[unit]


@dataclass(frozen=True)
class Driver:
    """What is known of the loudspeaker beforehand."""

    name: str = ""
    cone_area: float | None = None  #: m²
    microphone_distance: float | None = None  #: m


@dataclass(frozen=True)
class Excitation:
    """A multisine that was played in periods, level by level, realization by realization."""

    period: int  #: samples of one period
    periods: int  #: periods of each realization that are used
    levels: tuple[float, ...]  #: V rms, quiet to loud
    realizations: int = 1  #: draws of the phases at each level
    settle_periods: int = 0  #: periods before the used ones
    grid: str = "full"  #: which lines: full, odd, odd-odd, odd-random, R10, R20, R40, R80
    shape: str = "white"  #: amplitude over frequency: white, pink, red
    band: tuple[float, float] | None = None  #: lowest and highest frequency in Hz
    lines: tuple[int, ...] | None = None  #: excited DFT lines of one period, ascending; None: found from the voltage

    def __post_init__(self) -> None:
        levels = np.atleast_1d(np.asarray(self.levels, dtype=float))
        object.__setattr__(self, "levels", tuple(float(level) for level in levels))
        for name, least in (("period", 4), ("periods", 1), ("realizations", 1), ("settle_periods", 0)):
            value = getattr(self, name)
            if value != int(value) or value < least:
                raise Error(f"The excitation has {value} for {name}, expected a whole number from {least} on.", "usage")
            object.__setattr__(self, name, int(value))
        if levels.size == 0 or not np.all(levels > 0) or np.any(np.diff(levels) <= 0):
            raise Error("The levels of an excitation are V rms above 0, quiet to loud.", "usage")
        if self.lines is not None:
            object.__setattr__(self, "lines", tuple(int(line) for line in self.lines))

    @property
    def samples(self) -> int:
        """Samples that the excitation is long."""
        return self.period * (self.settle_periods + self.periods) * self.realizations * len(self.levels)


class Take:
    """Samples of voltage, current, motion and pressure, taken at one rate.

    >>> take = excursion.Take(48000, voltage=u, current=i, displacement=x_mm, units={"displacement": "mm"})

    :param rate: samples a second, Hz
    :param excitation: what was played in periods; None for music, noise, or what is not known
    :param driver: what is known of the loudspeaker
    :param coupling: Hz, corner of the high-pass that all inputs of the recorder share; 0 where none is known
    :param remarks: sentences on how the take came about, such as what an import had to assume
    :param units: of arrays that are not in V, A, m, m/s, m/s², Pa or N: a dict from quantity to unit
    :param samples: one array a quantity, all of one length: ``voltage``, ``current``, ``displacement``, ``velocity``,
        ``acceleration``, ``pressure``, ``force``. There must be a voltage, or a force for a driver without its coil.

    Arrays are copied. ``take["current"]`` is an array in the SI unit.
    """

    def __init__(
        self,
        rate: float,
        *,
        excitation: Excitation | None = None,
        driver: Driver | None = None,
        coupling: float = 0.0,
        remarks: Sequence[str] = (),
        units: Mapping[str, str] | None = None,
        **samples: ArrayLike,
    ) -> None:
        self.rate = float(rate)
        self.excitation = excitation
        self.driver = driver if driver is not None else Driver()
        self.coupling = float(coupling)
        self.remarks = tuple(remarks)
        self.units: dict[str, str] = {}
        self.samples: dict[str, Samples] = {}
        for quantity in (*samples, *(units or {})):
            if quantity not in QUANTITIES:
                raise Error(f"There is no quantity {quantity!r}; the known ones are {', '.join(QUANTITIES)}.", "usage")
        for quantity, values in samples.items():
            unit, factor = unit_of(quantity, (units or {}).get(quantity))
            self.units[quantity] = unit
            self.samples[quantity] = _samples(quantity, values) * factor
        self.require()

    def require(self) -> None:
        """Throws Error where the take is not one that the program could read."""
        if not 0 <= self.coupling < math.inf:
            raise Error("The corner of the recorder's coupling is a frequency in Hz, 0 or more.", "usage")
        if not 1 <= self.rate <= 1e8:
            raise Error(f"The rate is {self.rate} Hz, expected 1 Hz to 100 MHz.", "usage")
        if "voltage" not in self.samples and "force" not in self.samples:
            raise Error("A take needs a voltage, or a force for a driver that is measured without its coil.", "data")
        first, length = next((quantity, len(values)) for quantity, values in self.samples.items())
        for quantity, values in self.samples.items():
            if len(values) != length:
                raise Error(f"There are {length} samples of {first}, but {len(values)} of {quantity}.", "data")
            bad = np.flatnonzero(~np.isfinite(values))
            if bad.size:
                raise Error(f"Sample {bad[0]} of {quantity} is not a finite number.", "input")
        if self.excitation is not None and self.excitation.samples > length:
            raise Error(f"The excitation is {self.excitation.samples} samples long, but the take has {length}.", "data")

    @staticmethod
    def read(path: str | os.PathLike[str]) -> Take:
        """A take that was kept: a folder with measurement.json (or plan.json) and its WAV, or that JSON itself."""
        from ._takefile import read_take

        return read_take(path)

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Keeps the take as a folder with measurement.json and take.wav (64-bit float, nothing is lost)."""
        from ._takefile import write_take

        write_take(self, folder)

    def __getitem__(self, quantity: str) -> Samples:
        return self.samples[quantity]

    def __contains__(self, quantity: object) -> bool:
        return quantity in self.samples

    def __iter__(self) -> Iterator[str]:
        return iter(self.samples)

    def __len__(self) -> int:
        return len(next(iter(self.samples.values())))

    def __repr__(self) -> str:
        return f"<excursion.Take: {', '.join(self.samples)}; {self.seconds:.6g} s at {self.rate:.8g} Hz>"

    @property
    def seconds(self) -> float:
        """How long it is, s."""
        return len(self) / self.rate

    @property
    def time(self) -> Samples:
        """Of each sample, s from the first."""
        return np.arange(len(self)) / self.rate

    def periods(self, quantity: str, level: int = -1, realization: int = 0) -> Samples:
        """The used periods of one realization: an array with one row a period.

        :param level: number of the level, 0 the quietest, -1 the loudest
        """
        e = self.excitation
        if e is None:
            raise Error("The take has no periods.", "data")
        if not (-len(e.levels) <= level < len(e.levels) and 0 <= realization < e.realizations):
            raise Error(
                f"The take has {len(e.levels)} levels of {e.realizations} realizations, numbered from 0.", "usage"
            )
        each = e.settle_periods + e.periods
        start = ((level % len(e.levels)) * e.realizations + realization) * each + e.settle_periods
        return self.samples[quantity][start * e.period : (start + e.periods) * e.period].reshape(e.periods, e.period)

    def table(self) -> pd.DataFrame:
        """One column a quantity, in SI units, over the time in s."""
        return pd.DataFrame(self.samples, index=pd.Index(self.time, name="time"))

    def plot(self, start: float = 0.0, seconds: float | None = None, figure: Any = None) -> Any:
        """The samples over time, one axis a quantity; the matplotlib axes.

        :param start: s from the first sample
        :param seconds: how much is shown; all when left out
        """
        from ._plots import draw_take

        return draw_take(self, start, seconds, figure=figure)


def _samples(quantity: str, values: ArrayLike) -> Samples:
    array = np.asarray(values)
    if array.dtype.kind not in "iuf":
        raise Error(f"The samples of {quantity} are of type {array.dtype}, expected real numbers.", "usage")
    if array.ndim != 1 or array.size == 0:
        raise Error(
            f"The samples of {quantity} are an array of shape {array.shape}, expected one with one axis.", "usage"
        )
    return array.astype(float)
