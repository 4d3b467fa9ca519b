// The state of a design as text: numbers that read back exactly, and the fragment of an address that holds them.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const DEGREE = Math.PI / 180;
  const HEAD = "#dimensions=";
  const LONGEST = 200000; // letters: an address with more was made by no page
  const LARGEST = 1e6; // sizes of the mechanism
  const NUMBER = /^([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)(deg|rad)?$/i;

  // the shortest text that reads back exactly, as files have it
  const plain = (value) => (Object.is(value, -0) ? "-0.0" : String(value));
  // degrees that make exactly these radians; null where there are none
  const degrees = (radians) => {
    const near = radians / DEGREE, next = 2 ** (Math.floor(Math.log2(Math.abs(near) || 1)) - 52);
    const tries = [...Array(15).keys()].map((digits) => Number(near.toFixed(digits)));
    return [...tries, near, near + next, near - next].find((value) => value * DEGREE === radians) ?? null;
  };

  const written = ({ kind }, value) => {
    if (kind !== "angle") return plain(value);
    const found = degrees(value);
    return found === null ? `${plain(value)}rad` : `${plain(found)}deg`;
  };
  // names keep their letters, whatever is no letter is escaped
  const fragment = (design) => {
    const { dimensions } = design.path.data;
    const found = dimensions.filter((_, k) => design.numbers[k] !== design.own[k]);
    return HEAD + found.map((one) => `${encodeURIComponent(one.name)}:${written(one, design.value(one.name))}`).join(",");
  };

  class Malformed extends Error {}

  // names with their texts; programs that send addresses around may have escaped all of it once more
  const split = (text) => {
    const whole = text.includes(":") ? text : decodeURIComponent(text);
    return whole.split(",").map((one) => {
      const at = one.lastIndexOf(":");
      if (at < 1) throw new Malformed("is not written as NAME:NUMBER");
      return [decodeURIComponent(one.slice(0, at)), decodeURIComponent(one.slice(at + 1))];
    });
  };
  const number = (one, text, size, sizes) => {
    const found = NUMBER.exec(text), value = found ? Number(found[1]) : NaN;
    if (!Number.isFinite(value)) throw new Malformed("has a number that cannot be read");
    if (found[2] && one.kind !== "angle") throw new Malformed("has an angle for a length");
    if (Math.abs(value) > LARGEST * (one.kind === "angle" ? 1 : size)) throw new Malformed("has a number that is too large");
    if (sizes.has(one.name) && value <= 0) throw new Malformed("has a size that is not greater than 0");
    return found[2] && found[2].toLowerCase() === "deg" ? value * DEGREE : value;
  };

  // what a fragment says: null for one about something else, else {values} or {problem}
  const read = (text, { path: { data } }) => {
    if (!text.startsWith(HEAD)) return null;
    try {
      if (text.length > LONGEST) throw new Malformed("is too long");
      const known = new Map(data.dimensions.map((one) => [one.name, one])), size = page.sizeOf(data.dimensions);
      const values = new Map(), sizes = new Set(data.panel.pairs.flatMap(({ rows }) => rows).filter((row) => row.size).map((row) => row.name));
      for (const [name, told] of split(text.slice(HEAD.length))) {
        if (!known.has(name)) throw new Malformed("names a dimension that cannot be changed here");
        if (values.has(name)) throw new Malformed("names a dimension twice");
        values.set(name, number(known.get(name), told, size, sizes));
      }
      return { values: Object.fromEntries(values) };
    } catch (error) {
      if (!(error instanceof Malformed || error instanceof URIError)) throw error;
      return { problem: error instanceof URIError ? "cannot be read" : error.message };
    }
  };

  Object.assign(page, { fragment, readFragment: read, plainNumber: plain, exactDegrees: degrees });
})();
