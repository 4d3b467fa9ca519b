// The gallery: a field that finds mechanisms by words of their names, a choice of kinds. Without scripts all are shown.
(() => {
  "use strict";
  const parts = [...document.querySelectorAll("section > .gallery")].map((list) => ({ list, section: list.parentElement }));
  if (!parts.length) return;
  const made = (name, attributes, ...inside) => {
    const element = document.createElement(name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    element.append(...inside);
    return element;
  };
  const heading = (section) => section.querySelector("h2").firstChild.textContent;
  const words = made("input", { type: "search", placeholder: "crank, gear, Watt …", autocomplete: "off" });
  const kind = made("select", {}, made("option", { value: "" }, "All kinds"));
  for (const { section } of parts) kind.append(made("option", { value: section.id }, heading(section)));
  const told = made("output", { "aria-live": "polite" });
  const form = made("form", { class: "finder", role: "search" }, made("label", {}, "Find ", words), made("label", {}, "Kind ", kind), told);
  form.addEventListener("submit", (event) => event.preventDefault());
  parts[0].section.before(form);

  // a picture moves while the pointer or the keyboard is on its card; not for those who want less motion
  const isStill = matchMedia("(prefers-reduced-motion: reduce)");
  for (const { list } of parts) {
    for (const item of list.querySelectorAll("li")) {
      const link = item.querySelector("a"), image = item.querySelector("img");
      if (!link || !image) continue;
      const still = image.src, moving = link.href.replace(/(\.html|\/)?(#.*)?$/, "-moving.svg");
      const put = (source) => () => { if (!isStill.matches) image.src = source; };
      // where there is none the still one stays
      image.addEventListener("error", () => { if (image.src !== still) image.src = still; });
      for (const kind of ["mouseenter", "focusin"]) item.addEventListener(kind, put(moving));
      for (const kind of ["mouseleave", "focusout"]) item.addEventListener(kind, put(still));
    }
  }

  const find = () => {
    const wanted = words.value.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    for (const { list, section } of parts) {
      let own = 0;
      for (const item of list.querySelectorAll("li")) {
        const said = `${item.textContent} ${item.querySelector("a").getAttribute("href")} ${heading(section)}`.toLowerCase();
        const fits = (!kind.value || kind.value === section.id) && wanted.every((word) => said.includes(word));
        item.hidden = !fits;
        own += fits;
      }
      section.hidden = !own;
      found += own;
    }
    told.textContent = wanted.length || kind.value ? `${found} found` : "";
  };
  words.addEventListener("input", find);
  kind.addEventListener("change", find);
  addEventListener("pageshow", find);
})();
