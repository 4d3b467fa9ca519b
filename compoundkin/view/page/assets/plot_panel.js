// One plot: its curves with their extremes, the cursor that is dragged, what part of the axes is seen.
(() => {
  "use strict";
  const page = window.compoundkin;
  const HEIGHT = 190;
  const PARTS = { "": "g1", x: "g1", y: "g2", length: "g0" };
  const DASH = [5, 4];
  const DOT = 3.5; // the radius of a mark
  const AIR = 0.1; // free space above and below the curves
  const FONT = "13px system-ui, sans-serif";

  // asked once: in the middle of a picture of the screen all styles would be found anew for it
  const colours = new Map();
  const colour = (name) => {
    if (!colours.has(name)) colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
    return colours.get(name);
  };
  const make = (tag, name, parent) => {
    const element = document.createElement(tag);
    element.className = name;
    parent.append(element);
    return element;
  };

  class Panel {
    // `within` has the player and what it is plotted along, the place, the extremes that are known, and how it is removed
    constructor(name, within) {
      Object.assign(this, within, { name });
      this.limits = { x: null, y: null };
      this.log = false;
      this.figure = make("figure", "plot", this.place.querySelector(".panels"));
      this.head = make("figcaption", "", this.figure);
      const title = make("strong", "", this.head);
      Object.assign(title, { textContent: page.inWords(name), title: name });
      this.head.append(" ");
      const value = make("span", "value", this.head);
      this.box = make("div", "canvas", this.figure);
      this.box.setAttribute("role", "img");
      this.read();
      this.labels = Object.keys(this.quantity.parts).map((part) => {
        const label = make("span", `part${part === "length" ? " dashed" : ""}`, value);
        label.style.setProperty("--own", `var(--${PARTS[part]})`);
        value.append(" ");
        return { label, part, called: part === "length" ? `|${name.split(".").pop()}| ` : part ? `${part} ` : "" };
      });
      this.build();
      page.axisControls(this);
      if (this.remove) this.removable();
      this.follow(this.player.pose);
    }

    // the quantity as it is now
    read() {
      const { axis } = this;
      this.quantity = page.quantity(this.player, this.name);
      const { parts, slopes, floor } = this.quantity;
      const ordered = (values) => values && axis.order.map((k) => values[k]);
      const isOwn = !this.player.design?.isChanged;
      const own = Object.entries(parts).filter(([part]) => part !== "length").map(([, values]) => Array.from(ordered(values)));
      const cuts = this.quantity.switched ? page.Curve.switches(own) : new Set();
      const curve = (part, ends) => new page.Curve(axis.xs, ordered(parts[part]), {
        cuts, slopes: ordered(slopes[part]), jumps: axis.jumps(this.name, part, isOwn), floor, extremes: ends,
      });
      this.curves = Object.keys(parts).map((part) => {
        const ends = (isOwn && this.extremes.get(part ? `${this.name}.${part}` : this.name)) || [];
        return part === "length" ? page.Curve.ofLength(curve("x", []), curve("y", []), ends, floor) : curve(part, ends);
      });
      this.rows = Object.values(parts).map((values) => axis.order.map((k) => (Number.isFinite(values[k]) ? values[k] : null)));
      this.before = isOwn ? this.curves : this.before ?? [];
      this.box.setAttribute("aria-label", this.words);
    }
    get words() {
      const { parts, unit } = this.quantity;
      const ranges = Object.keys(parts).map((part, k) => {
        const { low, high } = this.curves[k].ends;
        return `${part ? `${part} ` : ""}${low ? `from ${page.written(low.y)} to ${page.written(high.y)}` : "not known"}`;
      });
      return `${page.inWords(this.name)} over ${this.axis.name}: ${ranges.join("; ")} ${page.raised(unit)}`;
    }
    // what there is to be seen of all curves, the ones before a change too
    get whole() {
      const ends = [...this.curves, ...this.before].map((curve) => curve.ends).filter(({ low }) => low);
      const low = Math.min(...ends.map((one) => one.low.y)), high = Math.max(...ends.map((one) => one.high.y));
      if (!ends.length) return { x: this.axis.range, y: [-1, 1], low };
      const some = this.curves.concat(this.before).some((curve) => curve.marks.length);
      // what does not change is drawn in the middle of a range that does not tell of rounding
      const room = some ? AIR * (high - low) : Math.max(0.1 * Math.abs(high), this.quantity.floor) || 1;
      const y = this.log ? page.uPlot.rangeLog(low, high, 10, true) : [low - room, high + room];
      return { x: this.axis.range, y, low };
    }
    get mayLog() { return this.whole.low > 0; }

    build() {
      const { parts, unit } = this.quantity;
      const line = { stroke: () => colour("rule"), width: 1 };
      const style = { stroke: () => colour("quiet"), grid: line, ticks: line, font: FONT, labelFont: FONT, labelSize: 20 };
      const wide = (u, values) => (values || []).map((v) => (v === null ? "" : page.written(v).replace(/\.?0*e\+?/, "e")));
      const curve = (k) => (u) => ({
        stroke: this.drawn(u, this.curves[k]), fill: null, clip: null, band: null, gaps: null, flags: 1,
      });
      // dragging moves the cursor; with Shift it chooses a part of the axis, a double click shows all again
      const bind = {
        mousedown: (u, target, act) => (event) => { if (event.shiftKey) act(event); },
        dblclick: () => () => this.show({ x: null, y: null }),
      };
      this.plot = new page.uPlot({
        width: this.box.clientWidth || 480, height: HEIGHT, pxAlign: 0, legend: { show: false },
        scales: { x: { time: false, range: () => this.limits.x ?? this.whole.x }, y: { distr: this.log ? 3 : 1, range: () => this.limits.y ?? this.whole.y } },
        cursor: { x: false, y: false, points: { show: false }, drag: { x: true, y: false, setScale: false }, bind },
        axes: [
          { ...style, values: wide, label: this.axis.label, size: 34, ...this.axis.incrs },
          { ...style, values: wide, label: page.raised(unit), size: 58 },
        ],
        series: [{}, ...Object.keys(parts).map((part, k) => ({
          stroke: () => colour(PARTS[part]), width: part === "length" ? 1.5 : 2, dash: part === "length" ? DASH.map((long) => long * devicePixelRatio) : undefined,
          pxAlign: 0, points: { show: false }, paths: curve(k),
        }))],
        hooks: { drawAxes: [() => this.drawBefore()], draw: [() => this.drawMarks()], setSelect: [(u) => this.chosen(u.select)] },
      }, [this.axis.xs, ...this.rows], this.box);
      this.scale();
      this.cursor = make("div", "cursor", this.plot.over);
      this.plot.over.style.touchAction = "pan-y";
      const take = (event) => {
        const left = event.clientX - this.plot.over.getBoundingClientRect().left;
        this.player.transport.stop();
        this.player.show(this.axis.order[this.plot.valToIdx(this.plot.posToVal(left, "x"))]);
      };
      this.plot.over.addEventListener("pointerdown", (event) => {
        if (event.shiftKey) return;
        this.plot.over.setPointerCapture(event.pointerId);
        take(event);
      });
      this.plot.over.addEventListener("pointermove", (event) => { if (event.buttons && !event.shiftKey) take(event); });
    }
    drawn(u, curve) {
      return curve.path((x) => u.valToPos(x, "x", true), (y) => u.valToPos(y, "y", true), !this.log);
    }
    clipped(draw) {
      const { ctx, bbox } = this.plot;
      ctx.save();
      ctx.beginPath();
      const air = (DOT + 1) * devicePixelRatio;
      ctx.rect(bbox.left - air, bbox.top - air, bbox.width + 2 * air, bbox.height + 2 * air);
      ctx.clip();
      draw(ctx, devicePixelRatio);
      ctx.restore();
    }
    // the curves of the original, pale behind those of a changed design
    drawBefore() {
      if (this.before === this.curves) return;
      this.clipped((ctx, pixels) => {
        ctx.strokeStyle = colour("quiet");
        ctx.globalAlpha = 0.5;
        ctx.lineWidth = pixels;
        ctx.setLineDash([]);
        for (const curve of this.before) ctx.stroke(this.drawn(this.plot, curve));
      });
    }
    drawMarks() {
      this.clipped((ctx, pixels) => {
        ctx.lineWidth = 1.5 * pixels;
        ctx.setLineDash([]);
        ctx.fillStyle = colour("paper");
        this.curves.forEach((curve, k) => {
          ctx.strokeStyle = colour(PARTS[this.labels[k].part]);
          for (const { x, y } of curve.marks) {
            ctx.beginPath();
            ctx.arc(this.plot.valToPos(x, "x", true), this.plot.valToPos(y, "y", true), DOT * pixels, 0, 2 * Math.PI);
            ctx.fill();
            ctx.stroke();
          }
        });
      });
    }

    // --- what part of it is seen --------------------------------------------------------------------------------------
    show(limits) {
      Object.assign(this.limits, limits);
      this.scale();
      this.follow(this.player.pose);
      this.told?.();
    }
    // each scale asks for its range anew
    scale() {
      this.plot.batch(() => ["x", "y"].forEach((axis) => this.plot.setScale(axis, { min: null, max: null })));
    }
    chosen({ left, width }) {
      if (width < 4) return;
      const ends = [left, left + width].map((at) => this.plot.posToVal(at, "x"));
      this.plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
      this.show({ x: ends });
    }
    setLog(log) {
      this.log = log && this.mayLog;
      this.plot.destroy();
      this.build();
      this.follow(this.player.pose);
    }

    // --- pose and design ----------------------------------------------------------------------------------------------
    follow(k) {
      const x = this.plot.valToPos(this.axis.at(k), "x");
      this.cursor.style.transform = `translateX(${x}px)`;
      // nothing here asks where anything is on the page: the layout would be made anew for each plot
      this.cursor.hidden = !(x >= 0 && x <= this.plot.bbox.width / devicePixelRatio + 1);
      const { parts, unit } = this.quantity;
      for (const { label, called, part } of this.labels) {
        const text = `${called}${page.withUnit(parts[part][k], unit)}`;
        if (label.textContent !== text) label.textContent = text;
      }
    }
    refresh() {
      this.isBehind = false;
      this.read();
      if (this.log && !this.mayLog) return this.setLog(false);
      this.plot.setData([this.axis.xs, ...this.rows], false);
      this.scale();
      this.follow(this.player.pose);
    }
    // the canvas is as wide as its place
    fit() {
      const { clientWidth: width } = this.box;
      if (width && Math.abs(width - this.plot.width) > 1) this.plot.setSize({ width, height: HEIGHT });
    }
    removable() {
      const remove = make("button", "remove", this.head);
      remove.type = "button";
      remove.textContent = "Remove";
      remove.setAttribute("aria-label", `Remove the plot of the ${page.inWords(this.name)}`);
      remove.addEventListener("click", () => {
        this.plot.destroy();
        this.figure.remove();
        this.remove(this);
      });
    }
  }

  // another theme, or paper
  Panel.recolour = () => colours.clear();
  page.PlotPanel = Panel;
})();
