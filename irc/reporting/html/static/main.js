// The page: views, steps, search, theme, printing; and on a live board, what the server sends.

class Page {
  constructor(payload) {
    this.tip = new Tip();
    this.chart = new Chart((found, x, y) => this.pointed(found, x, y), (bar) => this.chosen(bar));
    this.view = null;
    this.wire();
    this.load(payload, false);
    this.chart.resize();
    this.chart.draw();
  }

  /** Takes a payload. `again`: one that follows another on a live board. */
  load(payload, again) {
    const atEnd = !again || this.k === this.payload.plans.length - 1;
    this.payload = payload;
    this.axis = new Axis(payload);
    this.plans = new Map();
    const offered = Object.keys(VIEWS).filter((name) => VIEWS[name].offered(payload));
    if (!offered.includes(this.view)) this.view = offered[0];
    this.offer(offered);
    const slider = byId("step");
    slider.max = payload.plans.length - 1;
    if (again) for (const [name, { columns }] of Object.entries(payload.tables)) fillHead(byId(`table-${name}`), columns);
    byId("steps").hidden = payload.plans.length < 2;
    this.showPlan(atEnd ? payload.plans.length - 1 : Math.min(this.k, payload.plans.length - 1), again, !again);
  }

  plan(k) {
    if (!this.plans.has(k)) {
      if (this.plans.size > 8) this.plans.clear();
      this.plans.set(k, new Plan(this.payload, k));
    }
    return this.plans.get(k);
  }

  /** Shows a plan. `keep` keeps what is visible; `asWritten`: the page has its figures and tables already. */
  showPlan(k, keep, asWritten) {
    this.k = k;
    this.now = this.plan(k);
    byId("step").value = k;
    const raw = this.now.raw, total = this.payload.plans.length;
    byId("step-text").textContent = `${k + 1} of ${total}${raw.label ? ` · ${raw.label}` : ""}`;
    byId("step").setAttribute("aria-valuetext", byId("step-text").textContent);
    byId("step-events").replaceChildren(...raw.events.map((text) => element("li", {}, text)));
    byId("changes-switch").hidden = !this.now.ghosts.length;
    byId("critical-switch").hidden = !this.now.bars.some((bar) => bar.critical);
    if (!asWritten) showFigures(raw);
    // (The tables come behind the script in the page, so that the chart need not wait for them.)
    if (document.readyState === "loading") {
      addEventListener("DOMContentLoaded", () => this.fillTables(this.k === this.payload.plans.length - 1), { once: true });
    } else this.fillTables(asWritten);
    this.chart.chosen = null;
    this.chosen(null);
    const nothing = !this.now.bars.length && !this.now.ghosts.length;
    for (const id of ["tools", "stage"]) byId(id).hidden = nothing;
    this.showRows(keep);
    this.search();
  }

  showRows(keep) {
    const colours = this.colours();
    this.chart.show(this.now, this.axis, VIEWS[this.view].rows(this.now), colours.of, keep);
    this.legend(colours);
  }

  /** The colour of a bar: that of its order; without orders, that of its first resource. */
  colours() {
    const { payload } = this;
    if (payload.orders.length && this.view !== "order") {
      const none = greyBeyond(payload.orders.length);
      return { names: payload.orders, none, of: (bar) => (bar.order < 0 ? none : bar.order), what: "order" };
    }
    const names = payload.resources.map((resource) => resource.name);
    const none = greyBeyond(names.length);
    return { names, none, of: (bar) => (bar.uses.length ? bar.uses[0][0] : none), what: "resource" };
  }

  offer(offered) {
    const views = byId("views");
    views.replaceChildren(views.firstElementChild, ...offered.map((name) => {
      const input = element("input", { type: "radio", name: "view", value: name });
      input.checked = name === this.view;
      input.addEventListener("change", () => { this.view = name; byId("scroller").scrollTop = 0; this.showRows(true); });
      return element("label", {}, input, element("span", {}, VIEWS[name].title));
    }));
  }

  wire() {
    const { chart } = this, on = (id, name, does) => byId(id).addEventListener(name, does);
    on("zoom-in", "click", () => chart.zoom(0.6));
    on("zoom-out", "click", () => chart.zoom(1 / 0.6));
    on("fit", "click", () => chart.fit());
    on("show-critical", "change", (event) => { chart.critical = event.target.checked; chart.request(); });
    on("show-changes", "change", (event) => { chart.changes = event.target.checked; chart.request(); });
    on("step", "input", (event) => this.showPlan(Number(event.target.value), true, false));
    on("step-back", "click", () => this.showPlan(Math.max(0, this.k - 1), true, false));
    on("step-on", "click", () => this.showPlan(Math.min(this.payload.plans.length - 1, this.k + 1), true, false));
    on("search", "input", () => this.search());
    on("search", "keydown", (event) => { if (event.key === "Enter") { event.preventDefault(); this.nextMatch(event.shiftKey ? -1 : 1); } });
    on("print", "click", () => print());
    on("theme", "click", () => this.theme());
    const dark = matchMedia("(prefers-color-scheme: dark)");
    dark.addEventListener("change", () => this.themed());
    this.themed();
    addEventListener("beforeprint", () => this.beforePrint());
    addEventListener("afterprint", () => this.afterPrint());
    addEventListener("resize", () => chart.plan && chart.resize());
    addEventListener("keydown", (event) => { if (event.key === "Escape") { this.tip.hide(); if (chart.chosen) chart.choose(null); } });
  }

  isDark() {
    const { theme } = document.documentElement.dataset;
    return theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  }

  theme() {
    document.documentElement.dataset.theme = this.isDark() ? "light" : "dark";
    this.themed();
  }

  themed() {
    byId("theme").setAttribute("aria-pressed", String(this.isDark()));
    this.repaint();
  }

  repaint() {
    this.chart.paint.read();
    this.chart.area = null;
    if (!this.now) return;
    this.legend(this.colours());
    this.chart.request();
  }

  // --- pointing ---------------------------------------------------------------------------------

  pointed(found, x, y) {
    if (!found) { this.tip.hide(); return; }
    if (found.spoken) { byId("spoken").textContent = this.spoken(found.bar); return; }
    const onName = !found.bar && !found.setup && !found.ghost;
    if (onName && x - byId("scroller").getBoundingClientRect().left > this.chart.gutter) { this.tip.hide(); return; }
    this.tip.show(tipOf(this.payload, this.now, found), x, y);
  }

  spoken(bar) {
    const { cells } = bar;
    return [bar.name, timesOf(this.payload, cells), cells[RESOURCES], cells[ORDER] && `order ${cells[ORDER]}`, bar.critical && "critical",
      cells[SLACK] !== "" && `slack ${cells[SLACK]} ${this.payload.unit}`, ...bar.why.map(([text]) => text)].filter(Boolean).join(", ");
  }

  chosen(bar) {
    this.tip.hide();
    showDetail(this.payload, this.now, bar, (other) => { this.chart.reveal(other, false); this.chart.choose(other); },
      () => { this.chart.choose(null); byId("scroller").focus(); });
    if (bar) byId("spoken").textContent = this.spoken(bar);
  }

  // --- search -----------------------------------------------------------------------------------

  search() {
    const wanted = byId("search").value.trim().toLocaleLowerCase();
    const { bars } = this.now;
    this.found = wanted ? bars.filter((bar) => [bar.name, ...bar.cells].some((text) => String(text).toLocaleLowerCase().includes(wanted))) : [];
    this.chart.matches = wanted ? new Set(this.found.map((bar) => bar.key)) : null;
    byId("found").textContent = wanted ? `${this.found.length} of ${bars.length}` : "";
    const table = byId("table-actions");
    for (const tr of table ? table.tBodies[0].rows : []) if (tr.cellsOf) tr.hidden = Boolean(wanted) && !this.chart.matches.has(keyOf(tr.cellsOf));
    this.matchAt = -1;
    this.chart.request();
  }

  nextMatch(by) {
    if (!this.found.length) return;
    this.matchAt = (this.matchAt + by + this.found.length) % this.found.length;
    const bar = this.found[this.matchAt];
    this.chart.reveal(bar, true);
    byId("found").textContent = `${this.matchAt + 1} of ${this.found.length}`;
    byId("spoken").textContent = this.spoken(bar);
  }

  // --- tables and legend ------------------------------------------------------------------------

  fillTables(asWritten) {
    for (const [name, { columns }] of Object.entries(this.payload.tables)) {
      const table = byId(`table-${name}`), rows = cellsOf(this.payload, this.now, name);
      if (asWritten) {
        makeSortable(table, columns);
        [...table.tBodies[0].rows].forEach((tr, k) => { tr.cellsOf = rows[k]; });
      } else fillTable(table, columns, rows);
      byId(`part-${name}`).hidden = !rows.length;
    }
  }

  legend(colours) {
    const { paint } = this.chart, used = new Set(this.now.bars.map((bar) => colours.of(bar)));
    const sign = (text, draw) => {
      const canvas = element("canvas", { width: 60, height: 32, "aria-hidden": "true" });
      const ctx = canvas.getContext("2d");
      ctx.scale(2, 2);
      draw(ctx);
      return element("span", {}, canvas, element("bdi", {}, text));
    };
    const swatch = (k) => (ctx) => { ctx.fillStyle = paint.fill(ctx, k); ctx.fillRect(0, 0, 30, 16); ctx.fillStyle = paint.colour(k); ctx.fillRect(0, 0, 4, 16); };
    const signs = [];
    const bars = this.view === "resource" || this.view === "order" || this.view === "action";
    if (bars) {
      const named = [...used].sort((a, b) => a - b).filter((k) => k < colours.names.length);
      if (named.length) signs.push(element("span", {}, `by ${colours.what}:`));
      for (const k of named.slice(0, 14)) signs.push(sign(colours.names[k], swatch(k)));
      if (named.length && named.length < used.size) signs.push(sign(`no ${colours.what}`, swatch(colours.none)));
      if (named.length > 14) signs.push(element("span", {}, `and ${named.length - 14} more, told apart by colour and pattern`));
      if (this.now.bars.some((bar) => bar.critical)) {
        signs.push(sign("critical", (ctx) => { ctx.fillStyle = mix(paint.soft, paint.back, 0.2); ctx.fillRect(0, 0, 30, 16); ctx.fillStyle = paint.critical; ctx.fillRect(0, 0, 30, 2); ctx.fillRect(0, 12, 30, 4); }));
      }
      if (this.now.bars.some((bar) => bar.e === bar.s)) {
        signs.push(sign("takes no time", (ctx) => { ctx.fillStyle = paint.soft; ctx.beginPath(); ctx.moveTo(15, 1); ctx.lineTo(22, 8); ctx.lineTo(15, 15); ctx.lineTo(8, 8); ctx.fill(); }));
      }
      if (this.now.bars.some((bar) => bar.pauses.length)) {
        signs.push(sign("pause", (ctx) => drawPause(ctx, paint, 0, 0, 30, 0, 16)));
      }
      if (this.now.bars.some((bar) => bar.cells[STATUS])) {
        signs.push(sign("ended before it was done", (ctx) => { ctx.strokeStyle = paint.bad; ctx.lineWidth = 1.5; ctx.strokeRect(1, 1, 28, 14); ctx.beginPath(); ctx.moveTo(1, 15); ctx.lineTo(29, 1); ctx.stroke(); }));
      }
      if (this.view === "resource" && this.now.raw.setups.length) {
        signs.push(sign("set-up", (ctx) => { ctx.fillStyle = paint.setup(ctx); ctx.fillRect(0, 2, 30, 12); ctx.strokeStyle = paint.ink; ctx.strokeRect(0.5, 2.5, 29, 11); }));
      }
      if (this.view === "order" && this.now.raw.dues.length) {
        signs.push(sign("due date", (ctx) => drawDue(ctx, paint, 12, 0, 16, { t0: 0, t1: 30, x: (t) => t })));
      }
      if (this.now.ghosts.length) {
        signs.push(sign("in the previous plan", (ctx) => { ctx.setLineDash([4, 3]); ctx.strokeStyle = paint.soft; ctx.lineWidth = 1.5; ctx.strokeRect(1, 1, 28, 14); }));
      }
    } else {
      signs.push(sign(this.view === "load" ? "capacity" : "limit", (ctx) => { ctx.setLineDash([6, 3]); ctx.strokeStyle = paint.bad; ctx.beginPath(); ctx.moveTo(0, 8); ctx.lineTo(30, 8); ctx.stroke(); }));
    }
    if (this.view !== "levels" && this.view !== "order" && this.view !== "action" && this.now.raw.closed.some((k) => this.payload.spans[k].length)) {
      signs.push(sign("closed", (ctx) => { ctx.fillStyle = paint.closed(ctx); ctx.fillRect(0, 0, 30, 16); }));
    }
    byId("legend").replaceChildren(...signs);
  }

  // --- print ------------------------------------------------------------------------------------

  beforePrint() {
    const { chart } = this;
    this.before = { t0: chart.t0, t1: chart.t1, theme: document.documentElement.dataset.theme };
    document.documentElement.dataset.theme = "light";
    chart.paint.read();
    this.legend(this.colours());
    // (Browsers draw canvases up to some size only; the tables have the rest.)
    chart.size(1040, Math.min(chart.total + AXIS + 4, 6000));
    chart.draw(true);
  }

  afterPrint() {
    const { chart, before } = this;
    if (before.theme) document.documentElement.dataset.theme = before.theme;
    else delete document.documentElement.dataset.theme;
    chart.paint.read();
    Object.assign(chart, { t0: before.t0, t1: before.t1 });
    this.legend(this.colours());
    chart.resize();
  }
}

/** Follows a running task: the server says that there is something new, and the page fetches it. */
function follow(page) {
  const said = element("span", { class: "board", role: "status", "data-state": "live" }, "live");
  document.querySelector(".headline").append(said);
  const say = (state, text) => { said.dataset.state = state; said.textContent = text; };
  const source = new EventSource(`events?since=${page.payload.board}`);
  source.addEventListener("open", () => say("live", "live"));
  source.addEventListener("error", () => say("lost", "connection lost, trying again"));
  source.addEventListener("end", () => { source.close(); say("ended", "the run has ended"); });
  source.addEventListener("change", async () => {
    const answer = await fetch("payload.json", { cache: "no-store" });
    if (answer.ok) page.load(await answer.json(), true);
  });
}

const page = new Page(JSON.parse(byId("payload").textContent));
if (page.payload.live) follow(page);
