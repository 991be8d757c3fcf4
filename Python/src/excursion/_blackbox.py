# SPDX-License-Identifier: GPL-3.0-or-later
"""Nonlinear models that know no physics, and all classes of models side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pandas as pd

from ._call import Call, PathLike
from ._document import Result, number, numbers, table
from ._errors import Error
from ._program import Progress
from ._statespace import StateSpace
from ._take import Samples, Take
from ._takefile import read_take

_MODELS = ("excursion-pnlss", "excursion-fractional-pnlss")


class Pnlss(Result):
    """A polynomial state-space model, and how well it explains the take."""

    def __init__(self, document: dict[str, Any], played: Take | None) -> None:
        super().__init__(document)
        self.model: dict[str, Any] = document[
            "model"
        ]  #: as Docs/Formats.md describes it; ``pnlss(model=...)`` takes it
        self.played = (
            played  #: input and output as the model plays the take, from rest; None where it was not asked for
        )

    @property
    def linear(self) -> StateSpace:
        """The linear part."""
        return StateSpace.from_document(self.model["linear"])

    @property
    def estimation_db(self) -> float:
        """Relative error of a simulation of the records that were fitted, dB."""
        return number(self.document["estimationDb"])

    @property
    def validation_db(self) -> float:
        """The same of records that no fit saw; NaN where there are none."""
        return number(self.document["validationDb"])

    @property
    def stable(self) -> bool:
        """The linear part is."""
        return bool(self.document["stable"])

    @property
    def history(self) -> Samples:
        """The estimation error in dB after each step of a simulation of the whole records."""
        return numbers(self.document["history"])

    @property
    def laws(self) -> dict[str, Any] | None:
        """The physical effects that the model agrees with; None where it was not asked."""
        return self.document.get("laws")

    def table(self) -> pd.DataFrame:
        """One row a monomial: its exponents, ``E`` in each row of the state and ``F`` of the output equation."""
        rows = []
        for term in self.model["terms"]:
            row: dict[str, Any] = {"exponents": tuple(term["exponents"])}
            row.update({f"E{k + 1}": value for k, value in enumerate(term["E"])})
            row.update({f"F{k + 1}": value for k, value in enumerate(term["F"])})
            rows.append(row)
        return table(rows, "exponents")

    def _words(self) -> str:
        return f"estimation {self.estimation_db:.1f} dB, validation {self.validation_db:.1f} dB"


def pnlss(
    take: Take | PathLike,
    order: int | None = None,
    *,
    degree: int | None = None,
    mask: str | None = None,
    terms: str | None = None,
    alpha: float | str | None = None,
    mixed: bool = False,
    linear_output: bool = False,
    offset: bool = False,
    output: str | None = None,
    level: int | None = None,
    iterations: int | None = None,
    model: dict[str, Any] | PathLike | None = None,
    played: bool = False,
    laws: bool = False,
    progress: Progress | None = None,
) -> Pnlss:
    """Fits a polynomial state-space model to a take.

    :param order: number of states
    :param degree: highest degree of the monomials, 2 to 9
    :param mask: which monomials, as ``excursion pnlss --help`` lists them
    :param terms: these monomials in place of degree and mask, such as "x1^3,x1*x2,u^2"
    :param alpha: states of fractional order: a number below 1, or "free"
    :param mixed: with ``alpha``, for a current under a voltage: only the coil's state is of fractional order
    :param linear_output: no monomials in the output equation
    :param offset: also constants in both equations
    :param output: the channel to explain; by default the first beside the input
    :param level: number of the level, 0 the quietest; by default the loudest
    :param iterations: at most, of each of the ways that are tried
    :param model: judge this model, which was kept, instead of fitting one
    :param played: also give the take as the model plays it
    :param laws: also tell which physical laws the model agrees with
    """
    with Call(progress) as call:
        if isinstance(model, dict):
            if model.get("format") not in _MODELS:
                raise Error(
                    f"The model is of the format {model.get('format')!r}, expected {' or '.join(_MODELS)}.", "input"
                )
            model = call.folder / call.keep(model, "given.json")
        options = {
            "--order": order,
            "--degree": degree,
            "--mask": mask,
            "--terms": terms,
            "--alpha": alpha,
            "--mixed": mixed,
            "--linear-output": linear_output,
            "--offset": offset,
            "--output": output,
            "--level": level,
            "--iterations": iterations,
            "--model": None if model is None else call.path(model),
            "--played": "played" if played else None,
            "--laws": laws,
        }
        document = call.run("pnlss", [call.take(take)], options, "excursion-pnlss-fit")
        return Pnlss(document, read_take(call.folder / "played") if played else None)


class Ranking(Result):
    """All classes of models on one take, by ascending error."""

    @property
    def noise_db(self) -> float:
        """Of the output, dB; NaN where it is not known."""
        return number(self.document["noiseDb"])

    @property
    def sentence(self) -> str:
        return str(self.document["sentence"])

    @property
    def best(self) -> str | None:
        """The class of the smallest validation error; None where no class could be fitted."""
        models = self.document["models"]
        return models[0]["class"] if models and "trouble" not in models[0] else None

    @property
    def linearizes_best(self) -> str | None:
        """The class that leaves least distortion on the take; None where no class takes 3 dB away."""
        return self.document["linearizesBest"]

    def linearization(self) -> pd.DataFrame:
        """Over the class: ``beforeDb``, the distortion as the model was fitted, ``modelDb`` and ``leftDb``, what
        predistortion leaves of it on the model and on the take, ``load`` (share of a core), ``latency`` (s);
        ``trouble`` where the class is not inverted."""
        return table(
            [
                {"class": model["class"], **model["linearization"]}
                for model in self.document["models"]
                if "linearization" in model
            ],
            "class",
        )

    def table(self) -> pd.DataFrame:
        """Over the class: ``parameters``, ``estimationDb`` and ``validationDb`` of simulations, ``load`` (time over the
        signal's length), ``fitSeconds``, ``stable``, ``description``; ``trouble`` where it could not be fitted."""
        return table(self.document["models"], "class")

    def _words(self) -> str:
        return self.sentence


def rank(
    take: Take | PathLike,
    *,
    output: str | None = None,
    level: int | None = None,
    order: int | None = None,
    degree: int | None = None,
    iterations: int | None = None,
    classes: Sequence[str] | None = None,
    progress: Progress | None = None,
) -> Ranking:
    """Fits all classes of models to one take, each judged on records that it has not seen.

    :param output: the channel to explain; by default the first beside the input
    :param level: number of the level, 0 the quietest; by default the loudest
    :param order: states of the polynomial models
    :param degree: highest degree of their monomials
    :param iterations: of each search, at most
    :param classes: these alone, as ``excursion rank --help`` lists them
    """
    with Call(progress) as call:
        return Ranking(
            call.run(
                "rank",
                [call.take(take)],
                {
                    "--output": output,
                    "--level": level,
                    "--order": order,
                    "--degree": degree,
                    "--iterations": iterations,
                    "--classes": classes,
                },
                "excursion-ranking",
            )
        )
