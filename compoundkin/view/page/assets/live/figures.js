// Tables that follow: outputs at the poses, extremes, strokes, dead points, ranges, of the design as it is now.
(() => {
  "use strict";
  const page = window.compoundkin;
  const [player] = page.players, design = player?.design;
  if (!design || !page.Courses) return;
  const DEGREE = 180 / Math.PI;
  const RESTS = 100; // milliseconds without a change after which tables follow
  const SLICE = 6; // milliseconds of work between two pictures of the screen
  const ROUNDING = 1e-12; // of what is natural for a quantity, as in the report
  const FORCE_ROUNDING = 1e-11, NEGLIGIBLE = 1e-9; // of the largest force, of a mean beside its root mean square: as in forces_section.py
  const NEARLY = 1e-8, FLOOR = 1e-8; // as in range_rows.py: places, and lengths that pass zero, are known to so much
  const ALWAYS = "always", LIMITLESS = "without limit", NO_LIMIT = "no limit", NOTHING = "-";

  // forces follow where the page's program has them
  const FOLLOWING = player.data.live.forces ? "#outputs, #performance, #forces" : "#outputs, #performance";

  // --- numbers as the report writes them ------------------------------------------------------------------------------
  const trimmed = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);
  const number = (value) => {
    if (!value) return "0";
    const [digits, power] = value.toExponential(5).split("e").map((text, k) => (k ? Number(text) : trimmed(text)));
    if (power < -4 || power >= 6) return `${digits}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
    return trimmed(value.toFixed(5 - power));
  };
  // all numbers of a column with the same decimals: six digits for the largest, less the zeros that all end in
  const fixed = (values) => {
    const known = values.filter(Number.isFinite), largest = Math.max(0, ...known.map(Math.abs));
    if (largest && (largest < 1e-3 || largest >= 1e7)) {
      return (value) => (value ? value.toExponential(5).replace(/e([+-])(\d)$/, "e$10$2") : "0");
    }
    const most = largest ? Math.max(0, 5 - Math.floor(Math.log10(largest))) : 0;
    const needed = most ? Math.max(0, ...known.map((v) => (v.toFixed(most).replace(/0+$/, "").split(".")[1] ?? "").length)) : 0;
    return (value) => (Number(value.toFixed(needed)) + 0).toFixed(needed);
  };

  // --- cells: what they held at first comes back ------------------------------------------------------------------------
  const first = new Map();
  const put = (cell, text, digits) => {
    if (!first.has(cell)) first.set(cell, [cell.textContent, cell.dataset.sort]);
    const shown = text === NOTHING ? text : text.replace(/^-|(?<=\de)-/g, "−");
    if (cell.textContent !== shown) cell.textContent = shown;
    if (digits === shown || digits === undefined) delete cell.dataset.sort;
    else cell.dataset.sort = digits;
  };
  const tell = (cell, value) => {
    if (typeof value === "string") return put(cell, value, value);
    if (value === null || !Number.isFinite(value)) return put(cell, NOTHING, "");
    return put(cell, number(value), String(value + 0));
  };
  const restore = () => {
    for (const [cell, [text, digits]] of first) put(cell, text, digits);
    first.clear();
    for (const one of document.querySelectorAll(".behind")) one.classList.remove("behind");
    for (const [, note] of notes) note.hidden = true;
    for (const row of rows) row.tr.hidden = false;
    for (const row of added.splice(0)) row.remove();
  };

  // --- what there is to follow ------------------------------------------------------------------------------------------
  const unitOf = (text) => {
    const order = text.endsWith("/s²") ? 2 : text.endsWith("/s") ? 1 : 0;
    const kind = text.startsWith("rad") || text === "°" ? "angle" : text ? "length" : null;
    return { order, kind, by: text === "°" ? DEGREE : 1 };
  };
  const rows = [...document.querySelectorAll("tr[data-figure]")].map((tr) => {
    const [kind, ...names] = JSON.parse(tr.dataset.figure);
    return { tr, kind, names, cells: [...tr.cells], unit: unitOf(tr.cells[1].textContent) };
  }).filter(({ kind }) => kind !== "stays");
  const added = [];
  const { along } = player;
  const farthest = along.values.reduce((all, value) => Math.max(all, Math.abs(value)), 0);
  const place = (s, part) => {
    const k = Math.min(Math.floor(s), player.poses - 2), values = along.name === "pose" ? player.indices : along.values;
    const value = values[k] + (s - k) * (values[k + 1] - values[k]);
    return Math.abs(value) <= part * farthest ? 0 : value;
  };
  const near = (value, floor) => (Math.abs(value) <= floor ? 0 : value);

  // --- ranges -----------------------------------------------------------------------------------------------------------
  const ranged = (courses, name, { order, kind }, by = 1) => {
    const course = courses.of(name);
    if (!course) return null;
    const found = course.range(order, kind ? courses.scale(kind, order) : 1);
    if (found.none) return found;
    const [low, high] = [found.low, found.high].map(({ value, at }) => ({ value: value * by, at }));
    return { low, high, isConstant: found.isConstant, rounding: (kind ? courses.scale(kind, order) : 1) * ROUNDING };
  };
  // as the extremes of outputs are told, and as other ranges are
  const extremes = ({ low, high }, floor) => {
    const slack = Math.max(floor, ROUNDING * Math.max(Math.abs(low.value), Math.abs(high.value)));
    const ends = [low, high].map(({ value }) => near(value, floor));
    if (Number.isFinite(slack) && ends[1] - ends[0] <= slack) return [ends[0], ALWAYS, ends[1], ALWAYS];
    return [low, high].flatMap(({ at }, k) => [Number.isFinite(ends[k]) ? ends[k] : LIMITLESS, place(at, ROUNDING)]);
  };
  const varied = ({ low, high, isConstant, rounding = 0 }) => {
    const size = Math.max(Math.abs(low.value), Math.abs(high.value)), far = high.value - low.value;
    const floor = Number.isFinite(size) ? FLOOR * size : rounding;
    if (isConstant || far <= floor) {
      const value = far > floor ? 0 : low.value;
      return [value, ALWAYS, value, ALWAYS];
    }
    return [low, high].flatMap(({ value, at }) => [near(value, floor), place(at, NEARLY)]);
  };
  // the speed of the only driver that moves, where it is one
  const speed = (courses) => {
    const moving = courses.path.drives.filter(([value]) => value.some((one) => one !== value[0]));
    const rate = moving.length === 1 ? moving[0][1] : [];
    return rate.length && rate[0] && rate.every((one) => one === rate[0]) ? rate[0] : null;
  };
  const ratio = (courses, name, unit) => {
    const by = speed(courses), found = by && name ? ranged(courses, name, { order: 1, kind: unit }, 1 / by) : null;
    return found && !found.none && by < 0 ? { ...found, low: found.high, high: found.low } : found;
  };
  const advantage = ({ low, high }) => {
    const [near, far] = Math.abs(high.value) >= Math.abs(low.value) ? [low, high] : [high, low];
    const slack = Number.isFinite(far.value) ? ROUNDING * Math.abs(far.value) : 0;
    const toggles = low.value <= slack && high.value >= -slack;
    const least = [Math.abs(1 / far.value), place(far.at, NEARLY)];
    return [...least, ...(toggles ? [NO_LIMIT, null] : [Math.abs(1 / near.value), place(near.at, NEARLY)])];
  };
  const ofRange = (found, told) => (found && (found.none ? [null, null, null, null] : told(found)));

  // --- strokes and dead points --------------------------------------------------------------------------------------------
  const turning = (courses, [, rate]) => (rate && courses.of(rate) ? courses.of(rate).crossings : null);
  const stroke = (courses, [name, rate], unit) => {
    const found = ranged(courses, name, unit, unit.by);
    if (!found) return null;
    if (found.none) return [null, null, null, null, null];
    const far = found.isConstant ? 0 : found.high.value - found.low.value;
    return [Number.isFinite(far) ? far : null, ...ways(courses, found, courses.of(name), turning(courses, [name, rate]), unit.by)];
  };
  const ways = (courses, { low, high, isConstant }, course, turns, by) => {
    const none = [null, null, null, null], { last } = courses, { values } = course;
    const isTime = along.name === "time", whole = along.values[last] - along.values[0];
    const round = isTime || (along.unit === "deg" && Math.abs(Math.abs(whole) - 360) <= 1e-7);
    const far = (high.value - low.value) / by;
    if (isConstant || !round || !courses.closes || !turns || turns.length < 2 || Math.abs(values[last] - values[0]) > 1e-6 * far) return none;
    // two poses from there on are level
    const rests = ({ value, at }) => [0, 1].every((more) => Math.abs(values[Math.ceil(at) + more] - value / by) <= ROUNDING * Math.abs(value / by));
    if (rests(low) || rests(high)) return none;
    const go = Math.sign(whole) * (place(high.at, 0) - place(low.at, 0)), turn = Math.abs(whole);
    const forth = ((go % turn) + turn) % turn, back = turn - forth;
    if (!(Math.min(forth, back) > 0)) return none;
    return [forth, back, Math.max(forth, back) / Math.min(forth, back), isTime ? null : Math.abs(forth - back) / 2];
  };
  // rows of dead points come and go
  const dead = (courses, own) => {
    const { names, unit } = own[0], turns = turning(courses, names), course = courses.of(names[0]);
    if (!turns || !course) return own.forEach(({ tr }) => tr.classList.add("behind"));
    const lines = own.map(({ tr }) => tr);
    while (lines.length < turns.length) {
      const line = lines.at(-1).cloneNode(true);
      delete line.dataset.figure;
      lines.at(-1).after(line);
      lines.push(line);
      added.push(line);
    }
    lines.forEach((line, k) => {
      line.hidden = k >= turns.length;
      if (line.hidden) return;
      const [value, at] = [...line.cells].slice(-2);
      tell(value, course.at(turns[k]) * unit.by);
      tell(at, place(turns[k], NEARLY));
    });
  };

  // --- forces -----------------------------------------------------------------------------------------------------------
  const force = (courses, [name, by = "1"]) => {
    const course = courses.of(name), { largestForce: largest } = courses, factor = Number(by);
    if (!course) return null;
    const found = course.range(2, largest);
    if (found.none) return [null, null, null, null];
    const [low, high] = [found.low, found.high].map(({ value, at }) => ({ value: value * factor, at }));
    return extremes({ low, high }, FORCE_ROUNDING * largest * factor);
  };
  // a driver's effort or power, with its mean and root mean square over the motion
  const driver = (courses, [name, by = "1"]) => {
    const ends = force(courses, [name, by]);
    return ends && [...means(courses.of(name).values, Number(by)), ...ends];
  };
  const means = (values, by) => {
    const mean = averaged(values) * by, root = Math.sqrt(averaged(values.map((value) => value ** 2))) * by;
    return [Math.abs(mean) <= NEGLIGIBLE * root ? 0 : mean, root];
  };
  // over the time, or what the only driver that moves goes through, else over the poses; of poses that are known
  const averaged = (values) => {
    const at = along.name === "pose" ? player.indices : along.values;
    let sum = 0, whole = 0;
    for (let k = 1; k < values.length; k++) {
      const [a, b] = [values[k - 1], values[k]], step = Math.abs(at[k] - at[k - 1]);
      if (!Number.isFinite(a) || !Number.isFinite(b)) continue;
      sum += (step * (a + b)) / 2;
      whole += step;
    }
    return sum / whole;
  };

  // --- the poses ----------------------------------------------------------------------------------------------------------
  const outputs = () => {
    // rows that are folded away wait until they are asked for
    const whole = posed[0]?.closest("table").classList.contains("all");
    const seen = poses.filter(([row]) => whole || !row.classList.contains("more"));
    for (const head of document.querySelectorAll("th[data-quantity]")) {
      const name = head.dataset.quantity, dot = name.lastIndexOf(".");
      const whole = player.outputs.find((one) => one.name === name), vector = player.outputs.find((one) => one.name === name.slice(0, dot));
      const values = whole ? whole.parts[""] : vector && vector.parts[name.slice(dot + 1)];
      if (!values) continue;
      // what no program tells, as forces, stays as it was
      if (!design.solved.outputs[(whole ?? vector).name]) {
        for (const [row] of seen) row.cells[head.cellIndex].classList.add("behind");
        continue;
      }
      const write = fixed(poses.map(([, k]) => values[k])), column = head.cellIndex;
      for (const [row, k] of seen) {
        const value = values[k];
        if (Number.isFinite(value)) put(row.cells[column], write(value), String(value + 0));
        else put(row.cells[column], NOTHING, "");
      }
    }
  };
  const indices = new Map([...player.indices].map((index, k) => [index, k]));
  const posed = [...document.querySelectorAll("#outputs tr[data-pose]")];
  const poses = posed.filter((row) => indices.has(Number(row.dataset.pose))).map((row) => [row, indices.get(Number(row.dataset.pose))]);

  // --- all of it ------------------------------------------------------------------------------------------------------------
  const TOLD = {
    range: (courses, [name], unit) => ofRange(ranged(courses, name, unit, unit.by), (found) =>
      extremes(found, unit.kind ? courses.scale(unit.kind, unit.order) * ROUNDING : ROUNDING)),
    varied: (courses, [name], unit) => ofRange(ranged(courses, name, unit, unit.by), varied),
    transmission_angle: (courses, [name]) => ofRange(ranged(courses, name, unitOf("")), ({ low, high, isConstant }) => {
      const [a, b] = [low, high].map(({ value, at }) => ({ value: Math.asin(Math.min(Math.max(value, 0), 1)) * DEGREE, at }));
      return varied({ low: a, high: b, isConstant });
    }),
    velocity_ratio: (courses, [name], unit) => ofRange(ratio(courses, name, unit.kind ?? "angle"), varied),
    advantage: (courses, [name], unit) => ofRange(ratio(courses, name, unit.kind ?? "angle"), advantage),
    stroke,
    force,
    driver,
  };
  const behind = [
    ...document.querySelectorAll("#performance > :is(p, .alert)"),
    ...document.querySelectorAll("#forces > figure"),
    ...[...document.querySelectorAll("#forces > :is(p, .alert)")].filter((one) => !/^Assumed|:$/.test(one.textContent)),
    ...[...document.querySelectorAll(":is(#performance, #outputs, #forces) > .grid")].filter((one) => !one.querySelector("[data-figure], [data-pose]")),
    ...posed.filter((row) => !indices.has(Number(row.dataset.pose))),
  ];
  // in parts, so that a page may draw between them
  function* parts() {
    player.plots?.settle();
    if (!design.isChanged) return restore();
    yield;
    const courses = new page.Courses(design);
    for (const { tr, kind, names, cells, unit } of rows.filter((row) => row.kind !== "dead")) {
      const told = TOLD[kind] && TOLD[kind](courses, names, unit);
      tr.classList.toggle("behind", !told);
      if (told) cells.slice(-told.length).forEach((cell, k) => tell(cell, told[k]));
      yield;
    }
    for (const row of added.splice(0)) row.remove();
    const byName = new Map();
    for (const row of rows.filter(({ kind }) => kind === "dead")) byName.set(row.names[0], [...(byName.get(row.names[0]) ?? []), row]);
    for (const own of byName.values()) {
      dead(courses, own);
      yield;
    }
    outputs();
    yield;
    behind.forEach((one) => one.classList.add("behind"));
    for (const [section, note] of notes) note.hidden = !section.querySelector(".behind");
  }
  const follow = () => { for (const _ of parts()); };
  // as many parts as one picture of the screen has time for, then the next ones; a change begins anew
  const sliced = (rest = parts()) => {
    const begun = performance.now();
    while (performance.now() - begun < SLICE) if (rest.next().done) return;
    waits = setTimeout(() => sliced(rest));
  };
  const notes = [...document.querySelectorAll(FOLLOWING)].map((section) => {
    const note = document.createElement("p");
    Object.assign(note, { className: "italics", hidden: true, textContent: "What is in italics is of the original dimensions." });
    section.append(note);
    return [section, note];
  });
  let waits = null;
  design.on("change", () => {
    clearTimeout(waits);
    waits = setTimeout(() => sliced(), RESTS);
  });
  document.querySelector("#outputs .tools .more")?.addEventListener("click", () => { if (design.isChanged) outputs(); }, { signal: player.signal });
  player.atEnd(() => clearTimeout(waits));
  for (const section of document.querySelectorAll(`${FOLLOWING}, #motion`)) section.dataset.follows = "";
  player.figures = { follow };
})();
