# SPDX-License-Identifier: GPL-3.0-or-later
"""What a loudspeaker will do, and what to give it so that it does what a linear one would."""

from __future__ import annotations

import os
import warnings

import numpy as np
import pandas as pd
import soundfile
from numpy.typing import ArrayLike

from ._call import Call, PathLike
from ._document import Result, table
from ._errors import Error, ExcursionWarning
from ._fit import ModelLike, model_argument
from ._model import Model
from ._program import Progress
from ._take import Samples, Take
from ._takefile import full_scale, read_take


class Simulation(Result):
    """Every channel of a model under a voltage (or force)."""

    def __init__(self, document: dict[str, object], take: Take) -> None:
        super().__init__(document)
        self.take = take  #: voltage, current, displacement, velocity, acceleration, pressure in SI units

    @property
    def converged(self) -> bool:
        """Halving the step changes no channel by more than the tolerance."""
        return bool(self.document["converged"])

    @property
    def accuracy(self) -> float:
        """The largest relative change of a channel when the step is halved."""
        return float(self.document["accuracy"])

    def __getitem__(self, quantity: str) -> Samples:
        return self.take[quantity]

    def table(self) -> pd.DataFrame:
        """``rms`` and ``peak`` by channel, in ``unit``."""
        return table(self.document["channels"], "quantity")

    def _words(self) -> str:
        return repr(self.take)


def _warn(sentence: str) -> None:
    warnings.warn(sentence, ExcursionWarning, stacklevel=3)


def _played(model: ModelLike, voltage: ArrayLike, rate: float | None) -> Take:
    if rate is None:
        raise Error("Samples alone have no rate; say with rate= how many there are a second.", "usage")
    read = model if isinstance(model, Model) else Model.read(model)
    mechanical = read.document["base"]["id"] == "mechanical"
    return Take(rate, force=voltage) if mechanical else Take(rate, voltage=voltage)


def simulate(
    model: ModelLike,
    played: Take | PathLike | ArrayLike,
    rate: float | None = None,
    *,
    tolerance: float | None = None,
    progress: Progress | None = None,
) -> Simulation:
    """What the loudspeaker will do, from rest.

    :param played: an array in V (N for a model without a coil), or a take or the path of one, whose voltage is played
    :param rate: of an array, Hz
    :param tolerance: largest relative change of any channel when the step is halved

    Warns where the tolerance is not reached, or where the cone goes beyond what the model was measured at.
    """
    if isinstance(played, (Take, str, os.PathLike)):
        if rate is not None:
            raise Error("A take has a rate of its own; leave rate= out.", "usage")
        take: Take | PathLike = played
    else:
        take = _played(model, played, rate)
    with Call(progress) as call:
        document = call.run(
            "simulate",
            [model_argument(call, model), call.take(take, "played")],
            {"--tolerance": tolerance, "--out": "take"},
            "excursion-simulate",
        )
        if not document["converged"]:
            _warn(f"Half the step changes the result by {document['accuracy']:.2g}, more than the tolerance.")
        if "warning" in document:
            _warn(document["warning"])
        return Simulation(document, read_take(call.folder / "take"))


class Predistortion(Result):
    """A signal that makes the loudspeaker play as if it were linear."""

    def __init__(self, document: dict[str, object], voltage: Samples, rate: float) -> None:
        super().__init__(document)
        self.voltage = voltage  #: V (or N), of the shape of what was given
        self.rate = rate  #: Hz

    @property
    def limited(self) -> bool:
        """A limit was reached: there the signal was turned down, the lowest notes first."""
        return bool(self.document["limited"])

    def table(self) -> pd.DataFrame:
        """One row a channel: ``peakIn`` and ``peakOut`` in V, the peak of the cone's ``displacement`` in m, ``power``
        in W, and by how many dB each limit has turned the signal down."""
        return pd.DataFrame(self.document["channels"])

    def _words(self) -> str:
        return f"{self.voltage.shape[0]} samples at {self.rate:.8g} Hz{', limited' if self.limited else ''}"


def predistort(
    model: ModelLike,
    voltage: ArrayLike,
    rate: float,
    *,
    limit_x: float | None = None,
    limit_u: float | None = None,
    limit_p: float | None = None,
    margin: float | None = None,
    coupling: float | None = None,
    coupling_order: int | None = None,
    target_f0: float | None = None,
    target_q: float | None = None,
    target_box: float | None = None,
    target_flat: tuple[float, float] | None = None,
    target_response: PathLike | None = None,
    coil_resistance: float | None = None,
    amount: float | None = None,
    oversampling: int | None = None,
    progress: Progress | None = None,
) -> Predistortion:
    """Bends a signal so that the loudspeaker plays it as if it were linear.

    :param voltage: what a linear loudspeaker would be given, V (N for a model without a coil): one axis, or samples by
        channels, each of which is predistorted by itself
    :param rate: Hz, a whole number
    :param limit_x: m that the cone may move at most; by default as far as the model was measured
    :param limit_u: V that may come out at most; by default no limit
    :param limit_p: W of heat in the voice coil, averaged over 1 s; by default no limit
    :param margin: the limits hold for every loudspeaker whose parameters differ by at most this share, 0 to 0.3
    :param coupling: Hz, corner of the high-pass between the output and the loudspeaker, behind which the limit of the
        motion is to hold; by default a constant voltage passes
    :param coupling_order: 1, the default, or 2: the order of that high-pass
    :param target_f0: Hz at which the linearized loudspeaker is to resonate; by default where the driver does
    :param target_q: and with which total Q; by default the driver's own. What the two take is in the document, `target`
    :param target_box: in their place: litres of the closed box as in which it is to move
    :param target_flat: in their place: Hz, between which two its sound is to be flat
    :param target_response: in their place: a file of Hz and dB, such as an .frd, that its sound is to follow
    :param coil_resistance: ohm; with it limit_p is kept with a model without physics, too
    :param amount: 0: the signal as it is, 1: fully linearized, the default
    :param oversampling: 1, 2 (the default) or 4

    The result is as exact as samples of 32-bit float are. Warns where the predistorter had to start anew, as the model
    is driven far beyond what it knows.
    """
    u = np.asarray(voltage)
    if u.dtype.kind not in "iuf" or u.ndim not in (1, 2) or u.size == 0:
        raise Error(
            f"The voltage is an array of {u.dtype} of shape {u.shape}, expected real samples, or samples by channels.",
            "usage",
        )
    if not np.all(np.isfinite(u)):
        raise Error("A sample of the voltage is not a finite number.", "input")
    if rate != int(rate) or rate < 1:
        raise Error(f"The rate is {rate} Hz, expected a whole number: a WAV has no other.", "usage")
    scale = full_scale(u)
    options = {
        "--full-scale": scale,
        "--limit-x": limit_x,
        "--limit-u": limit_u,
        "--limit-p": limit_p,
        "--margin": margin,
        "--coupling": coupling,
        "--coupling-order": coupling_order,
        "--target-f0": target_f0,
        "--target-q": target_q,
        "--target-box": target_box,
        "--target-flat": target_flat,
        "--coil-resistance": coil_resistance,
        "--amount": amount,
        "--oversampling": oversampling,
    }
    with Call(progress) as call:
        if target_response is not None:
            options["--target-response"] = call.path(target_response)
        soundfile.write(call.folder / "in.wav", u / scale, int(rate), subtype="DOUBLE", format="WAV")
        document = call.run(
            "predistort", [model_argument(call, model), "in.wav", "out.wav"], options, "excursion-predistort"
        )
        bent, _ = soundfile.read(call.folder / "out.wav", dtype="float64", always_2d=u.ndim == 2)
        faults = sum(channel.get("faults", 0) for channel in document["channels"])
        if faults:
            _warn(f"The predistorter had to start anew {faults} times: the model is driven far beyond what it knows.")
        return Predistortion(document, bent * scale, float(rate))
