// A design in the forms that other programs take: a mechanism file, its numbers as CSV, the sketch as SVG.
(() => {
  "use strict";
  const page = window.compoundkin;

  // --- the mechanism's file: the template with its holes filled -------------------------------------------------------------
  // the pose that stands for the configuration in a drawing: where the motion starts, if it is assembled there
  const drawnAt = ({ assembled, data }) => (assembled[data.start] === 1 ? data.start : assembled.indexOf(1));
  const toml = (design) => {
    const { toml: pieces } = design.path.data, { numbers, own, player } = design;
    const changed = (k) => numbers[k] !== own[k];
    const inDegrees = (value) => {
      const found = page.exactDegrees(value);
      return found === null ? `{ rad = ${page.plainNumber(value)} }` : page.plainNumber(found);
    };
    const filled = (part) => {
      if (typeof part === "string") return part;
      if (!Array.isArray(part)) return page.plainNumber(numbers[part]);
      return part.length > 1 ? page.plainNumber(player.place(part[0], drawnAt(player))[part[1]]) : inDegrees(numbers[part[0]]);
    };
    // what has no place anywhere cannot be drawn
    const isDrawn = ({ changed: parts }) => !parts.some((part) => part.length > 1 && Array.isArray(part)) || drawnAt(player) >= 0;
    return pieces.map((piece) => {
      if (typeof piece === "string") return piece;
      const other = piece.of ? piece.of.some(changed) : design.isChanged;
      return other && isDrawn(piece) ? piece.changed.map(filled).join("") : piece.own;
    }).join("");
  };

  // --- its numbers at the poses of the page ----------------------------------------------------------------------------------
  const cell = (text) => (/[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
  const columns = (player) => {
    const { data } = player, found = new Map();
    const add = (name, unit, value) => found.has(name) || found.set(name, { head: unit ? `${name} [${unit}]` : name, value });
    const all = (one) => Object.entries(one.parts).forEach(([part, values]) => add(part ? `${one.name}.${part}` : one.name, one.unit, (k) => values[k]));
    add("pose", "", (k) => player.indices[k] + 1);
    if (player.along.name === "time") add("time", player.along.unit, (k) => player.along.values[k]);
    player.drivers.forEach(all);
    player.outputs.forEach(all);
    for (const letter in player.points) {
      ["x", "y"].forEach((axis, at) => add(`${letter}.position.${axis}`, data.unit, (k) => player.place(letter, k)[at]));
    }
    return [...found.values()];
  };
  // a pose that is not assembled has empty cells
  const csv = (player) => {
    const found = columns(player);
    const rows = [found.map(({ head }) => cell(head))];
    for (let k = 0; k < player.poses; k++) {
      rows.push(found.map(({ value }) => value(k)).map((value) => (Number.isFinite(value) ? String(value) : "")));
    }
    return rows.map((row) => row.join(",")).join("\n") + "\n";
  };

  // --- its picture, with every style written at what has it ----------------------------------------------------------------------
  const STYLES = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-dasharray", "stroke-linecap", "stroke-linejoin",
    "opacity", "paint-order", "vector-effect"];
  const OF_TEXT = ["font-family", "font-size", "font-style", "font-weight", "text-anchor", "dominant-baseline"];
  // as every reader of SVG has them without being told
  const USUAL = { fill: "rgb(0, 0, 0)", "fill-opacity": "1", stroke: "none", "stroke-width": "1px", "stroke-opacity": "1", "stroke-dasharray": "none",
    "stroke-linecap": "butt", "stroke-linejoin": "miter", opacity: "1", "paint-order": "normal", "vector-effect": "none", "font-style": "normal",
    "font-weight": "400", "text-anchor": "start", "dominant-baseline": "auto" };
  const PLACES = ["d", "x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "rx", "ry", "width", "height", "points", "transform", "dx", "dy", "textLength", "lengthAdjust"];
  const isGroup = (element) => element.localName === "g" || element.localName === "svg";
  // handles and the like are tools, no part of the picture
  const isPicture = (element) => !("tool" in element.dataset) && getComputedStyle(element).display !== "none";
  const drawn = (from) => {
    const to = page.drawn(from.localName, {}), style = getComputedStyle(from);
    for (const name of PLACES) if (from.hasAttribute(name)) to.setAttribute(name, from.getAttribute(name));
    const named = isGroup(from) ? ["opacity"] : [...STYLES, ...(/^(text|tspan)$/.test(from.localName) ? OF_TEXT : [])];
    for (const name of named) {
      const value = style.getPropertyValue(name);
      if (value && value !== USUAL[name]) to.setAttribute(name, value);
    }
    for (const child of from.childNodes) {
      if (child.nodeType === Node.TEXT_NODE) to.append(child.data);
      else if (child.nodeType === Node.ELEMENT_NODE && isPicture(child)) {
        const other = drawn(child);
        if (!isGroup(child) || other.hasChildNodes()) to.append(other);
      }
    }
    return to;
  };
  const paper = (element) => {
    for (let one = element; one; one = one.parentElement) {
      const { backgroundColor } = getComputedStyle(one);
      if (!/^(transparent|rgba\(.*, 0\))$/.test(backgroundColor)) return backgroundColor;
    }
    return "white";
  };
  const svg = ({ svg: sketch, data }) => {
    const { x, y, width, height } = sketch.viewBox.baseVal, whole = page.drawn("svg", { viewBox: `${x} ${y} ${width} ${height}`, width, height });
    const title = page.drawn("title", {});
    title.textContent = data.title;
    whole.append(title, page.drawn("rect", { x, y, width, height, fill: paper(sketch) }), drawn(sketch));
    const inner = whole.lastChild;
    inner.replaceWith(...inner.childNodes);
    return `${new XMLSerializer().serializeToString(whole)}\n`;
  };

  Object.assign(page, { tomlOf: toml, csvOf: csv, svgOf: svg });
})();
