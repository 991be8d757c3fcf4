// SPDX-License-Identifier: GPL-3.0-or-later
// What stands under the pointer: the key of a picture, which tells the values.

const reach = 14, farReach = 40;  // px within which a point counts as under the pointer

function ascending(values) { return values.every((value, k) => value !== null && (k === 0 || value >= values[k - 1])); }

/** The sample of a series under the pointer: of a function of x the one beside, of scattered points the nearest. -1: none. */
function sampleAt(picture, series, px, py) {
    let best = -1, least = Infinity;
    const rising = series.ascending ??= ascending(series.x);
    for (let k = 0; k < series.x.length; ++k) {
        if (!picture.x.holds(series.x[k])) continue;
        const across = Math.abs(picture.x.at(series.x[k]) - px);
        const place = picture.place(series, k);
        const far = rising ? across : place ? Math.hypot(across, place[1] - py) : Infinity;
        if (far < least) [best, least] = [k, far];
    }
    if (best < 0 || !picture.place(series, best)) return -1;
    if (!rising) return least <= farReach ? best : -1;
    const gap = Math.max(...[best - 1, best + 1].map(k => series.x[k] === undefined
        ? 0 : Math.abs(picture.x.at(series.x[k]) - picture.x.at(series.x[best]))));
    return least <= Math.max(reach, gap / 2 + 1) ? best : -1;
}

/** The entries of the key: series that have no title belong to the one before of their colour. */
function entriesOf(plot) {
    const entries = [];
    for (const series of plot.series) {
        if (series.y.every(value => value === null)) continue;
        const before = entries.findLast(entry => entry.members[0].colour === series.colour);
        if (!series.title && before) before.members.push(series);
        else entries.push({title: series.title || series.told || plot.y.title, members: [series]});
    }
    return entries;
}

function element(tag, attributes, ...children) {
    const made = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
}

class Key {
    /** @param changed  called when an entry was switched on or off */
    constructor(picture, changed) {
        this.picture = picture;
        this.where = element("output", {class: "where"});
        this.entries = entriesOf(picture.plot);
        for (const entry of this.entries) {
            const [first] = entry.members;
            entry.value = element("output", {class: "value"});
            const line = svg("svg", {class: "swatch", viewBox: "0 0 20 8"});
            if (ascending(first.x)) line.append(svg("path", {...strokeOf(first), d: "M0 4H20", "stroke-width": Math.max(first.width, 1.6)}));
            if (first.points) line.append(svg("circle", {cx: 10, cy: 4, r: 3, fill: `var(${first.colour})`}));
            entry.button = element("button", {type: "button", "aria-pressed": "true", title: `${entry.title}: on or off`},
                                   line, element("span", {class: "name"}, entry.title), entry.value);
            entry.button.addEventListener("click", () => {
                for (const series of entry.members) series.off = !series.off;
                changed();
            });
        }
        this.element = element("div", {class: "key"}, ...this.entries.map(entry => entry.button));
        this.update();
    }

    update() {
        for (const entry of this.entries) {
            entry.button.hidden = entry.members.every(series => series.away);
            entry.button.setAttribute("aria-pressed", String(!entry.members[0].off));
        }
        this.clear();
    }

    clear() {
        this.where.textContent = "";
        for (const entry of this.entries) entry.value.textContent = "";
        this.picture.cursor?.replaceChildren();
    }

    /** Tells the values at a place of the picture, px. */
    tell(px, py) {
        const {picture} = this, {plot, x, y, box} = picture;
        this.clear();
        let snapped = null;
        for (const entry of this.entries) {
            let nearest = null;
            for (const series of entry.members) {
                if (series.off || series.away) continue;
                const k = sampleAt(picture, series, px, py);
                if (k < 0) continue;
                const [sx, sy] = picture.place(series, k), far = Math.abs(sy - py);
                if (!nearest || far < nearest.far) nearest = {series, k, sx, sy, far};
            }
            if (!nearest) continue;
            const {series, k, sx, sy} = nearest;
            const name = series.names ? series.names[k] + " " : entry.members.length > 1 && series.told ? series.told + " " : "";
            entry.value.textContent = name + readable(series.y[k], y) + (plot.y.unit ? "\u202f" + plot.y.unit : "");
            if (series.x.length === 2) continue;  // a level: its ends are no places
            snapped ??= series.x[k];
            if (sy >= box.top && sy <= box.bottom && sx >= box.left - 1 && sx <= box.right + 1)
                picture.cursor.append(svg("circle", {cx: sx, cy: sy, r: 4, fill: "var(--card)", stroke: `var(${series.colour})`, "stroke-width": 2}));
        }
        const value = snapped ?? x.valueAt(px), at = Math.min(Math.max(x.at(value), box.left), box.right);
        const name = plot.x.names && plot.x.names[Math.round(value)];
        this.where.textContent = `${plot.x.title} ${name ?? readable(value, x)}${plot.x.unit && !name ? "\u202f" + plot.x.unit : ""}`;
        picture.cursor.prepend(svg("path", {d: `M${at} ${box.top}V${box.bottom}`}));
        return value;
    }
}
