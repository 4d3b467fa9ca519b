// Elements that panels are made of.
export const element = (name, text, attributes = {}, ...inner) => {
  const node = document.createElement(name);
  if (text) node.textContent = text;
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...inner);
  return node;
};

export const labelled = (words, field) => element("p", "", { class: "field" }, element("label", words, { for: field.id }), field);

// the package's own HTML: its texts are escaped there, and scripts are forbidden here
export const fragment = (html) => {
  const found = document.createDocumentFragment();
  found.append(...new DOMParser().parseFromString(html, "text/html").body.childNodes);
  return found;
};

// the parts of a window by their names
export const parts = (root) => (id) => root.querySelector(`#${id}`);
