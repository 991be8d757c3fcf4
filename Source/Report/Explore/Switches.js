// SPDX-License-Identifier: GPL-3.0-or-later
// Levels, rungs and whatever else the pictures of a chapter have in common, switched on and off for all of them.

/** The pictures of each chapter, by its heading. */
function chaptersOf(viewers) {
    const chapters = new Map();
    let heading = null;
    for (const part of document.querySelectorAll("main h2, main .picture")) {
        if (part.tagName === "H2") heading = part;
        const viewer = viewers.find(v => v.frame === part);
        if (heading && viewer) chapters.set(heading, [...(chapters.get(heading) ?? []), viewer]);
    }
    return chapters;
}

/** kind -> value -> whether it is shown at first: where anything that has it is. */
function facetsOf(viewers) {
    const kinds = new Map();
    const note = (facets, shown) => {
        for (const [kind, value] of Object.entries(facets ?? {})) {
            if (!kinds.has(kind)) kinds.set(kind, new Map());
            kinds.get(kind).set(value, shown || (kinds.get(kind).get(value) ?? false));
        }
    };
    for (const {plot} of viewers) {
        note(plot.facets, true);
        for (const series of plot.series) note(series.facets, !series.hidden);
    }
    return kinds;
}

function isOn(kinds, facets) { return Object.entries(facets ?? {}).every(([kind, value]) => kinds.get(kind).get(value)); }

function apply(kinds, viewers) {
    for (const viewer of viewers) {
        viewer.frame.hidden = !isOn(kinds, viewer.plot.facets);
        for (const series of viewer.plot.series) series.away = !isOn(kinds, series.facets);
        viewer.refresh();
    }
    for (const figure of new Set(viewers.map(viewer => viewer.frame.closest("figure")))) {
        figure.hidden = [...figure.querySelectorAll(".picture")].every(frame => frame.hidden);
        if (figure.previousElementSibling?.tagName === "H3") figure.previousElementSibling.hidden = figure.hidden;
    }
}

function addSwitches(heading, viewers) {
    const kinds = facetsOf(viewers), rows = [];
    for (const [kind, values] of kinds) {
        if (values.size < 2 && ![...values.values()].includes(false)) continue;
        const names = [...values.keys()];
        if (names.every(name => /^\d+ \u00b7/.test(name))) names.sort((a, b) => parseInt(a) - parseInt(b));  // rungs
        const buttons = names.map(value => {
            const button = element("button", {type: "button", "aria-pressed": String(values.get(value))}, value);
            button.addEventListener("click", () => {
                values.set(value, !values.get(value));
                button.setAttribute("aria-pressed", String(values.get(value)));
                apply(kinds, viewers);
            });
            return button;
        });
        rows.push(element("div", {role: "group", "aria-label": kind}, element("span", {}, kind), ...buttons));
    }
    if (rows.length) heading.after(element("div", {class: "switches"}, ...rows));
    apply(kinds, viewers);
}

function start() {
    const {arrays, plots} = JSON.parse(document.getElementById("curves").textContent);
    for (const plot of plots)
        for (const series of plot.series)
            for (const part of ["x", "y", "lower", "upper"])
                if (part in series) series[part] = arrays[series[part]];
    const viewers = [...document.querySelectorAll(".picture")].map((frame, k) => new Viewer(frame, plots[k]));
    for (const [heading, own] of chaptersOf(viewers)) addSwitches(heading, own);
}

start();
