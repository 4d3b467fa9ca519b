// Elements that panels are made of.
export const element = (name, text, attributes = {}, ...inner) => {
  const node = document.createElement(name);
  if (text) node.textContent = text;
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...inner);
  return node;
};

export const svgElement = (name, attributes = {}, parent = null) => {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  parent?.append(node);
  return node;
};

export const labelled = (words, field) => element("p", "", { class: "field" }, element("label", words, { for: field.id }), field);

// the package's own HTML: its texts are escaped there, and scripts are forbidden here
export const fragment = (html) => {
  const found = document.createDocumentFragment();
  found.append(...new DOMParser().parseFromString(html, "text/html").body.childNodes);
  // below a heading of the second level; boxes that scroll are reached by keys
  for (const one of found.querySelectorAll("h4")) one.replaceWith(element("h3", one.textContent));
  for (const one of found.querySelectorAll("thead th")) if (!one.textContent) one.replaceWith(element("td", ""));
  for (const one of found.querySelectorAll("div:has(> table)")) {
    for (const [key, value] of Object.entries({ tabindex: 0, role: "group", "aria-label": "Table" })) one.setAttribute(key, value);
  }
  return found;
};

// the parts of a window by their names
export const parts = (root) => (id) => root.querySelector(`#${id}`);
