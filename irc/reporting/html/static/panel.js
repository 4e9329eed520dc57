// What stands around the chart: the tip, the details of an action, the tables, the figures.

/** An element with attributes and children; texts are only ever put in as texts. */
function element(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (key === "onclick") made.addEventListener("click", value);
    else if (value !== null && value !== false) made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}

const byId = (id) => document.getElementById(id);

/** "08:00 – 10:30 (120 – 270 min)", or without an origin "120 – 270 min". */
function timesOf(payload, cells) {
  const exact = `${cells[START]} – ${cells[END]} ${payload.unit}`;
  return cells[FROM] ? `${cells[FROM]} – ${cells[TO]} (${exact})` : exact;
}

class Tip {
  constructor() { this.box = byId("tip"); }

  show(lines, x, y) {
    this.box.replaceChildren(...lines);
    this.box.hidden = false;
    const { offsetWidth: width, offsetHeight: height } = this.box;
    const left = x + 16 + width > innerWidth ? Math.max(4, x - width - 12) : x + 16;
    this.box.style.left = `${left}px`;
    this.box.style.top = `${Math.max(4, Math.min(y + 14, innerHeight - height - 6))}px`;
  }

  hide() { this.box.hidden = true; }
}

function tipOf(payload, plan, found) {
  const say = (text, kind) => element("p", kind ? { class: kind } : {}, text);
  if (found.bar) {
    const { bar } = found, { cells } = bar;
    const lines = [element("strong", { dir: "auto" }, bar.name), say(timesOf(payload, cells))];
    if (cells[RESOURCES]) lines.push(say(cells[RESOURCES]));
    if (cells[ORDER]) lines.push(say(`order ${cells[ORDER]}`));
    if (bar.critical) lines.push(say("critical"));
    else if (cells[SLACK] !== "") lines.push(say(`slack ${cells[SLACK]} ${payload.unit}`));
    for (const [text] of bar.why.slice(0, 4)) lines.push(say(text, "why"));
    const ghost = plan.ghostOf.get(bar.key);
    if (ghost) lines.push(say(`before: ${timesOf(payload, ghost.cells)}${ghost.cells[RESOURCES] ? `, ${ghost.cells[RESOURCES]}` : ""}`));
    return lines;
  }
  if (found.setup) {
    const { setup } = found, of = setup.from ? `from ${setup.from} to ${setup.to}` : `for ${setup.to}`;
    return [element("strong", {}, "set-up"), say(of), say(`${setup.st} – ${setup.et} ${payload.unit}`)];
  }
  if (found.ghost) {
    const { ghost } = found;
    return [element("strong", { dir: "auto" }, ghost.name), say(`in the previous plan: ${timesOf(payload, ghost.cells)}`),
      say(ghost.bar ? "it has moved" : "it is not in this plan")];
  }
  return [element("strong", { dir: "auto" }, found.row.title)];
}

/** The details of an action, with what it waits for and what waits for it. */
function showDetail(payload, plan, bar, go, close) {
  const box = byId("detail");
  if (!bar) { box.hidden = true; return; }
  const facts = payload.tables.actions.columns.map(([title, , , used], k) => [title, k, used]).slice(0, -1)
    .filter(([, k, used]) => used && bar.cells[k] !== "" && k !== NAME);
  const link = (key) => {
    const other = plan.byKey.get(key);
    return other ? element("button", { type: "button", onclick: () => go(other) }, "show") : null;
  };
  const after = plan.bars.filter((other) => other.why.some(([, key]) => key === bar.key));
  box.replaceChildren(
    element("button", { type: "button", class: "close", "aria-label": "Close", onclick: close }, "×"),
    element("h3", { dir: "auto" }, bar.name),
    element("dl", {}, ...facts.flatMap(([title, k]) => [element("dt", {}, title), element("dd", { dir: "auto" }, bar.cells[k])]),
      ...(bar.critical ? [element("dt", {}, "critical"), element("dd", {}, "yes")] : [])),
    element("h4", {}, "Why it starts then"),
    bar.why.length ? element("ul", {}, ...bar.why.map(([text, key]) => element("li", {}, text, link(key))))
      : element("p", {}, "Nothing in the task holds it back: the plan has it then."),
    ...(after.length ? [element("h4", {}, "What waits for it"),
      element("ul", {}, ...after.slice(0, 20).map((other) => element("li", { dir: "auto" }, other.name, link(other.key))),
        ...(after.length > 20 ? [element("li", {}, `and ${after.length - 20} more`)] : []))] : []),
  );
  box.hidden = false;
}

/** Fills the figures above the chart from a plan. */
function showFigures(raw) {
  byId("figures").replaceChildren(...raw.figures.map(([name, value, note]) => element("div", {},
    element("dt", {}, name), element("dd", {}, value, note ? element("small", {}, note) : null))));
  const status = byId("status");
  status.textContent = raw.status_text;
  status.dataset.status = raw.status;
}

// --- tables -----------------------------------------------------------------------------------------

/** The cells of a table in a plan. */
function cellsOf(payload, plan, name) {
  return name === "actions" ? plan.raw.rows.map((r) => payload.rows[r].c) : plan.raw.tables[name] || [];
}

/** Writes the headers of a table anew: another payload can have columns that had nothing in them. */
function fillHead(table, columns) {
  const shown = columns.map((column, k) => k).filter((k) => columns[k][3]);
  table.tHead.rows[0].replaceChildren(...shown.map((k) => element("th", {
    scope: "col", "data-column": k, "data-kind": columns[k][1],
  }, columns[k][0])));
  makeSortable(table, columns);
}

/** Makes a table sortable: the headers become buttons. */
function makeSortable(table, columns) {
  table.querySelectorAll("thead th").forEach((head) => {
    const column = Number(head.dataset.column);
    const button = element("button", { type: "button", onclick: () => {
      const up = head.getAttribute("aria-sort") !== "ascending";
      table.querySelectorAll("thead th").forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      sortBy(table, columns[column][2], up);
    } }, head.textContent);
    head.replaceChildren(button);
  });
}

/** Sorts by the hidden value of a column, numbers by size and texts by alphabet; empty cells are last. */
function sortBy(table, column, up) {
  const body = table.tBodies[0];
  const text = (tr) => tr.cellsOf[column];
  const isNumber = (value) => /^-?[0-9.]+(\/[0-9]+)?$/.test(value);
  const sign = up ? 1 : -1;
  const compare = (a, b) => {
    const x = text(a), y = text(b);
    if (x === "" || y === "") return (x === "") - (y === "");
    if (isNumber(x) && isNumber(y)) return sign * (number(x) - number(y));
    return sign * x.localeCompare(y, "en", { numeric: true });
  };
  body.append(...[...body.rows].sort(compare));
}

/** Fills a table from a plan; of columns that no plan uses there is none. */
function fillTable(table, columns, rows) {
  const shown = columns.map((column, k) => k).filter((k) => columns[k][3]);
  table.tBodies[0].replaceChildren(...rows.map((cells) => {
    const tr = element("tr", {}, ...shown.map((k, place) => element(place ? "td" : "th", {
      class: columns[k][1] === "text" ? null : columns[k][1], scope: place ? null : "row", dir: columns[k][1] === "text" ? "auto" : null,
    }, cells[k])));
    tr.cellsOf = cells;
    return tr;
  }));
  table.querySelectorAll("thead th").forEach((head) => head.removeAttribute("aria-sort"));
}
