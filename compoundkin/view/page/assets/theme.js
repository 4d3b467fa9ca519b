// Light, dark, or what the system prefers. Runs in the head, before anything is painted.
(() => {
  "use strict";
  const root = document.documentElement;
  const kept = "compoundkin-theme";
  // what only scripts serve is shown where scripts run
  root.classList.add("scripted");

  // a page opened from a file may be forbidden to remember anything
  const read = () => { try { return localStorage.getItem(kept); } catch { return null; } };
  const keep = (theme) => { try { localStorage.setItem(kept, theme); } catch { /* not remembered then */ } };

  const take = (theme) => {
    if (theme === "light" || theme === "dark") root.dataset.theme = theme;
    else delete root.dataset.theme;
  };
  // canvases do not follow style sheets: they are told
  const tell = () => document.dispatchEvent(new CustomEvent("compoundkin:theme"));

  take(read());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", tell);
  document.addEventListener("DOMContentLoaded", () => {
    for (const choice of document.querySelectorAll(".theme input")) {
      choice.checked = choice.value === (root.dataset.theme || "auto");
      choice.addEventListener("change", () => { take(choice.value); keep(choice.value); tell(); });
    }
  });
})();
