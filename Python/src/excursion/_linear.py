# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear models that know no physics: identified from a frequency response, reduced, stabilized."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Union

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ._call import Call, PathLike
from ._document import Result, number, numbers, table
from ._program import Progress
from ._response import Response
from ._statespace import StateSpace
from ._take import Samples, Take

ResponseLike = Union[Take, Response, PathLike]


class Identification(Result):
    """Linear models of the orders that were tried, and the one that was chosen."""

    def __init__(self, document: dict[str, Any]) -> None:
        super().__init__(document)
        self.model = StateSpace.from_document(document["model"])

    def table(self) -> pd.DataFrame:
        """Over the order: ``errorDb``, ``weightedErrorDb``, ``mdl``, ``validationDb``, ``stable`` and more; of a
        fractional model also ``alpha`` and its standard error ``alphaStandardError``."""
        return table(
            [{key: value for key, value in one.items() if key != "curve"} for one in self.document["orders"]], "order"
        )

    @property
    def chosen(self) -> int:
        """The order of ``model``."""
        return int(self.document["chosen"])

    @property
    def stable(self) -> bool:
        return bool(self.table().loc[self.chosen, "stable"])

    @property
    def zeros(self) -> NDArray[np.complex128]:
        """In rad/s or in z; empty for a model of fractional order."""
        return np.array([complex(*root) for root in self.document.get("zeros", [])], dtype=complex)

    def _words(self) -> str:
        return repr(self.model)


class MixedImpedance(Result):
    """R + L s^alpha + K s/(s² + w0/Q s + w0²), fitted to an impedance."""

    def table(self) -> pd.DataFrame:
        """``value`` and its standard error ``deviation`` in ``unit``, over the name."""
        return table(
            [{"name": name, **found} for name, found in self.document.items() if isinstance(found, dict)], "name"
        )

    @property
    def error_db(self) -> float:
        return float(self.document["errorDb"])

    def _words(self) -> str:
        return f"error {self.error_db:.1f} dB"


class MotorCone(Result):
    """A loudspeaker as two linear systems in cascade."""

    def __init__(self, document: dict[str, Any]) -> None:
        super().__init__(document)
        self.motor = StateSpace.from_document(document["motor"])  #: voltage to displacement, velocity, acceleration
        self.cone = StateSpace.from_document(document["cone"])  #: acceleration to pressure
        self.cascade = StateSpace.from_document(document["cascade"])
        self.delay = float(document["delay"])  #: of the sound, which was taken off, s

    def table(self) -> pd.DataFrame:
        """``errorDb`` and ``order`` of motor, cone and cascade."""
        rows = [
            ("motor", self.motor, "motorErrorDb"),
            ("cone", self.cone, "coneErrorDb"),
            ("cascade", self.cascade, "errorDb"),
        ]
        return table(
            [{"part": part, "order": model.order, "errorDb": number(self.document[key])} for part, model, key in rows],
            "part",
        )

    def _words(self) -> str:
        return f"orders {self.motor.order} and {self.cone.order}"


def _source(call: Call, source: ResponseLike, name: str) -> str:
    return call.keep(source.document, name + ".json") if isinstance(source, Response) else call.take(source, name)


def identify(
    source: ResponseLike,
    order: int | Sequence[int] | None = None,
    *,
    output: str | None = None,
    input: str | None = None,
    level: int | None = None,
    band: tuple[float, float] | None = None,
    alpha: float | str | None = None,
    mixed: bool = False,
    cone: int | None = None,
    delay: float | None = None,
    validation: ResponseLike | None = None,
    discrete: bool = False,
    subspace: bool = False,
    quick: bool = False,
    allow_unstable: bool = False,
    progress: Progress | None = None,
) -> Identification | MixedImpedance | MotorCone:
    """Identifies a linear state-space model of a frequency response.

    :param source: a take, a Response, or the path of a take, a .csv, .zma, .frd, or of the .json of ``excursion bla``
    :param order: the order, or several to choose from
    :param output: the channel to explain; by default the first beside the input
    :param input: the channel it is explained by; by default the voltage or force
    :param level: number of the level, 0 the quietest; by default the loudest
    :param band: lowest and highest frequency to use, Hz
    :param alpha: a model of fractional order: the order of differentiation, or "free" to find it
    :param mixed: with ``alpha``: an impedance R + L s^alpha with one resonance; the answer is a MixedImpedance
    :param cone: tell motor and cone apart: the cone's order; ``order`` is the motor's, the answer is a MotorCone
    :param delay: with ``cone``: how long the sound is on its way, s
    :param validation: another take or response, which then chooses the order
    :param discrete: a model of discrete time at the take's rate
    :param subspace: by the subspace method alone
    :param quick: fewer starts
    :param allow_unstable: do not keep the poles stable
    """
    orders = None if order is None else np.atleast_1d(np.asarray(order)).tolist()
    with Call(progress) as call:
        options = {
            "--order": orders,
            "--output": output,
            "--input": input,
            "--level": level,
            "--band": band,
            "--alpha": alpha,
            "--mixed": mixed,
            "--cone": cone,
            "--delay": delay,
            "--discrete": discrete,
            "--subspace": subspace,
            "--quick": quick,
            "--allow-unstable": allow_unstable,
            "--validation": None if validation is None else _source(call, validation, "validation"),
        }
        answer = (
            "excursion-motor-cone"
            if cone is not None
            else "excursion-identification"
            if alpha is None
            else "excursion-mixed-impedance"
            if mixed
            else "excursion-fractional-identification"
        )
        document = call.run("identify", [_source(call, source, "take")], options, answer)
    if cone is not None:
        return MotorCone(document)
    return MixedImpedance(document) if alpha is not None and mixed else Identification(document)


class Revision(Result):
    """A linear model in place of another, and the steps that led to it."""

    def __init__(self, document: dict[str, Any]) -> None:
        super().__init__(document)
        self.model = StateSpace.from_document(document["model"])

    def table(self) -> pd.DataFrame:
        """The steps, as Docs/Formats.md describes them; empty for a truncation."""
        return table(self.document.get("steps", []))

    @property
    def stable(self) -> bool:
        return bool(self.document["stable"])

    def _words(self) -> str:
        return f"{self.document['method']}: {self.model!r}"


class Reduction(Revision):
    """A smaller model."""

    @property
    def bound(self) -> float:
        """Of a truncation: the largest change of the response at any frequency, in its unit; NaN else."""
        return number(self.document.get("bound"))

    @property
    def singular_values(self) -> Samples:
        """Hankel singular values, of a truncation; empty else."""
        return numbers(self.document.get("singularValues"))


class Stabilization(Revision):
    """A stable model."""

    @property
    def unstable(self) -> StateSpace | None:
        """The unstable part, of the method "decompose"."""
        found = self.document.get("unstable")
        return StateSpace.from_document(found) if found else None


def _linear(call: Call, model: StateSpace | PathLike) -> str:
    return call.keep(model.document, "given.json") if isinstance(model, StateSpace) else call.path(model)


def reduce(
    model: StateSpace | PathLike,
    order: int | None = None,
    *,
    response: ResponseLike | None = None,
    level: int | None = None,
    error: float | None = None,
    ripple: float | None = None,
    band: tuple[float, float] | None = None,
    settled: bool = False,
    progress: Progress | None = None,
) -> Reduction:
    """A smaller linear model in place of a large one: balanced and truncated, pruned, or freed of poles and zeros.

    :param order: to reduce it to
    :param response: prune by this take or response, refitting after every step, at ``level`` of the take
    :param error: stop pruning before the weighted error would pass this, dB
    :param ripple: take out remote poles and zeros, and pairs that cancel, as long as all ripples by at most this, dB
    :param band: lowest and highest frequency that the ripple counts at, Hz
    :param settled: truncated states are taken as settled: exact at frequency 0
    """
    with Call(progress) as call:
        options = {
            "--order": order,
            "--level": level,
            "--error": error,
            "--ripple": ripple,
            "--band": band,
            "--settled": settled,
            "--out": "model.json",
            "--response": None if response is None else _source(call, response, "response"),
        }
        return Reduction(call.run("reduce", [_linear(call, model)], options, "excursion-reduction"))


def stabilize(
    model: StateSpace | PathLike,
    method: str = "mirror",
    *,
    response: ResponseLike | None = None,
    level: int | None = None,
    seconds: float | None = None,
    refit: bool = True,
    progress: Progress | None = None,
) -> Stabilization:
    """A stable linear model in place of an unstable one, and what each step costs.

    :param method: "mirror" unstable poles, "project" on the stable part, add a "delay" and fit again, or "decompose"
    :param response: the take or response that the model is of, to fit it to again; by default its own response
    :param level: of the take, 0 the quietest; by default the loudest
    :param seconds: the delay to add; by default the one that fits best
    :param refit: end with a constrained fit
    """
    with Call(progress) as call:
        options = {
            "--method": method,
            "--level": level,
            "--seconds": seconds,
            "--no-refit": not refit,
            "--out": "model.json",
            "--frf": None if response is None else _source(call, response, "response"),
        }
        return Stabilization(call.run("stabilize", [_linear(call, model)], options, "excursion-stabilization"))
