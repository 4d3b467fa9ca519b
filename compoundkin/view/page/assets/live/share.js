// Taking along what a page was changed to: buttons that copy and save, the address, notes on what does not follow.
(() => {
  "use strict";
  const page = window.compoundkin;
  const root = document.getElementById("dimensions"), [player] = page.players, design = player?.design;
  if (!root || !design) return;
  const { signal } = player, told = root.querySelector(".told"), area = root.querySelector(".taken");

  // --- the buttons ---------------------------------------------------------------------------------------------------------------
  // what is refused is told where one looks when a page opens: above the sketch
  const notice = page.made("p", { class: "notice alert", role: "alert", hidden: "" });
  document.querySelector(".stage").before(notice);
  const tell = (text, isBad = false) => {
    told.textContent = text;
    told.classList.toggle("bad", isBad);
    notice.textContent = isBad ? text : "";
    notice.hidden = !isBad;
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
    csv: () => {
      // the poses of the motion, not one beside it
      const free = player.drag && player.drag.free;
      if (free && free.kept) {
        free.leave();
        player.showAgain();
      }
      save(page.csvOf(player), "csv", "text/csv;charset=utf-8");
    },
    svg: () => save(page.svgOf(player), "svg", "image/svg+xml"),
  };
  for (const button of root.querySelectorAll("[data-share]")) button.addEventListener("click", () => acts[button.dataset.share](button), { signal });
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
  // back to the address before it is back to what was there
  addEventListener("hashchange", ({ oldURL }) => {
    const before = !location.hash && page.readFragment(new URL(oldURL).hash, design);
    if (!before || before.problem) return open();
    design.load({}, "original dimensions");
    tell("Original dimensions.");
  }, { signal });

  // --- what does not follow --------------------------------------------------------------------------------------------------------
  // badges: that of the poses follows, those of checks and of published numbers are struck out; sections are folded away
  let isNoted = false;
  const ORIGINAL = "Of the original dimensions.";
  const badges = [...document.querySelectorAll(".badges > [data-badge]")], poses = badges.find((one) => one.dataset.badge === "assembled");
  const first = poses?.innerHTML, rest = badges.filter((one) => one !== poses);
  const badge = () => {
    const { count, poses: all, isAll } = design.assembly, good = count === all;
    const shown = page.made("span", { class: `badge ${good ? "good" : "bad"}` }), mark = page.made("span", { "aria-hidden": "true" }, shown);
    mark.textContent = good ? "✓" : "✗";
    shown.append(` ${count.toLocaleString("en")} of ${all.toLocaleString("en")} ${isAll ? "poses" : "poses shown"} assembled`);
    if (poses.textContent !== shown.textContent) poses.replaceChildren(shown);
  };
  // that among the badges has its room from the beginning: what is being dragged must not move
  const head = page.made("li", { class: "original" });
  if (!rest.length) head.textContent = "changed dimensions";
  // on a phone the word alone, beside the badges
  if (rest.length) for (const [text, kind] of [["struck out: of the ", "long"], ["original", ""], [" dimensions", "long"]]) page.made("span", { class: kind }, head).textContent = text;
  document.querySelector(".badges")?.append(head);
  const noted = () => {
    isNoted = design.isChanged;
    head.style.visibility = isNoted ? "" : "hidden";
    for (const one of rest) one.classList.toggle("stale", isNoted);
    for (const old of document.querySelectorAll("section > .original")) old.remove();
    for (const section of document.querySelectorAll("section[data-depends]:not([data-follows])")) {
      section.classList.toggle("folded", isNoted);
      if (isNoted) section.querySelector("h2").after(foldedNote(section));
    }
    if (poses && !isNoted) poses.innerHTML = first;
  };
  const foldedNote = (section) => {
    const made = page.made("p", { class: "original" }), button = page.made("button", { type: "button", class: "unfold", "aria-expanded": "false" });
    button.textContent = "Show";
    button.setAttribute("aria-label", `Show ${section.querySelector("h2").textContent} all the same`);
    button.addEventListener("click", () => {
      const isFolded = section.classList.toggle("folded");
      button.textContent = isFolded ? "Show" : "Hide";
      button.setAttribute("aria-expanded", String(!isFolded));
    });
    const why = section.id === "forces" && design.player.data.live.noForces;
    made.append(why ? `Of the original dimensions, for ${why}. ` : `${ORIGINAL} `, button);
    return made;
  };
  design.on("change", () => {
    if (design.isChanged !== isNoted) noted();
    if (isNoted && poses) badge();
  });
  noted();
  open();
})();
