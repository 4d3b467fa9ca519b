// The reading: the numbers of a motion's outputs at the pose that the sketch shows.
(() => {
  "use strict";
  const page = window.compoundkin;

  class Reading {
    constructor(player) {
      const body = player.root.querySelector(".reading tbody");
      this.places = player.outputs.flatMap((output) => {
        const row = body.insertRow(), head = page.made("th", { scope: "row" }, row), cell = row.insertCell();
        head.textContent = page.inWords(output.name);
        head.title = output.name;
        return Object.entries(output.parts).map(([name, values]) => {
          const place = page.made("span", {}, cell);
          cell.append(" ");
          return { place, values, unit: output.unit, called: name ? `${name} ` : "" };
        });
      });
    }
    show(k) {
      for (const { place, values, unit, called } of this.places) place.textContent = `${called}${page.withUnit(values[k], unit)}`;
    }
  }

  page.Reading = Reading;
})();
