// Filters and sorts the report's tables; without it the page shows everything.
"use strict";
(() => {
  const rows = [...document.querySelectorAll("tr[data-facts]")].map((row) => ({
    row,
    facts: JSON.parse(row.dataset.facts),
  }));
  const bar = document.getElementById("filters");

  /** Show the rows that have every chosen value, and the titles of conditions that still have rows. */
  function filter() {
    const chosen = [...bar.querySelectorAll("select")]
      .filter((select) => select.value)
      .map((select) => [select.name, select.value]);
    for (const { row, facts } of rows)
      row.hidden = chosen.some(([name, value]) => name in facts && facts[name] !== value);
    for (const title of document.querySelectorAll("table.headline tr.condition")) {
      let next = title.nextElementSibling;
      while (next && !next.classList.contains("condition") && next.hidden) next = next.nextElementSibling;
      title.hidden = !next || next.classList.contains("condition");
    }
    const shown = rows.filter(({ row }) => row.closest("table.episodes") && !row.hidden).length;
    const all = rows.filter(({ row }) => row.closest("table.episodes")).length;
    bar.querySelector("output").textContent = chosen.length ? `${shown} of ${all} episodes` : "";
  }

  /** Add a choice for each factor that differs. */
  function offer() {
    const values = new Map();
    for (const { facts } of rows) {
      for (const [name, value] of Object.entries(facts)) values.set(name, (values.get(name) ?? new Set()).add(value));
    }
    for (const [name, found] of values) {
      if (found.size < 2) continue;
      const label = bar.appendChild(document.createElement("label"));
      label.textContent = `${name} `;
      const select = label.appendChild(document.createElement("select"));
      select.name = name;
      select.add(new Option("all", ""));
      for (const value of [...found].sort(new Intl.Collator("en", { numeric: true }).compare))
        select.add(new Option(value, value));
      select.addEventListener("change", filter);
    }
    bar.appendChild(document.createElement("output"));
    bar.hidden = !bar.querySelector("select");
  }

  /** Sort a table by one of its columns, numbers by value; once more turns the order round. */
  function sort(table, head) {
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const text = (row) => row.cells[head.cellIndex].textContent.trim();
    const compare = new Intl.Collator("en", { numeric: true }).compare;
    const order = (a, b) => {
      const [x, y] = [text(a), text(b)];
      if ((x === "–") !== (y === "–")) return x === "–" ? 1 : -1; // what is not known is last, either way
      const numbers = [Number(x), Number(y)];
      return (down ? -1 : 1) * (numbers.some(Number.isNaN) ? compare(x, y) : numbers[0] - numbers[1]);
    };
    table.tBodies[0].append(...[...table.tBodies[0].rows].sort(order));
  }

  /** Write into each cell what its column is called: on a phone, where there are no columns, the style shows it. */
  function nameCells(table) {
    const names = [...table.tHead.rows[0].cells].map((head) => {
      const unit = head.querySelector("small")?.textContent;
      return head.firstChild ? head.firstChild.textContent.trim() + (unit ? ` [${unit}]` : "") : "";
    });
    for (const row of table.tBodies[0].rows) {
      if (row.cells.length !== names.length) continue;
      for (const [at, cell] of [...row.cells].entries()) cell.dataset.label = names[at];
    }
  }

  for (const table of document.querySelectorAll("table.small")) nameCells(table);
  for (const table of document.querySelectorAll("table.sortable")) {
    for (const head of table.tHead.rows[0].cells) {
      head.tabIndex = 0;
      head.addEventListener("click", () => sort(table, head));
      head.addEventListener("keydown", (event) => event.key === "Enter" && sort(table, head));
    }
  }
  offer();
})();
