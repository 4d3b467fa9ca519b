// The window in a notebook: in a shadow root, so that styles and names of both do not meet; keys stay inside.
import { Studio } from "./studio.js";
import { ModelWire } from "./wire.js";

const isDark = () => document.body.dataset.jpThemeLight === "false" || document.body.matches(".vscode-dark, .dark, .dark-theme");

const render = ({ model, el }) => {
  const host = document.createElement("div");
  // shortcuts of JupyterLab, such as D for deleting a cell
  host.dataset.lmSuppressShortcuts = "true";
  if (isDark()) host.dataset.theme = "dark";
  const shadow = host.attachShadow({ mode: "open" }), sheet = new CSSStyleSheet();
  sheet.replaceSync(STYLE);
  shadow.adoptedStyleSheets = [sheet];
  shadow.innerHTML = MARKUP;
  el.append(host);
  host.addEventListener("keydown", (event) => event.stopPropagation());
  host.studio = new Studio(shadow.querySelector(".studio"), { wire: (told) => new ModelWire(model, told) });
  return () => {
    host.studio.unmount();
    host.remove();
  };
};

export default { render };
