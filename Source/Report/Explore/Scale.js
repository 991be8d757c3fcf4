// SPDX-License-Identifier: GPL-3.0-or-later
// Axes: where a value stands, which values are labelled, and how numbers are written.

class Scale {
    /** @param from, to  px of the least and the most */
    constructor(least, most, logarithmic, from, to) {
        Object.assign(this, {least, most, logarithmic, from, to});
        this.bend = logarithmic ? Math.log : value => value;
        this.unbend = logarithmic ? Math.exp : value => value;
        this.origin = this.bend(least);
        this.slope = (to - from) / (this.bend(most) - this.origin);
    }
    at(value) { return this.from + (this.bend(value) - this.origin) * this.slope; }
    valueAt(px) { return this.unbend(this.origin + (px - this.from) / this.slope); }
    holds(value) { return value !== null && (!this.logarithmic || value > 0); }
}

function withMinus(text) { return text.replace("-", "\u2212"); }

function fixed(value, decimals) {
    const text = value.toFixed(Math.min(Math.max(decimals, 0), 10));
    return withMinus(Number(text) === 0 ? text.replace("-", "") : text);
}

/** 20, 500, 2k, 1e6 */
function shortNumber(value) {
    const size = Math.abs(value);
    if (size >= 1e3 && size < 1e6) return withMinus(String(Number((value / 1e3).toPrecision(6)))) + "k";
    return withMinus(size !== 0 && (size >= 1e6 || size < 1e-4) ? value.toExponential() : String(Number(value.toPrecision(6))));
}

/** A value as finely as a picture of that range shows it, and a little finer. */
function readable(value, scale) {
    if (scale.logarithmic) {
        const size = Math.abs(value);
        return size >= 1e5 || (size < 1e-3 && size > 0) ? withMinus(value.toExponential(3))
                                                        : fixed(value, 3 - Math.floor(Math.log10(size || 1)));
    }
    const step = Math.abs(scale.most - scale.least) / 1000;
    if (step < 1e-9) return withMinus(value.toExponential(4));
    return fixed(value, Math.ceil(-Math.log10(step)));
}

function evenLabels(scale, most) {
    const range = scale.most - scale.least;
    let step = Math.pow(10, Math.floor(Math.log10(range / most)));
    for (const factor of [1, 2, 5, 10])
        if (range / (step * factor) <= most) {
            step *= factor;
            break;
        }
    const labels = [], decimals = -Math.floor(Math.log10(step) + 1e-9);
    for (let k = Math.ceil(scale.least / step - 1e-9); k * step <= scale.most + 1e-9 * range; ++k) {
        const size = Math.abs(k * step);
        labels.push({value: k * step, text: size >= 1e5 || decimals > 5 ? shortNumber(k * step) : fixed(k * step, decimals)});
    }
    return labels;
}

function decadeLabels(scale, digits, every) {
    const labels = [];
    for (let decade = Math.floor(Math.log10(scale.least)); decade <= Math.log10(scale.most) + 1; ++decade)
        if (decade % every === 0)
            for (const digit of digits) {
                const value = Number(digit + "e" + decade);
                if (value >= scale.least * (1 - 1e-9) && value <= scale.most * (1 + 1e-9))
                    labels.push({value, text: shortNumber(value)});
            }
    return labels;
}

/** What an axis is labelled with: the densest that fits. */
function labelsOf(scale, names, most) {
    if (names && names.length) {
        const labels = names.map((text, value) => ({value, text}))
                            .filter(label => label.value >= scale.least && label.value <= scale.most);
        const every = Math.ceil(labels.length / most);
        return labels.filter((label, k) => k % every === 0);
    }
    if (!scale.logarithmic) return evenLabels(scale, most);
    for (const [digits, every] of [[[1, 2, 5], 1], [[1, 3], 1], [[1], 1], [[1], 2], [[1], 3]]) {
        const labels = decadeLabels(scale, digits, every);
        if (labels.length <= most && labels.length >= 3) return labels;
    }
    return evenLabels(scale, most);
}
