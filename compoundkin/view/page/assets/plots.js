// Plots over the driver or the time, whose cursor is the pose that the sketch shows: drag it, and the sketch follows.
(() => {
  "use strict";
  const page = window.compoundkin;
  const player = page.players && page.players[0];
  const place = document.querySelector(".plots");
  if (!player || !place) return;
  const HEIGHT = 190;
  const ROUNDING = 3e-7;
  const TURNS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360, 720, 1080, 3600];
  const PARTS = { "": "g1", x: "g1", y: "g2", length: "g0" };

  // uPlot wants numbers that only grow along x; a driver that goes back and forth is drawn over the poses
  const grows = (values) => values.every((value, k) => k === 0 || value > values[k - 1]);
  const falls = (values) => values.every((value, k) => k === 0 || value < values[k - 1]);
  const along = player.along;
  const turned = player.poses > 1 && falls(along.values);
  const known = player.poses > 1 && (grows(along.values) || turned);
  const order = [...along.values.keys()];
  if (turned) order.reverse();
  const xs = known ? order.map((k) => along.values[k]) : order;
  const xLabel = known ? `${along.name}${along.unit ? ` [${page.raised(along.unit)}]` : ""}` : "pose";

  const inDegrees = known && along.unit === "deg";

  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  const panels = [];

  // --- a quantity by its name: one that came with the page, or one of any point or link -------------------------------
  const ofPoint = (letter, word) => {
    const order = ["position", "velocity", "acceleration"].indexOf(word);
    const unit = player.data.unit + ["", "/s", "/s^2"][order];
    const pairs = [...along.values.keys()].map((k) => (order ? player.rate(letter, order, k) : player.place(letter, k)));
    return { name: `${letter}.${word}`, unit, order, parts: { x: pairs.map((p) => p[0]), y: pairs.map((p) => p[1]) } };
  };
  const ofLink = (link, word) => {
    const order = ["angle", "angular_velocity", "angular_acceleration"].indexOf(word);
    const values = order ? (order === 1 ? link.v : link.a)[2] : [...link.angle].map((a) => (a * 180) / Math.PI);
    return { name: `${link.name}.${word}`, unit: ["deg", "rad/s", "rad/s^2"][order], order, parts: { "": values } };
  };
  // rates are packed with seven digits: what is smaller beside the largest of them is rounding
  const cleaned = (quantity) => {
    const largest = Math.max(...Object.values(quantity.parts).flatMap((values) => [...values]).filter(Number.isFinite).map(Math.abs), 0);
    const clean = (value) => (Math.abs(value) < ROUNDING * largest ? 0 : value);
    const parts = Object.fromEntries(Object.entries(quantity.parts).map(([name, values]) => [name, [...values].map(clean)]));
    return { ...quantity, parts };
  };
  const named = (name) => {
    const [owner, word] = [name.slice(0, name.lastIndexOf(".")), name.slice(name.lastIndexOf(".") + 1)];
    const link = player.links.find((one) => one.name === owner);
    return cleaned(link && word.startsWith("ang") ? ofLink(link, word) : ofPoint(owner, word));
  };

  // --- one plot -------------------------------------------------------------------------------------------------------
  const add = (quantity, removable) => {
    const parts = { ...quantity.parts };
    // the length of a rate says more than its parts; that of a position says nothing
    if (parts.x && quantity.order > 0) parts.length = [...parts.x].map((x, k) => Math.hypot(x, parts.y[k]));
    const figure = document.createElement("figure");
    figure.className = "plot";
    const head = document.createElement("figcaption");
    const title = document.createElement("strong");
    title.textContent = quantity.name;
    const value = document.createElement("span");
    value.className = "value";
    head.append(title, " ", value);
    const box = document.createElement("div");
    box.className = "canvas";
    figure.append(head, box);
    place.querySelector(".panels").append(figure);

    const names = Object.keys(parts);
    const rows = names.map((name) => order.map((k) => (Number.isFinite(parts[name][k]) ? parts[name][k] : null)));
    const axis = { stroke: () => colour("quiet"), grid: { stroke: () => colour("rule"), width: 1 }, ticks: { stroke: () => colour("rule"), width: 1 }, font: "13px system-ui, sans-serif", labelFont: "13px system-ui, sans-serif" };
    const wide = (u, values) => (values || []).map((v) => (v === null ? "" : page.written(v)));
    const plot = new page.uPlot({
      width: box.clientWidth || 480, height: HEIGHT, legend: { show: false },
      scales: { x: { time: false, range: (u, low, high) => (low === high ? [low - 1, high + 1] : [low, high]) } },
      cursor: { x: false, y: false, points: { show: false }, drag: { x: false, y: false } },
      axes: [
        { ...axis, values: wide, label: xLabel, labelSize: 20, size: 34, ...(inDegrees ? { incrs: TURNS } : {}) },
        { ...axis, values: wide, label: quantity.unit === "deg" ? "degrees" : page.raised(quantity.unit), labelSize: 20, size: 58 },
      ],
      series: [{}, ...names.map((name) => ({
        stroke: () => colour(PARTS[name]), width: name === "length" ? 1.5 : 2, dash: name === "length" ? [5, 4] : undefined,
        points: { show: true, size: 7, fill: () => colour("paper"), filter: (u, index) => extremes(u.data[index]) },
      }))],
    }, [xs, ...rows], box);

    const cursor = document.createElement("div");
    cursor.className = "cursor";
    plot.over.append(cursor);
    plot.over.style.touchAction = "pan-y";
    const take = (event) => {
      const left = event.clientX - plot.over.getBoundingClientRect().left;
      player.stop();
      player.show(order[plot.valToIdx(plot.posToVal(left, "x"))]);
    };
    plot.over.addEventListener("pointerdown", (event) => { plot.over.setPointerCapture(event.pointerId); take(event); });
    plot.over.addEventListener("pointermove", (event) => { if (event.buttons) take(event); });

    const labels = names.map((name) => {
      const label = document.createElement("span");
      label.className = "part";
      label.style.setProperty("--own", `var(--${PARTS[name]})`);
      value.append(label, " ");
      const called = name === "length" ? `|${quantity.name.split(".").pop()}| ` : name ? `${name} ` : "";
      return { label, called, own: parts[name] };
    });
    const panel = {
      plot, figure, box,
      follow: (k) => {
        const x = plot.valToPos(known ? along.values[k] : k, "x");
        cursor.style.transform = `translateX(${x}px)`;
        for (const { label, called, own } of labels) label.textContent = `${called}${page.withUnit(own[k], quantity.unit)}`;
      },
    };
    box.setAttribute("role", "img");
    box.setAttribute("aria-label", told(quantity, parts));
    if (removable) {
      const remove = document.createElement("button");
      remove.type = "button";
      remove.className = "remove";
      remove.textContent = "Remove";
      remove.setAttribute("aria-label", `Remove the plot of ${quantity.name}`);
      remove.addEventListener("click", () => {
        panels.splice(panels.indexOf(panel), 1);
        plot.destroy();
        figure.remove();
        place.querySelector(".quantity").focus();
      });
      head.append(remove);
    }
    panels.push(panel);
    panel.follow(player.pose);
    return panel;
  };
  // where a curve is highest and lowest: those places are marked
  const extremes = (values) => {
    let low = -1, high = -1;
    values.forEach((value, k) => {
      if (value === null) return;
      if (low < 0 || value < values[low]) low = k;
      if (high < 0 || value > values[high]) high = k;
    });
    return low < 0 || values[low] === values[high] ? [] : [Math.min(low, high), Math.max(low, high)];
  };
  const told = (quantity, parts) => {
    const ranges = Object.entries(parts).map(([name, values]) => {
      const good = [...values].filter(Number.isFinite);
      return `${name ? `${name} ` : ""}from ${page.written(Math.min(...good))} to ${page.written(Math.max(...good))}`;
    });
    return `${quantity.name} over ${known ? along.name : "poses"}: ${ranges.join("; ")} ${quantity.unit}`;
  };

  for (const output of player.outputs) add(output, false);
  player.listeners.push((k) => panels.forEach((panel) => panel.follow(k)));
  const button = place.querySelector(".add");
  if (button) {
    button.addEventListener("click", () => {
      const panel = add(named(place.querySelector(".quantity").value), true);
      panel.figure.scrollIntoView({ block: "nearest" });
    });
  }

  // --- canvases follow the page: its width, its colours, paper ---------------------------------------------------------
  const fitted = new ResizeObserver(() => panels.forEach(({ plot, box }) => {
    if (box.clientWidth && Math.abs(box.clientWidth - plot.width) > 1) plot.setSize({ width: box.clientWidth, height: HEIGHT });
  }));
  fitted.observe(place);
  const paint = () => panels.forEach(({ plot, follow }) => { plot.redraw(); follow(player.pose); });
  fitted && new ResizeObserver(() => panels.forEach(({ follow }) => follow(player.pose))).observe(place);
  document.addEventListener("compoundkin:theme", paint);
  matchMedia("print").addEventListener("change", paint);
  addEventListener("beforeprint", paint);
  addEventListener("afterprint", paint);
  page.plots = { panels, add: (name) => add(named(name), true) };
})();
