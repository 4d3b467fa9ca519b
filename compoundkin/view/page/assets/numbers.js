// Numbers of a page: unpacked, and written for people.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});

  // as markup.py packs them: one for all poses, or one for each
  const unpacked = (text, count) => {
    if (text === null) return new Float64Array(count).fill(NaN);
    if (typeof text === "number") return new Float64Array(count).fill(text);
    if (text[0] === "r") {
      const [first, step] = text.slice(2).split(",").map(Number);
      return Float64Array.from({ length: count }, (_, k) => first + step * k);
    }
    const bytes = Uint8Array.from(atob(text.slice(2)), (c) => c.charCodeAt(0));
    return text[0] === "d" ? new Float64Array(bytes.buffer) : Float64Array.from(new Float32Array(bytes.buffer));
  };
  // six digits, as in the report; no minus sign without a number
  const written = (value) => {
    if (!Number.isFinite(value)) return "–";
    const size = Math.abs(value);
    const text = size && (size >= 1e6 || size < 1e-4) ? value.toExponential(5) : String(Number(value.toPrecision(6)));
    return text.replace("-", "−");
  };
  // where a mechanism names no unit its lengths are plain numbers
  const raised = (unit) => unit === "length" ? "" : unit.replace("^2", "²").replace("^3", "³").replace(/^deg$/, "°").replace(/^deg\//, "°/");
  const withUnit = (value, unit) => {
    if (!Number.isFinite(value)) return written(value);
    return unit === "deg" ? `${written(value)}°` : `${written(value)} ${raised(unit)}`.trim();
  };

  // a quantity by its name in words: "bar.angular_velocity" is the angular velocity of bar
  const inWords = (name) => {
    const parts = name.split("."), last = parts.at(-1).replace(/_/g, " ");
    if (parts.length < 2) return last;
    if (["x", "y", "length"].includes(last) && parts.length > 2) return `${last} of the ${inWords(parts.slice(0, -1).join("."))}`;
    return `${last} of ${parts.slice(0, -1).join(".")}`;
  };

  Object.assign(page, { inWords, unpacked, written, raised, withUnit });
})();
