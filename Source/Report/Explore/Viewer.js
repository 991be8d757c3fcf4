// SPDX-License-Identifier: GPL-3.0-or-later
// A picture in a page that is read under the pointer and zoomed: by a frame, the wheel, two fingers, buttons and keys.

const leastFrame = 8, step = 1.6;  // px; zoom of one step

const icons = {
    in: "M8 3V13M3 8H13", out: "M3 8H13", whole: "M3 6V3H6M10 3H13V6M13 10V13H10M6 13H3V10", large: "M9 3H13V7M13 3L9 7M7 13H3V9M3 13L7 9"};

class Viewer {
    /** @param frame  what holds the picture that was drawn when the page was made */
    constructor(frame, plot) {
        this.frame = frame;
        this.plot = plot;
        this.picture = new Picture(plot);
        this.key = new Key(this.picture, () => this.refresh());
        this.fingers = new Map();
        this.live = element("div", {class: "live"}, this.key.element, this.key.where, this.picture.svg);
        frame.querySelector("h4").append(element("span", {class: "tools"}, this.tool("in", "zoom in", () => this.zoom(step)),
            this.tool("out", "zoom out", () => this.zoom(1 / step)), this.tool("whole", "show the whole", () => this.showWhole()),
            this.tool("large", "larger or smaller", () => { frame.classList.toggle("large"); this.draw(true); })));
        frame.append(this.live);
        frame.classList.add("alive");
        const on = (type, act) => this.picture.svg.addEventListener(type, act, {passive: false});
        on("pointerdown", event => this.press(event));
        on("pointermove", event => this.move(event));
        on("pointerup", event => this.release(event));
        on("pointercancel", event => { this.fingers.delete(event.pointerId); this.start = null; this.key.clear(); });
        on("pointerleave", event => { if (event.pointerType === "mouse" && !this.start) this.key.clear(); });
        on("dblclick", () => this.showWhole());
        on("wheel", event => this.wheel(event));
        on("keydown", event => this.type(event));
        new ResizeObserver(() => this.draw()).observe(frame);
    }

    tool(icon, title, act) {
        const button = element("button", {type: "button", title, "aria-label": title}, svg("svg", {viewBox: "0 0 16 16"}, svg("path", {d: icons[icon]})));
        button.addEventListener("click", act);
        return button;
    }

    draw(anew = false) {
        const width = Math.round(this.live.clientWidth);
        if (width < 40) {  // not shown: drawn when it is
            this.width = 0;
            return;
        }
        if (!anew && width === this.width) return;
        this.width = width;
        const usual = Math.min(Math.max(width * this.plot.height / this.plot.width, 210), 340);
        const height = this.frame.classList.contains("large") ? Math.max(usual, Math.min(width * 0.55, window.innerHeight * 0.75)) : usual;
        this.picture.draw(width, Math.round(height));
        this.key.clear();
    }

    refresh() {
        this.key.update();
        this.draw(true);
        const {view, whole} = this.picture;
        const zoomed = ["x", "y"].some(letter => view[letter].some((value, k) => value !== whole[letter][k]));
        // as it is now it is printed only where it was changed; else the picture that was drawn for paper is
        this.frame.classList.toggle("touched", zoomed || this.plot.series.some(series => series.off || (series.hidden && !series.away)));
    }

    show(view) {
        const {picture} = this;
        for (const letter of ["x", "y"]) {
            if (!view[letter]) continue;
            const whole = new Scale(...picture.whole[letter], picture.plot[letter].log, 0, 1);
            const [from, to] = view[letter].map(value => Math.min(Math.max(whole.at(value), 0), 1));
            if (to - from > 1e-6)
                picture.view[letter] = from <= 1e-9 && to >= 1 - 1e-9 ? picture.whole[letter] : [whole.valueAt(from), whole.valueAt(to)];
        }
        this.refresh();
    }

    showWhole() {
        this.picture.view = {...this.picture.whole};
        this.refresh();
    }

    /** @param px, py  what stays where it is; without them the middle */
    zoom(factor, px, py) {
        const {x, y, box} = this.picture;
        const around = (scale, at, from, to) => [from, to].map(end => scale.valueAt(at + (end - at) / factor));
        this.show({x: around(x, px ?? (box.left + box.right) / 2, box.left, box.right),
                   y: around(y, py ?? (box.top + box.bottom) / 2, box.bottom, box.top)});
    }

    place(event) {
        const bounds = this.picture.svg.getBoundingClientRect(), scale = this.width / bounds.width;
        return [(event.clientX - bounds.left) * scale, (event.clientY - bounds.top) * scale];
    }

    press(event) {
        const at = this.place(event);
        if (event.pointerType === "mouse") {
            if (event.button !== 0) return;
            this.start = at;
            this.picture.svg.setPointerCapture(event.pointerId);
        } else {
            this.fingers.set(event.pointerId, at);
            this.read(at);
        }
    }

    move(event) {
        const at = this.place(event);
        if (this.fingers.size === 2 && this.fingers.has(event.pointerId)) {
            const [other] = [...this.fingers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
            const before = this.fingers.get(event.pointerId), apart = p => Math.hypot(p[0] - other[0], p[1] - other[1]);
            this.fingers.set(event.pointerId, at);
            if (apart(before) > 20 && apart(at) > 20)
                this.zoom(apart(at) / apart(before), (at[0] + other[0]) / 2, (at[1] + other[1]) / 2);
            return;
        }
        this.read(at);
        if (this.start) this.drawFrame(at);
    }

    drawFrame(at) {
        const {x, y} = this.framed(at), {box, cursor} = this.picture;
        const [left, right] = x ?? [box.left, box.right], [top, bottom] = y ?? [box.top, box.bottom];
        if (x || y)
            cursor.append(svg("rect", {class: "frame", x: left, y: top, width: right - left, height: bottom - top}));
    }

    /** What a frame from where the button was pressed to here spans, px; of an axis along which it is thin nothing. */
    framed(at) {
        const span = (k, least, most) => {
            const [a, b] = [this.start[k], at[k]].map(v => Math.min(Math.max(v, least), most)).sort((p, q) => p - q);
            return b - a > leastFrame ? [a, b] : null;
        };
        const {box} = this.picture;
        return {x: span(0, box.left, box.right), y: span(1, box.top, box.bottom)};
    }

    release(event) {
        this.fingers.delete(event.pointerId);
        if (!this.start) return;
        const {x, y} = this.framed(this.place(event));
        this.start = null;
        if (x || y)
            this.show({x: x && x.map(px => this.picture.x.valueAt(px)), y: y && y.map(px => this.picture.y.valueAt(px)).reverse()});
    }

    wheel(event) {
        if (!event.ctrlKey) return;  // else the page scrolls
        event.preventDefault();
        this.zoom(Math.exp(-event.deltaY / 300), ...this.place(event));
    }

    read(at) { this.reading = this.key.tell(...at); }

    type(event) {
        const {picture} = this, keys = {
            "+": () => this.zoom(step), "-": () => this.zoom(1 / step), 0: () => this.showWhole(), Escape: () => this.showWhole(),
            ArrowLeft: () => this.walk(-1), ArrowRight: () => this.walk(1)};
        if (!keys[event.key] || event.ctrlKey || event.metaKey || !picture.box) return;
        event.preventDefault();
        keys[event.key]();
    }

    /** To the sample before or behind. */
    walk(by) {
        const {x, box} = this.picture;
        const series = this.picture.shown().find(s => s.x.length > 2 && ascending(s.x));
        if (!series) return;
        const here = x.at(this.reading ?? x.valueAt(box.left)), far = value => Math.abs(x.at(value) - here);
        const nearest = series.x.reduce((best, value, n) => (far(value) < far(series.x[best]) ? n : best), 0);
        const k = Math.min(Math.max(nearest + by, 0), series.x.length - 1);
        this.read([x.at(series.x[k]), (box.top + box.bottom) / 2]);
    }
}
