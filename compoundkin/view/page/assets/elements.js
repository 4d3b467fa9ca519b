// New elements of a page: of its text, and of its sketch.
(() => {
  "use strict";
  const page = (window.compoundkin = window.compoundkin || {});
  const SVG = "http://www.w3.org/2000/svg";

  const given = (element, attributes, parent) => {
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    if (parent) parent.append(element);
    return element;
  };
  page.made = (name, attributes, parent) => given(document.createElement(name), attributes, parent);
  page.drawn = (name, attributes, parent) => given(document.createElementNS(SVG, name), attributes, parent);
})();
