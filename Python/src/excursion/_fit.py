# SPDX-License-Identifier: GPL-3.0-or-later
"""Models fitted to takes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Union

import pandas as pd

from ._call import Call, PathLike
from ._document import Result, number, table
from ._model import FORMAT, Model
from ._program import Progress
from ._take import Take

ModelLike = Union[Model, PathLike]


def model_argument(call: Call, model: ModelLike, name: str = "given.json") -> str:
    """What the program is to call a model."""
    return call.keep(model.document, name) if isinstance(model, Model) else call.path(model)


def known(error: dict[str, Any]) -> dict[str, Any]:
    """An error of a document; chiSquaredPerValue is of no meaning where the noise is not known."""
    found = {("chiSquaredPerValue" if key == "chi" else key): value for key, value in error.items()}
    return found if error["noiseFloorDb"] is not None else {**found, "chiSquaredPerValue": None}


def errors(found: dict[str, Any] | None) -> pd.DataFrame:
    """The error by channel: ``db`` and ``noiseFloorDb`` in dB of the channel, ``chiSquaredPerValue``
    (1: only noise)."""
    rows = [{"channel": channel, **known(error)} for channel, error in (found or {}).items()]
    return table(rows, "channel")


class Fit(Result):
    """A model, and how well it explains the take."""

    def __init__(self, document: dict[str, Any], model: Model) -> None:
        super().__init__(document)
        self.model = model
        self.converged: bool = document["fit"]["converged"]

    @property
    def error(self) -> pd.DataFrame:
        """By channel, on data that no fit saw: ``db``, ``noiseFloorDb`` in dB of it, ``chiSquaredPerValue``
        (1: noise)."""
        return errors(self.document["error"])

    @property
    def parameters(self) -> pd.DataFrame:
        """As those of the model."""
        return self.model.parameters

    @property
    def summary(self) -> pd.DataFrame:
        """Figures of effects whose parameters are no reading, over the effect and the name."""
        return table(self.document.get("summary", []), ["of", "name"])

    def table(self) -> pd.DataFrame:
        """The parameters, in SI units."""
        return self.parameters

    def plot(self, figure: Any = None) -> Any:
        """The laws with their 95 % bands; the matplotlib axes."""
        return self.model.plot(figure)

    def _words(self) -> str:
        error = ", ".join(f"{channel} {number(one['db']):.1f} dB" for channel, one in self.document["error"].items())
        return f"{' + '.join(['base', *self.model.effects])}; error {error}"


class Added(Fit):
    """A model with one more effect."""

    @property
    def added(self) -> str:
        """Id of the effect."""
        return str(self.document["added"])

    @property
    def error_before(self) -> pd.DataFrame:
        """As ``error``, of the model without it."""
        return errors(self.document["errorBefore"])


def fit(take: Take | PathLike, effects: Sequence[str] = (), *, progress: Progress | None = None) -> Fit:
    """Fits the linear base, and the effects that are named, to a take.

    :param take: a Take, or the path of one (a folder, a .csv, a .zma)
    :param effects: ids, such as "stiffness"; ``excursion.effects()`` lists them
    :param progress: called with the share that is done and a phrase
    :raises Error: of the kind "refused" where the take is not fit for use
    """
    with Call(progress) as call:
        document = call.run(
            "fit",
            [call.take(take)],
            {"--effects": effects if len(effects) > 0 else None, "--out": "model.json"},
            "excursion-fit",
            negative=False,
        )
        return Fit(document, Model(call.read("model.json", FORMAT)))


def add(take: Take | PathLike, effect: str, model: ModelLike, *, progress: Progress | None = None) -> Added:
    """Puts an effect into a model and refits everything.

    :param effect: id, such as "stiffness"
    :param model: a Model, or the path of a model.json
    :raises Error: of the kind "refused" where the take is not fit for use
    """
    with Call(progress) as call:
        document = call.run(
            "add",
            [call.take(take), effect],
            {"--model": model_argument(call, model), "--out": "model.json"},
            "excursion-add",
            negative=False,
        )
        return Added(document, Model(call.read("model.json", FORMAT)))


def effects() -> pd.DataFrame:
    """The catalogue of physical effects: one row an effect, over its id."""
    with Call() as call:
        return table(call.run("effects", [], {}, "excursion-effects")["effects"], "id")
