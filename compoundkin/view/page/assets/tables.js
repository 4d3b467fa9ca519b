// Tables: all rows or the chosen ones, copied with every digit, sorted, the row of the pose that is shown.
(() => {
  "use strict";
  const page = window.compoundkin;
  const plain = (text) => text.replace(/\s+/g, " ").trim();

  // --- rows that are folded have their digits packed: each cell gets its own, as it is written elsewhere -----------------
  for (const row of document.querySelectorAll("tr[data-n]")) {
    const bytes = Uint8Array.from(atob(row.dataset.n), (c) => c.charCodeAt(0));
    new Float64Array(bytes.buffer).forEach((value, k) => {
      const cell = row.cells[k], digits = Number.isNaN(value) ? "" : String(value);
      cell.className = "number";
      if (digits !== cell.textContent) cell.dataset.sort = digits;
    });
    delete row.dataset.n;
  }

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
  page.copied = async (text) => {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      return selected(text);
    }
  };
  const copy = async (button, table) => {
    const done = await page.copied(page.tabbed(table));
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
    if (pose !== null) mark();
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
  // while the sketch plays this is done for every picture: nothing here asks where anything is on the page
  const tables = [...document.querySelectorAll("table:has([data-pose])")].map((table) => ({
    table, here: null, rows: [...table.querySelectorAll("tr[data-pose]")].map((row) => [row, Number(row.dataset.pose)]),
  }));
  let pose = null;
  const mark = () => {
    for (const one of tables) {
      const all = one.table.classList.contains("all");
      let nearest = null, least = Infinity;
      for (const [row, own] of one.rows) {
        const away = Math.abs(own - pose);
        if (away < least && (all || !row.classList.contains("more"))) [nearest, least] = [row, away];
      }
      if (nearest === one.here) continue;
      if (one.here) one.here.classList.remove("here");
      if (nearest) nearest.classList.add("here");
      one.here = nearest;
    }
  };
  document.addEventListener("compoundkin:pose", (event) => { pose = event.detail.pose; mark(); });
})();
