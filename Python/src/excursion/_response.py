# SPDX-License-Identifier: GPL-3.0-or-later
"""Frequency responses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from ._call import Call, PathLike
from ._document import VERSION, Result, number, numbers, require_format
from ._errors import Error
from ._take import QUANTITIES, Samples, Take

FORMAT = "excursion-bla"


class DetectionLines:
    """What stands on lines that were not played: distortion of one parity, and noise."""

    def __init__(self, found: dict[str, Any] | None) -> None:
        found = found or {}
        self.frequency: Samples = numbers(found.get("frequency"))  #: Hz
        self.power: Samples = numbers(found.get("power"))  #: of the output on that line, its unit squared
        self.noise: Samples = numbers(found.get("noise"))  #: the part of it that is noise
        self.db: float = number(found.get("db"))  #: all of them over the output's power; NaN where the grid has none
        self.significant: bool = bool(found.get("significant", False))  #: above the noise; else ``db`` is a bound


class Response(Result):
    """A frequency response with its variances: the best linear approximation of a take, or one's own.

    :param frequency: Hz, ascending
    :param value: complex, output over input in SI units
    :param input: quantity, such as "voltage"
    :param output: quantity, such as "current"
    :param noise_variance: of each value, by noise; may be left out
    :param total_variance: by noise and nonlinearity; may be left out
    """

    def __init__(
        self,
        frequency: ArrayLike,
        value: ArrayLike,
        *,
        input: str = "voltage",
        output: str = "current",
        noise_variance: ArrayLike | None = None,
        total_variance: ArrayLike | None = None,
    ) -> None:
        f, z = np.asarray(frequency, dtype=float), np.asarray(value, dtype=complex)
        if f.ndim != 1 or f.shape != z.shape or f.size == 0:
            raise Error(
                f"There are values of shape {z.shape} at frequencies of shape {f.shape}, expected as many of one "
                "as of the other.",
                "usage",
            )
        if not (np.all(np.isfinite(f)) and np.all(np.isfinite(z)) and np.all(np.diff(f) > 0)):
            raise Error("The values of a response are finite, and its frequencies ascend.", "input")
        for quantity in (input, output):
            if quantity not in QUANTITIES:
                raise Error(f"There is no quantity {quantity!r}; the known ones are {', '.join(QUANTITIES)}.", "usage")
        document = {
            "format": FORMAT,
            "version": VERSION,
            "input": input,
            "output": output,
            "frequency": f.tolist(),
            "re": z.real.tolist(),
            "im": z.imag.tolist(),
        }
        for key, variance in (("noiseVariance", noise_variance), ("totalVariance", total_variance)):
            if variance is not None:
                v = np.asarray(variance, dtype=float)
                if v.shape != f.shape or not np.all(np.isfinite(v)) or np.any(v < 0):
                    raise Error(f"{key} is one number of 0 or more a frequency.", "usage")
                document[key] = v.tolist()
        super().__init__(document)

    @classmethod
    def from_document(cls, document: dict[str, Any]) -> Response:
        """What ``excursion bla --json`` printed."""
        require_format(document, FORMAT, "The response")
        response = cls.__new__(cls)
        response.document = document
        return response

    @property
    def input(self) -> str:
        return str(self.document["input"])

    @property
    def output(self) -> str:
        return str(self.document["output"])

    @property
    def method(self) -> str:
        """One of "periods", "welch" and "given"."""
        return str(self.document.get("method", "given"))

    @property
    def level(self) -> float:
        """V rms of the input; NaN where there are no levels."""
        return number(self.document.get("levelRms"))

    @property
    def frequency(self) -> Samples:
        """Hz."""
        return numbers(self.document["frequency"])

    @property
    def value(self) -> NDArray[np.complex128]:
        """Output over input, in SI units."""
        return numbers(self.document["re"]) + 1j * numbers(self.document["im"])

    @property
    def noise_variance(self) -> Samples:
        """Of ``value``, by noise, in its unit squared; empty where it is not known."""
        return numbers(self.document.get("noiseVariance"))

    @property
    def total_variance(self) -> Samples:
        """Of ``value``, by noise and by nonlinear distortion; empty where it is not known."""
        return numbers(self.document.get("totalVariance"))

    @property
    def stochastic_nonlinear(self) -> Samples:
        """The variance that nonlinearity gives the response of one realization; empty where it is not known."""
        return numbers(self.document.get("stochasticNonlinear"))

    @property
    def coherence(self) -> Samples:
        """Empty where it is not known."""
        return numbers(self.document.get("coherence"))

    @property
    def odd(self) -> DetectionLines:
        """Odd distortion, from odd lines that were not played."""
        return DetectionLines(self.document.get("odd"))

    @property
    def even(self) -> DetectionLines:
        """Even distortion, from the even lines."""
        return DetectionLines(self.document.get("even"))

    @property
    def noise_db(self) -> float:
        """Noise over the output's power, dB; NaN where it is not known."""
        return number(self.document.get("noiseDb"))

    def inverse(self) -> Response:
        """Input over output, such as an impedance of an admittance, with the variances to first order."""
        value = self.value
        scale = np.abs(value) ** -4.0

        def of(variance: Samples) -> Samples | None:
            return variance * scale if variance.size else None

        return Response(
            self.frequency,
            1.0 / value,
            input=self.output,
            output=self.input,
            noise_variance=of(self.noise_variance),
            total_variance=of(self.total_variance),
        )

    def table(self) -> pd.DataFrame:
        """Over the frequency in Hz: ``value`` (complex), ``magnitude``, ``phase`` in degrees, and what is known of
        ``noise_variance``, ``total_variance``, ``stochastic_nonlinear`` and ``coherence``."""
        value = self.value
        columns: dict[str, Any] = {"value": value, "magnitude": np.abs(value), "phase": np.degrees(np.angle(value))}
        for name in ("noise_variance", "total_variance", "stochastic_nonlinear", "coherence"):
            if (found := getattr(self, name)).size:
                columns[name] = found
        return pd.DataFrame(columns, index=pd.Index(self.frequency, name="frequency"))

    def plot(self, figure: Any = None) -> Any:
        """Magnitude with its deviations by noise and in all, and phase; the matplotlib axes."""
        from ._plots import draw_response

        return draw_response(self, figure=figure)

    def _words(self) -> str:
        f = self.frequency
        return f"{self.output} / {self.input}, {f.size} lines from {f[0]:.4g} to {f[-1]:.4g} Hz"


def bla(
    take: Take | PathLike, output: str | None = None, *, level: int | None = None, segment: int | None = None
) -> Response:
    """The best linear approximation of a take, with its noise and its odd and even distortion.

    A take without periods gets an estimate from cross-spectra of the whole record.

    :param output: the channel to explain; by default the first beside the input
    :param level: number of the level, 0 the quietest; by default the loudest
    :param segment: samples of a segment, for a take without periods; by default 8192, less where the record is short
    """
    with Call() as call:
        return Response.from_document(
            call.run("bla", [call.take(take)], {"--output": output, "--level": level, "--segment": segment}, FORMAT)
        )
