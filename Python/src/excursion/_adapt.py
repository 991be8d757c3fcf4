# SPDX-License-Identifier: GPL-3.0-or-later
"""A model that follows what drifts with temperature and age."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from ._call import Call, PathLike
from ._document import number, table
from ._fit import Fit, ModelLike, errors, model_argument
from ._model import FORMAT, Model
from ._program import Progress
from ._take import Take


class Adapted(Fit):
    """A model as it is now, and what has drifted since it was fitted."""

    @property
    def drift(self) -> pd.DataFrame:
        """What was fitted anew, over its name: ``before`` and ``after`` in ``unit``, and the standard error of each."""
        return table(self.document["drift"], "name")

    @property
    def figures(self) -> pd.DataFrame:
        """The same of ``f0`` and the total Q, which follow."""
        return table(self.document["figures"], "name")

    @property
    def warmer(self) -> float:
        """By how many K a copper coil with this Re is warmer; NaN for a model without a coil."""
        return number(self.document["warmer"])

    @property
    def sentence(self) -> str:
        """Whether that is all that has changed."""
        return str(self.document["sentence"])

    @property
    def error_before(self) -> pd.DataFrame:
        """As ``error``, of the model as it was."""
        return errors(self.document["errorBefore"])

    def table(self) -> pd.DataFrame:
        """As ``drift``, and ``share``: by how much of what it was."""
        found = self.drift
        return found.assign(share=found["after"] / found["before"] - 1.0)

    def _words(self) -> str:
        rows = self.table()
        return ", ".join(f"{name} {100.0 * share:+.1f} %" for name, share in rows["share"].items())


def adapt(
    model: ModelLike,
    take: Take | PathLike,
    parameters: Sequence[str] = (),
    *,
    progress: Progress | None = None,
) -> Adapted:
    """Refits what drifts with temperature and age to a short take, and leaves the rest.

    :param model: a Model, or the path of a model.json
    :param take: a Take, or the path of one; an impedance will do
    :param parameters: of the base, such as "Re"; a law goes with its own. Re, Rms and K where none is named
    :param progress: called with the share that is done and a phrase
    :raises Error: of the kind "refused" where the take is not fit for use
    """
    with Call(progress) as call:
        document = call.run(
            "adapt",
            [model_argument(call, model), call.take(take)],
            {"--parameters": ",".join(parameters) if len(parameters) > 0 else None, "--out": "model.json"},
            "excursion-adapt",
            negative=False,
        )
        return Adapted(document, Model(call.read("model.json", FORMAT)))
