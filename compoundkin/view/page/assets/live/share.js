// Taking along what a page was changed to: buttons that copy and save, the address, notes on what does not follow.
(() => {
  "use strict";
  const page = window.compoundkin;
  const root = document.getElementById("dimensions"), { design } = page;
  if (!root || !design) return;
  const { player } = design, told = root.querySelector(".told"), area = root.querySelector(".taken");

  // --- the buttons ---------------------------------------------------------------------------------------------------------------
  const tell = (text, isBad = false) => {
    told.textContent = text;
    told.classList.toggle("bad", isBad);
    page.say(text);
  };
  // where the browser allows no copying, the text stands there selected
  const copy = async (button, text, what) => {
    const done = await page.copied(text);
    area.hidden = done;
    button.focus();
    if (done) return tell(`${what} copied.`);
    area.value = text;
    area.focus();
    area.select();
    tell("The browser does not allow copying: press Ctrl C, or hold the selected text.");
  };
  const save = (text, suffix, kind) => {
    const link = document.createElement("a"), name = player.data.title.replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-|-$/g, "").toLowerCase();
    link.href = URL.createObjectURL(new Blob([text], { type: kind }));
    link.download = `${name || "mechanism"}.${suffix}`;
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    tell(`${link.download} saved.`);
  };
  const address = () => location.href.split("#")[0] + (design.isChanged ? page.fragment(design) : "");
  const acts = {
    toml: (button) => copy(button, page.tomlOf(design), "Mechanism file"),
    link: (button) => copy(button, address(), design.isChanged ? "Link to these dimensions" : "Link to the original dimensions"),
    csv: () => save(page.csvOf(player), "csv", "text/csv;charset=utf-8"),
    svg: () => save(page.svgOf(player), "svg", "image/svg+xml"),
  };
  for (const button of root.querySelectorAll("[data-share]")) button.addEventListener("click", () => acts[button.dataset.share](button));
  const { why } = design.path.data.toml;
  if (why) {
    root.querySelector("[data-share=toml]").disabled = true;
    tell(`There is no mechanism file: ${why}`);
  }

  // --- the address ---------------------------------------------------------------------------------------------------------------
  const open = () => {
    const found = page.readFragment(location.hash, design);
    if (!found) return;
    if (found.problem) return tell(`The address ${found.problem}: nothing was changed.`, true);
    design.load(found.values, "dimensions of the address");
    tell("Dimensions of the address.");
  };
  addEventListener("hashchange", open);
  open();

  // --- what does not follow --------------------------------------------------------------------------------------------------------
  const noted = () => {
    const others = [...document.querySelectorAll("section[data-depends]")].map((one) => [one.querySelector("h2"), !("follows" in one.dataset)]);
    for (const [head, depends] of [[document.querySelector(".badges"), true], ...others]) {
      if (!head) continue;
      let note = head.nextElementSibling && head.nextElementSibling.matches(".original") ? head.nextElementSibling : null;
      if (!note && design.isChanged && depends) {
        note = document.createElement("p");
        note.className = "original";
        note.textContent = "Of the original dimensions.";
        head.after(note);
      }
      if (note) note.hidden = !design.isChanged || !depends;
    }
  };
  design.on("change", noted);
  noted();
})();
