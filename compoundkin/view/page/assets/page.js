// What the other scripts share: the one global object, and what is said to screen readers.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});

  // a region that says the same twice is read out once: so it is emptied first
  page.say = (text) => {
    const said = document.getElementById("said");
    said.textContent = "";
    setTimeout(() => { said.textContent = text; }, 50);
  };

  // Boxes that scroll can be reached by keyboard; those that have no need to are no stops on its way.
  const boxes = document.querySelectorAll(".scroll, .picture");
  const fit = (box) => {
    const scrolls = box.scrollWidth > box.clientWidth + 1 || box.scrollHeight > box.clientHeight + 1;
    if (scrolls) { box.tabIndex = 0; box.setAttribute("role", "region"); }
    else { box.removeAttribute("tabindex"); box.removeAttribute("role"); }
    // a box that is no region has no use for a name
    for (const name of ["aria-label", "aria-labelledby"]) {
      const own = `data-${name}`;
      if (box.hasAttribute(name)) box.setAttribute(own, box.getAttribute(name));
      if (scrolls && box.hasAttribute(own)) box.setAttribute(name, box.getAttribute(own));
      else box.removeAttribute(name);
    }
  };
  const watch = new ResizeObserver((entries) => entries.forEach((entry) => fit(entry.target.closest(".scroll, .picture"))));
  for (const box of boxes) {
    watch.observe(box);
    if (box.firstElementChild) watch.observe(box.firstElementChild);
  }
})();
