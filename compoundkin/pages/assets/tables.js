// Tables: all rows or the chosen ones, copied with every digit, sorted, the row of the pose that is shown.
(() => {
  "use strict";
  const page = window.compoundkin;
  const plain = (text) => text.replace(/\s+/g, " ").trim();

  // --- copying ---------------------------------------------------------------------------------------------------
  const exact = (cell) => plain(cell.dataset.copy ?? cell.dataset.sort ?? cell.textContent);
  const heads = (table) => [...table.tHead.rows[0].cells].map((cell) => plain(cell.textContent));
  const visible = (table) => [...table.tBodies[0].rows].filter((row) => row.getClientRects().length);

  // The rows that are seen, in the order in which they are seen, tabs between cells.
  page.tabbed = (table) => {
    const rows = visible(table).map((row) => [...row.cells].map(exact));
    return [heads(table), ...rows].map((row) => row.join("\t")).join("\n") + "\n";
  };

  // Pages opened from a file may lack the clipboard, and a browser may refuse it: what is selected is always copied.
  const selected = (text) => {
    const area = document.createElement("textarea");
    area.value = text;
    area.className = "unseen";
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done;
  };
  const written = async (text) => {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      return selected(text);
    }
  };
  const copy = async (button, table) => {
    const done = await written(page.tabbed(table));
    button.focus();
    page.say(done ? `${visible(table).length} rows copied` : "The browser does not allow copying");
    if (!done) return;
    button.classList.add("done");
    setTimeout(() => button.classList.remove("done"), 2000);
  };

  // --- all rows --------------------------------------------------------------------------------------------------
  const unfold = (button, table) => {
    const all = table.classList.toggle("all");
    button.textContent = all ? button.dataset.fewer : button.dataset.more;
    button.setAttribute("aria-expanded", String(all));
    page.say(`${visible(table).length} rows`);
  };

  document.addEventListener("click", (event) => {
    const button = event.target.closest(".tools button");
    if (!button) return;
    const table = document.getElementById(button.getAttribute("aria-controls"));
    if (button.classList.contains("copy")) copy(button, table);
    else unfold(button, table);
  });

  // --- sorting is done by Sortable; here it is said -----------------------------------------------------------------
  document.addEventListener("sort-end", (event) => {
    const head = event.target.querySelector("th[aria-sort]");
    if (head) page.say(`Sorted by ${plain(head.textContent)}, ${head.getAttribute("aria-sort")}`);
  });

  // --- the row of the pose that the sketch shows --------------------------------------------------------------------
  document.addEventListener("compoundkin:pose", (event) => {
    const pose = event.detail.pose;
    for (const table of document.querySelectorAll("table:has([data-pose])")) {
      let nearest = null;
      for (const row of table.querySelectorAll("tr[data-pose]")) {
        row.classList.remove("here");
        const away = Math.abs(row.dataset.pose - pose);
        if (row.getClientRects().length && (!nearest || away < Math.abs(nearest.dataset.pose - pose))) nearest = row;
      }
      if (nearest) nearest.classList.add("here");
    }
  });
})();
