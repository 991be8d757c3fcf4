// SPDX-License-Identifier: GPL-3.0-or-later
// Draws one picture in the size at which it is shown, over any part of its axes.

const dashes = ["", "", "6 4", "1.5 3", "7 3 1.5 3", "7 3 1.5 3 1.5 3"];
const textHeight = 12, letterWidth = 6.6, labelRoom = 58;  // px

function svg(name, attributes, ...children) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.append(...children);
    return element;
}

function strokeOf(series) {
    return {stroke: `var(${series.colour})`, "stroke-width": series.width, "stroke-dasharray": dashes[series.dash] || "none", fill: "none"};
}

/** The range of an axis: as it was asked for, or what its data covers. */
function wholeRange(plot, letter) {
    const axis = plot[letter];
    if (axis.least < axis.most) return [axis.least, axis.most];
    let least = Infinity, most = -Infinity;
    for (const series of plot.series)
        if (!series.hidden)
            for (const values of letter === "x" ? [series.x] : [series.y, series.lower, series.upper])
                for (const value of values || [])
                    if (value !== null && (!axis.log || value > 0)) {
                        least = Math.min(least, value);
                        most = Math.max(most, value);
                    }
    if (!(least <= most)) return [1, 10];
    if (letter === "x" && !axis.log && least < most && plot.series.some(series => series.points))
        return [least - (most - least) * 0.03, most + (most - least) * 0.03];  // no point on the border
    if (axis.log) return letter === "x" && least < most ? [least, most] : [least / 1.1, most * 1.1];
    const room = least < most ? (most - least) * 0.05 : Math.abs(most) * 0.05 || 1;
    return letter === "x" && least < most ? [least, most] : [least - room, most + room];
}

class Picture {
    constructor(plot) {
        this.plot = plot;
        this.whole = {x: wholeRange(plot, "x"), y: wholeRange(plot, "y")};
        this.view = {...this.whole};
        this.svg = svg("svg", {tabindex: 0, role: "img", "aria-label": plot.title});
    }

    shown() { return this.plot.series.filter(series => !series.off && !series.away); }

    /** @param width, height  px */
    draw(width, height) {
        const {x, y} = this.plot;
        const high = Math.max(3, Math.floor((height - 60) / 26));
        const lines = labelsOf(new Scale(...this.view.y, y.log, height, 0), y.names, high);
        this.left = 26 + Math.max(18, ...lines.map(label => label.text.length * letterWidth));
        this.box = {left: this.left, right: width - 16, top: 8, bottom: height - 3.1 * textHeight};
        this.x = new Scale(...this.view.x, x.log, this.box.left, this.box.right);
        this.y = new Scale(...this.view.y, y.log, this.box.bottom, this.box.top);
        const {left, right, top, bottom} = this.box;
        const wide = Math.max(2, Math.floor((right - left) / labelRoom));
        const columns = labelsOf(this.x, x.names, wide);
        const texts = svg("g", {class: "labels"});
        let grid = "";
        for (const {value, text} of columns) {
            grid += `M${this.x.at(value)} ${top}V${bottom}`;
            texts.append(svg("text", {x: this.x.at(value), y: bottom + 1.3 * textHeight, "text-anchor": "middle"}, text));
        }
        for (const {value, text} of lines) {
            grid += `M${left} ${this.y.at(value)}H${right}`;
            texts.append(svg("text", {x: left - 6, y: this.y.at(value) + 4, "text-anchor": "end"}, text));
        }
        texts.append(svg("text", {x: (left + right) / 2, y: height - 4, "text-anchor": "middle"}, titled(x)),
                     svg("text", {transform: `translate(12 ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle"}, titled(y)));
        // a nested element cuts off what is outside of it
        const inside = svg("svg", {x: left, y: top, width: right - left, height: bottom - top,
                                   viewBox: `${left} ${top} ${right - left} ${bottom - top}`});
        for (const series of this.shown()) inside.append(...this.band(series));
        for (const series of this.shown()) inside.append(...this.curve(series));
        this.cursor = svg("g", {class: "cursor"});
        this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
        this.svg.replaceChildren(svg("path", {class: "gridlines", d: grid}), svg("path", {class: "border", d: `M${left} ${top}V${bottom}H${right}`}),
                                 inside, texts, this.cursor);
    }

    place(series, k) {
        return this.x.holds(series.x[k]) && this.y.holds(series.y[k]) ? [this.x.at(series.x[k]), this.y.at(series.y[k])] : null;
    }

    curve(series) {
        let path = "", drawn = false;
        const points = [];
        for (let k = 0; k < series.y.length; ++k) {
            const place = this.place(series, k);
            if (place) {
                path += (drawn ? "L" : "M") + place[0].toFixed(2) + " " + place[1].toFixed(2);
                if (series.points) points.push(svg("circle", {cx: place[0], cy: place[1], r: 2.6, fill: `var(${series.colour})`}));
            }
            drawn = place !== null;
        }
        return [svg("path", {...strokeOf(series), d: path}), ...points];
    }

    band(series) {
        if (!series.lower) return [];
        const paths = [];
        let above = [], below = [];
        const close = () => {
            if (above.length > 1)
                paths.push(svg("path", {d: "M" + above.concat(below.reverse()).join("L") + "Z", fill: `var(${series.colour})`, opacity: 0.18}));
            above = [];
            below = [];
        };
        for (let k = 0; k < series.y.length; ++k) {
            if (!this.place(series, k) || !this.y.holds(series.lower[k]) || !this.y.holds(series.upper[k])) {
                close();
                continue;
            }
            above.push(`${this.x.at(series.x[k]).toFixed(2)} ${this.y.at(series.upper[k]).toFixed(2)}`);
            below.push(`${this.x.at(series.x[k]).toFixed(2)} ${this.y.at(series.lower[k]).toFixed(2)}`);
        }
        close();
        return paths;
    }
}

function titled(axis) { return axis.unit ? `${axis.title} (${axis.unit})` : axis.title; }
