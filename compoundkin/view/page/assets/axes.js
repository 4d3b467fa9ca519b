// The axes of a plot: their ends as numbers, a logarithmic one, and the whole range again.
(() => {
  "use strict";
  const page = window.compoundkin;
  const ENDS = [["x", 0, "from"], ["x", 1, "to"], ["y", 0, "lowest"], ["y", 1, "highest"]];

  const number = (text) => {
    const value = Number(text.trim().replace("−", "-").replace(",", "."));
    return text.trim() && Number.isFinite(value) ? value : null;
  };

  // A button in the head of a plot, and the row that it opens.
  page.axisControls = (panel) => {
    const open = document.createElement("button");
    Object.assign(open, { type: "button", className: "open-axes", textContent: "Axes" });
    open.setAttribute("aria-expanded", "false");
    open.setAttribute("aria-label", `Axes of the plot of ${panel.name}`);
    const row = document.createElement("div");
    row.className = "axes";
    row.hidden = true;

    const fields = ENDS.map(([axis, end, word]) => {
      const label = document.createElement("label");
      const field = document.createElement("input");
      Object.assign(field, { type: "text", inputMode: "decimal", size: 7 });
      label.append(`${word} `, field);
      row.append(label);
      field.addEventListener("change", () => {
        const ends = [...(panel.limits[axis] ?? panel.whole[axis])], value = number(field.value);
        ends[end] = value ?? panel.whole[axis][end];
        const may = ends[0] < ends[1] && !(panel.log && axis === "y" && ends[0] <= 0);
        field.setAttribute("aria-invalid", String(!may));
        if (may) panel.show({ [axis]: ends });
      });
      return { field, axis, end };
    });
    const label = document.createElement("label");
    const log = document.createElement("input");
    log.type = "checkbox";
    label.append(log, " logarithmic");
    log.addEventListener("change", () => { panel.limits.y = null; panel.setLog(log.checked); panel.told(); });
    const whole = document.createElement("button");
    Object.assign(whole, { type: "button", textContent: "Whole range" });
    whole.addEventListener("click", () => panel.show({ x: null, y: null }));
    row.append(label, whole);

    panel.told = () => {
      if (row.hidden) return;
      const shown = panel.whole;
      for (const { field, axis, end } of fields) {
        field.value = page.written((panel.limits[axis] ?? shown[axis])[end]);
        field.removeAttribute("aria-invalid");
      }
      log.checked = panel.log;
      log.disabled = !panel.mayLog;
    };
    open.addEventListener("click", () => {
      row.hidden = !row.hidden;
      open.setAttribute("aria-expanded", String(!row.hidden));
      panel.told();
    });
    panel.head.append(open);
    panel.head.after(row);
  };
})();
