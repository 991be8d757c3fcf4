# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures, drawn with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import Error
from ._take import Samples, Take

if TYPE_CHECKING:
    from ._comparison import Comparison
    from ._ladder import Ladder
    from ._model import Model
    from ._response import Response
    from ._whatif import WhatIf

# Colours that stay apart for everybody (Okabe and Ito), one role each.
_MEASURED, _MODEL, _ERROR, _NOISE = "#333333", "#0072B2", "#D55E00", "#999999"
_SERIES = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#333333"]

_NO_DISTORTION = -120.0  # dB: what the program says where there is none

_PREFIXED = ("V", "A", "m", "m/s", "m/s^2", "Pa", "N", "H")
_WORDS = {"ohm": "Ω", "N s/m": "N·s/m", "m/s^2": "m/s²"}


def _axes(figure: Any, rows: int, columns: int, size: tuple[float, float], **options: Any) -> Any:
    """Axes in a figure of the caller's, or in a new one."""
    try:
        from matplotlib import pyplot
    except ImportError as trouble:
        raise ImportError("Pictures need matplotlib: pip install 'excursion[plot]'.") from trouble
    if figure is None:
        figure = pyplot.figure(figsize=size, layout="constrained")
    axes: Any = figure.subplots(rows, columns, squeeze=False, **options)
    for axis in axes.flat:
        axis.grid(True, which="major", color="#dddddd", linewidth=0.6)
        axis.set_axisbelow(True)
        for side in ("top", "right"):
            axis.spines[side].set_visible(False)
    return axes


def _shown(values: Any, unit: str) -> tuple[float, str]:
    """The factor and the unit in which an engineer would read such values: mm, not 0.001 m."""
    named = _WORDS.get(unit, unit)
    finite = np.abs(np.asarray(values, dtype=float))
    peak = float(np.max(finite[np.isfinite(finite)], initial=0.0))
    if unit in _PREFIXED and peak > 0:
        for factor, prefix in ((1.0, ""), (1e3, "m"), (1e6, "µ")):
            if peak * factor >= 0.5 or prefix == "µ":
                return factor, prefix + named
    return 1.0, named


def _hertz(axis: Any) -> None:
    """A logarithmic axis of frequency with plain numbers."""
    from matplotlib.ticker import FuncFormatter, NullFormatter

    axis.set_xscale("log")
    axis.xaxis.set_major_formatter(FuncFormatter(lambda f, _: f"{f / 1000:g}k" if f >= 1000 else f"{f:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set_xlabel("Hz")


def _decibels(values: Samples) -> Samples:
    with np.errstate(divide="ignore"):
        return 20 * np.log10(values)


def draw_take(take: Take, start: float, seconds: float | None, figure: Any = None) -> Any:
    first = max(0, round(start * take.rate))
    last = len(take) if seconds is None else min(len(take), first + max(1, round(seconds * take.rate)))
    if first >= last:
        raise Error(f"The take ends at {take.seconds:.6g} s.", "usage")
    axes = _axes(figure, len(take.samples), 1, (8, 1.6 * len(take.samples) + 0.4), sharex=True)
    for axis, (quantity, values) in zip(axes.flat, take.samples.items()):
        shown = values[first:last]
        factor, unit = _shown(shown, take.units[quantity])
        axis.plot(np.arange(first, last) / take.rate, shown * factor, color=_MODEL, linewidth=0.7)
        axis.set_ylabel(f"{quantity}\n{unit}")
    axes[-1, 0].set_xlabel("s")
    return axes


def draw_response(response: Response, figure: Any = None) -> Any:
    axes = _axes(figure, 2, 1, (8, 5.5), sharex=True, height_ratios=[2, 1])
    f, value = response.frequency, response.value
    above, below = axes[0, 0], axes[1, 0]
    above.plot(f, np.abs(value), color=_MODEL, label="magnitude", linewidth=1.4)
    for variance, colour, label in (
        (response.total_variance, _ERROR, "deviation by nonlinearity and noise"),
        (response.noise_variance, _NOISE, "deviation by noise"),
    ):
        if variance.size:
            above.plot(f, np.sqrt(variance), ".", color=colour, markersize=2.5, label=label)
    above.set_yscale("log")
    names = {"current/voltage": "admittance, A/V", "voltage/current": "impedance, Ω"}
    above.set_ylabel(names.get(f"{response.output}/{response.input}", f"{response.output} / {response.input}, SI"))
    above.legend(frameon=False, fontsize="small")
    below.plot(f, np.degrees(np.unwrap(np.angle(value))), color=_MODEL, linewidth=1.2)
    below.set_ylabel("phase, °")
    _hertz(below)
    if np.isfinite(response.level):
        above.set_title(f"best linear approximation at {response.level:.3g} V rms", fontsize="medium")
    return axes


def draw_laws(model: Model, figure: Any = None) -> Any:
    laws = list(model.laws.values())
    if not laws:
        raise Error("The model has no law: none of its effects bends a parameter.", "data")
    columns = min(len(laws), 3)
    rows = -(-len(laws) // columns)
    axes = _axes(figure, rows, columns, (3.6 * columns + 0.6, 2.9 * rows))
    for axis, law in zip(axes.flat, laws):
        factor, unit = _shown(law.value, law.unit)
        across, argument = _shown(law.at, law.argument_unit)
        low, high = (law.value - law.half_width) * factor, (law.value + law.half_width) * factor
        axis.fill_between(law.at * across, low, high, color=_MODEL, alpha=0.25, linewidth=0, label="95 %")
        axis.plot(law.at * across, law.value * factor, color=_MODEL)
        axis.set_xlabel(f"{law.argument}, {argument}")
        told = f" at {law.frequency:.3g} Hz" if law.frequency else ""
        axis.set_title(f"{law.name}{told}, {unit}", fontsize="medium")
        least, most = np.min(law.value) * factor, np.max(law.value) * factor
        if np.all(np.isfinite(low)):
            reach = 0.5 * (most - least) + 0.02 * abs(most)  # a wide band must not flatten the law
            bottom, top = max(low.min(), least - reach), min(high.max(), most + reach)
            axis.set_ylim(bottom - 0.05 * (top - bottom), top + 0.05 * (top - bottom))
    for axis in axes.flat[len(laws) :]:
        axis.set_visible(False)
    axes[0, 0].legend(frameon=False, fontsize="small")
    return axes


def draw_comparison(comparison: Comparison, level: int, figure: Any = None) -> Any:
    channels = comparison.channels
    axes = _axes(figure, len(channels), 1, (8, 2.5 * len(channels) + 0.6), sharex=True)
    for axis, channel in zip(axes.flat, channels):
        spectrum = comparison.spectrum(channel, level)
        shown = {key: spectrum[key].to_numpy(dtype=float) for key in spectrum}
        # On lines that were not excited a linear model plays rounding, and any model what no comparison is about.
        shown["model"] = np.where(shown["model"] > 0.1 * shown["measured"], shown["model"], np.nan)
        for key, colour, style in (
            ("noise", _NOISE, {"linewidth": 1.0}),
            ("error", _ERROR, {"linewidth": 1.2}),
            ("measured", _MEASURED, {"linestyle": "", "marker": "o", "markersize": 3.5}),
            ("model", _SERIES[5], {"linestyle": "", "marker": "o", "markersize": 1.5}),
        ):
            if key in shown:
                axis.plot(spectrum.index, _decibels(shown[key]), color=colour, label=key, **style)
        unit = next(one["unit"] for one in comparison.document["channels"] if one["quantity"] == channel)
        axis.set_ylabel(f"{channel}\ndB re 1 {_WORDS.get(unit, unit)}")
    _hertz(axes[-1, 0])
    handles, labels = axes[0, 0].get_legend_handles_labels()
    axes[0, 0].legend(
        handles[::-1],
        labels[::-1],
        frameon=False,
        fontsize="small",
        ncols=4,
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
    )
    return axes


def draw_residuals(comparison: Comparison, figure: Any = None) -> Any:
    curves = comparison.residuals
    if not curves:
        raise Error(
            "The comparison has no residual force or voltage: the take has no waveforms of motion and current.", "data"
        )
    sorts = list(dict.fromkeys(curve.against for curve in curves))
    kinds = list(dict.fromkeys(curve.residual for curve in curves))
    axes = _axes(figure, len(kinds), len(sorts), (3.6 * len(sorts) + 0.6, 2.6 * len(kinds)), sharey="row")
    for kind, row in zip(kinds, axes):
        of_kind = [curve for curve in curves if curve.residual == kind]
        factor, unit = _shown([np.nanmax(np.abs(curve.mean)) for curve in of_kind], of_kind[0].unit)
        row[0].set_ylabel(f"{kind}, {unit}")
        for curve in of_kind:
            axis = row[sorts.index(curve.against)]
            across, argument = _shown(curve.at, curve.against_unit)
            mean, scatter = curve.mean * factor, curve.scatter * factor
            axis.fill_between(
                curve.at * across,
                mean - scatter,
                mean + scatter,
                color=_ERROR,
                alpha=0.2,
                linewidth=0,
                label="± scatter",
            )
            axis.plot(curve.at * across, mean, color=_ERROR)
            axis.set_xlabel(f"{curve.against}, {argument}")
    axes[0, 0].legend(frameon=False, fontsize="small")
    return axes


def draw_ladder(ladder: Ladder, figure: Any = None) -> Any:
    if not ladder.rungs:
        raise Error("The ladder has no rung: the take is not fit for use.", "data")
    table = ladder.table()
    errors = table[[column for column in table.columns if column.endswith(" dB")]]
    noise = errors.loc["noise"] if "noise" in errors.index else None
    errors = errors.drop(index="noise", errors="ignore")
    axes = _axes(figure, 1, 1, (max(5.0, 1.7 * len(errors) + 1.5), 3.8))
    axis = axes[0, 0]
    at = np.arange(len(errors))
    for colour, (name, values) in zip(_SERIES, errors.items()):
        axis.plot(at, values.to_numpy(dtype=float), "o-", color=colour, label=str(name)[:-3])
        if noise is not None:
            axis.axhline(noise[str(name)], color=colour, linestyle=":", linewidth=1)
    names = [
        f"+ {rung.added}" if rung.added else "linear" if not rung.model.effects else "first model"
        for rung in ladder.rungs
    ]
    axis.set_xticks(at, names, rotation=0 if len(names) < 5 else 30, ha="center" if len(names) < 5 else "right")
    axis.set_ylabel("error, dB of the channel")
    axis.margins(x=0.12)
    if noise is not None:
        axis.plot([], [], ":", color=_NOISE, label="noise")
    axis.legend(frameon=False, fontsize="small")
    return axes


def draw_whatif(whatif: WhatIf, channel: str | None, figure: Any = None) -> Any:
    from ._whatif import WHOLE

    wanted = channel if channel is not None else whatif.channels[-1]
    axes = _axes(figure, 1, 2, (9, 3.8), sharey=True)
    variants = [(WHOLE, "whole"), *((one["effect"], "without") for one in whatif.document["effects"] if one["without"])]
    for axis, parity in zip(axes.flat, ("even", "odd")):
        for colour, (effect, variant) in zip([_MEASURED, *_SERIES], variants):
            bands = whatif.bands(effect, variant, wanted)
            values = bands[parity].where(bands[parity] > _NO_DISTORTION)
            name = effect if variant == "whole" else f"without {effect}"
            axis.plot(
                bands.index,
                values,
                ".-",
                color=colour,
                linewidth=2 if variant == "whole" else 1.2,
                label=name if values.notna().any() else f"{name}: none",
            )
        axis.set_title(f"{parity} distortion of the {wanted}", fontsize="medium")
        _hertz(axis)
    axes[0, 0].set_ylabel("dB of the channel in the band")
    for axis in axes.flat:
        axis.legend(frameon=False, fontsize="small")
    return axes
