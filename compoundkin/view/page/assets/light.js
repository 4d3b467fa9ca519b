// Links and groups light up together wherever they are: in sketches, tables, steps and graphs.
// An element says in data-links which links it shows or is about, commas between their names.
(() => {
  "use strict";
  const page = window.compoundkin;
  const root = document.documentElement;
  const held = document.getElementById("ck-groups");
  const groups = held ? JSON.parse(held.textContent).groups : [];
  const names = (element) => element.dataset.links.split(",");

  // A link in a picture stands for its group; the frame and driven links are no group, and a row is about what it names.
  const wanted = (element) => {
    const own = names(element);
    if (own.length > 1 || !element.closest("svg")) return own;
    const k = groups.findIndex((group) => group.includes(own[0]));
    return k > 0 ? groups[k] : own;
  };
  // In pictures the pairs at the ends of a link light up with it; of rows those that are about just these links, or
  // that all of these are part of: the pairs of a link, the loops through a pair.
  const fits = (element, links) => {
    const own = names(element);
    const among = own.filter((name) => links.includes(name)).length;
    return element.closest("svg") ? among > 0 : among === own.length || among === links.length;
  };

  let pinned = null;
  let shown = null;
  const light = (element) => {
    if (element === shown) return;
    shown = element;
    const links = element ? wanted(element) : [];
    root.classList.toggle("lighting", links.length > 0);
    for (const one of document.querySelectorAll("[data-links]")) one.classList.toggle("lit", links.length > 0 && fits(one, links));
    document.dispatchEvent(new CustomEvent("compoundkin:light", { detail: { links } }));
  };

  // --- a note that says what is pinned, with a way to free it by touch ----------------------------------------------
  const note = document.createElement("button");
  note.type = "button";
  note.className = "pinned";
  note.hidden = true;
  note.addEventListener("click", () => pin(null));
  document.body.append(note);

  const pin = (element) => {
    // where the keyboard is goes with the note that is pressed, not with the page
    const back = document.activeElement === note && pinned ? pinned.querySelector(".who") : null;
    if (pinned) press(pinned, false);
    pinned = element;
    light(element);
    note.hidden = !element;
    if (element) {
      press(element, true);
      note.textContent = `Pinned: ${wanted(element).join(", ")} ✕`;
      page.say(`${wanted(element).join(", ")} pinned. Escape frees.`);
    } else if (back) back.focus();
  };
  const press = (element, on) => {
    const button = element.matches("tr, .step") && element.querySelector(".who");
    if (button) button.setAttribute("aria-pressed", String(on));
  };

  const of = (event) => (event.target.closest ? event.target.closest("[data-links]") : null);
  document.addEventListener("pointerover", (event) => light(of(event) || pinned));
  document.addEventListener("pointerout", (event) => { if (!event.relatedTarget) light(pinned); });
  document.addEventListener("focusin", (event) => light(of(event) || pinned));
  document.addEventListener("focusout", () => light(pinned));
  document.addEventListener("click", (event) => {
    const element = of(event);
    // who selects text or presses another button does not want to pin
    const other = event.target.closest("button:not(.who), a, input, label, summary");
    if (!element || other || String(getSelection())) return;
    pin(element === pinned ? null : element);
  });
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && pinned) pin(null);
    // names that are no buttons, such as those below a sketch, are pressed like buttons
    if (!["Enter", " "].includes(event.key) || !event.target.matches("[data-links][tabindex]")) return;
    event.preventDefault();
    pin(event.target === pinned ? null : event.target);
  });
  page.pin = pin;

  // --- the names in a table are one stop of the keyboard; arrows go from row to row ---------------------------------
  const stops = (body) => [...body.querySelectorAll(".who")].filter((button) => button.getClientRects().length);
  const settle = (body) => {
    const seen = stops(body);
    for (const button of body.querySelectorAll(".who")) button.tabIndex = -1;
    if (seen.length) seen[0].tabIndex = 0;
  };
  document.querySelectorAll("tbody").forEach(settle);
  document.addEventListener("sort-end", (event) => event.target.querySelectorAll("tbody").forEach(settle));
  document.addEventListener("keydown", (event) => {
    const body = event.target.matches("tbody .who") && event.target.closest("tbody");
    if (!body) return;
    const all = stops(body);
    const at = all.indexOf(event.target);
    const to = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: all.length - 1 }[event.key];
    if (to === undefined || !all[to]) return;
    event.preventDefault();
    all[at].tabIndex = -1;
    all[to].tabIndex = 0;
    all[to].focus();
  });
})();
