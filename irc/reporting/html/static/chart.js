// The chart: how it is filled, moved, zoomed and pointed at.

class Chart extends Drawing {
  constructor(onPoint, onChoose) {
    super();
    this.scroller = document.getElementById("scroller");
    this.canvas = document.getElementById("chart");
    this.ctx = this.canvas.getContext("2d");
    this.spacer = document.getElementById("height");
    this.overview = document.getElementById("overview");
    this.paint = new Paint();
    this.onPoint = onPoint;
    this.onChoose = onChoose;
    this.rows = [];
    this.matches = null;
    this.focus = null;
    this.hover = null;
    this.chosen = null;
    this.critical = this.changes = true;
    this.frames = 0;
    this.listen();
  }

  /** Shows the rows of a plan; the visible time stays if `keep`. */
  show(plan, axis, rows, colourOf, keep) {
    this.plan = plan;
    this.axis = axis;
    this.rows = rows;
    this.colourOf = colourOf;
    let y = 0;
    for (const row of rows) { row.y = y; y += row.height; }
    this.total = y;
    this.whole = Math.max(plan.latest, 1e-9);
    if (!keep || this.t1 === undefined) { this.t0 = 0; this.t1 = this.whole * 1.02; }
    const focused = this.focus && plan.byKey.get(this.focus.key);
    this.focus = focused || null;
    this.barIn = new Map();
    rows.forEach((row, k) => { if (row.laneOf) for (const [key, lane] of row.laneOf) if (!this.barIn.has(key)) this.barIn.set(key, [k, lane]); });
    this.resize();
  }

  resize() {
    const width = this.scroller.clientWidth;
    const most = Math.max(300, Math.min(900, Math.round(window.innerHeight * 0.68)));
    const height = Math.min(this.total + AXIS + 4, most);
    this.scroller.style.height = `${height + 2}px`;
    this.size(width, height);
    this.spacer.style.height = `${Math.max(0, this.total + AXIS - height)}px`;
    const ratio = window.devicePixelRatio || 1;
    this.overview.style.marginLeft = `${this.gutter}px`;
    this.overview.style.width = `calc(100% - ${this.gutter}px)`;
    this.overview.width = Math.round(this.overview.clientWidth * ratio);
    this.overview.height = Math.round(44 * ratio);
    this.area = null;
    this.request();
  }

  size(width, height) {
    const ratio = window.devicePixelRatio || 1;
    this.width = width;
    this.height = height;
    this.gutter = Math.round(Math.max(84, Math.min(230, width * 0.2)));
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${height}px`;
    this.ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  request() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.draw(); });
  }

  x(t) { return this.gutter + ((t - this.t0) / (this.t1 - this.t0)) * (this.width - this.gutter); }

  t(x) { return this.t0 + ((x - this.gutter) / (this.width - this.gutter)) * (this.t1 - this.t0); }

  // --- moving -----------------------------------------------------------------------------------

  /** Zooms by a factor around a time, which stays where it is. */
  zoom(factor, around) {
    const span = this.t1 - this.t0, centre = around === undefined ? (this.t0 + this.t1) / 2 : around;
    const wanted = Math.max(this.whole / 2e5, Math.min(this.whole * 1.02, span * factor));
    const part = (centre - this.t0) / span;
    this.move(centre - part * wanted, centre + (1 - part) * wanted);
  }

  /** Shows [t0, t1], moved into the plan. */
  move(t0, t1) {
    const span = t1 - t0, most = this.whole * 1.02;
    const first = Math.max(0, Math.min(t0, most - span));
    this.t0 = first;
    this.t1 = first + span;
    this.request();
  }

  fit() { this.move(0, this.whole * 1.02); }

  /** Brings a bar into view and gives it the focus of the chart. */
  reveal(bar, zoomed) {
    this.focus = bar;
    const span = this.t1 - this.t0;
    if (zoomed && bar.e > bar.s && (bar.e - bar.s) / span < 0.03) {
      const wide = Math.min(span, (bar.e - bar.s) * 12);
      this.move((bar.s + bar.e) / 2 - wide / 2, (bar.s + bar.e) / 2 + wide / 2);
    } else if (bar.s < this.t0 || bar.e > this.t1) {
      this.move((bar.s + bar.e) / 2 - span / 2, (bar.s + bar.e) / 2 + span / 2);
    }
    const place = this.placeOf(bar, this.scroller.scrollTop);
    if (place && (place[2] < AXIS + BAR || place[2] > this.height - BAR)) {
      this.scroller.scrollTop += place[2] - this.height / 2;
    }
    this.request();
  }

  // --- pointing ---------------------------------------------------------------------------------

  /** What is at a place: {row, bar, setup}. */
  at(x, y) {
    if (y < AXIS) return null;
    const inside = y - AXIS + this.scroller.scrollTop;
    const row = this.rows[firstOf(this.rows, (r) => r.y + r.height > inside)];
    if (!row || inside < row.y) return null;
    if (x < this.gutter || row.kind !== "bars") return { row };
    const t = this.t(x), near = (3 * (this.t1 - this.t0)) / (this.width - this.gutter);
    const lane = row.lanes[Math.floor((inside - row.y - (row.height > BAR ? PAD : 0)) / BAR)];
    if (lane) {
      const k = firstOf(lane, (bar) => bar.e + (bar.e === bar.s ? 3 : 1) * near >= t);
      const found = [lane[k], lane[k + 1]].filter((bar) => bar && bar.s - (bar.e === bar.s ? 3 : 1) * near <= t);
      if (found.length) return { row, bar: found.find((bar) => bar.s <= t && t <= bar.e) || found[0] };
    }
    const setup = row.setups.find((s) => s.s - near <= t && t <= s.e + near);
    if (setup) return { row, setup };
    const ghost = this.changes && row.ghosts.find((g) => g.s - near <= t && t <= g.e + near);
    return ghost ? { row, ghost } : { row };
  }

  listen() {
    const { scroller } = this;
    scroller.addEventListener("scroll", () => this.request(), { passive: true });
    scroller.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    scroller.addEventListener("keydown", (event) => this.key(event));
    this.pointers = new Map();
    scroller.addEventListener("pointerdown", (event) => this.down(event));
    scroller.addEventListener("pointermove", (event) => this.pointed(event));
    for (const name of ["pointerup", "pointercancel"]) scroller.addEventListener(name, (event) => this.up(event));
    scroller.addEventListener("pointerleave", () => { this.hover = null; this.onPoint(null); this.request(); });
    const jump = (event) => {
      const box = this.overview.getBoundingClientRect(), span = this.t1 - this.t0;
      const t = ((event.clientX - box.left) / box.width) * this.whole * 1.02;
      this.move(t - span / 2, t + span / 2);
    };
    this.overview.addEventListener("pointerdown", (event) => { this.overview.setPointerCapture(event.pointerId); jump(event); });
    this.overview.addEventListener("pointermove", (event) => { if (event.buttons) jump(event); });
    new ResizeObserver(() => { if (this.plan && scroller.clientWidth !== this.width) this.resize(); }).observe(scroller);
  }

  place(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  wheel(event) {
    const [x, y] = this.place(event);
    const step = event.deltaMode === 1 ? 16 : 1;
    if (event.ctrlKey || event.metaKey || y < AXIS) {
      event.preventDefault();
      this.zoom(Math.exp(Math.max(-120, Math.min(120, event.deltaY * step)) * 0.004), this.t(Math.max(x, this.gutter)));
    } else if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
      event.preventDefault();
      const moved = ((event.deltaX || event.deltaY) * step * (this.t1 - this.t0)) / (this.width - this.gutter);
      this.move(this.t0 + moved, this.t1 + moved);
    }
  }

  down(event) {
    if (event.button > 0) return;
    this.pointers.set(event.pointerId, this.place(event));
    this.begun = { at: this.place(event), t0: this.t0, t1: this.t1, scroll: this.scroller.scrollTop, moved: false };
    this.pinch = this.pointers.size === 2 ? { apart: this.apart(), t0: this.t0, t1: this.t1 } : null;
  }

  apart() {
    const [a, b] = [...this.pointers.values()];
    return Math.max(20, Math.abs(a[0] - b[0]));
  }

  pointed(event) {
    const at = this.place(event);
    if (!this.pointers.has(event.pointerId)) { this.point(at, event); return; }
    this.pointers.set(event.pointerId, at);
    if (this.pinch) {
      const [a, b] = [...this.pointers.values()], around = this.t((a[0] + b[0]) / 2);
      this.zoom(((this.pinch.t1 - this.pinch.t0) * this.pinch.apart) / this.apart() / (this.t1 - this.t0), around);
      return;
    }
    const dx = at[0] - this.begun.at[0], dy = at[1] - this.begun.at[1];
    if (!this.begun.moved && Math.hypot(dx, dy) < 5) return;
    if (!this.begun.moved) { this.begun.moved = true; this.scroller.setPointerCapture(event.pointerId); this.scroller.classList.add("grabbing"); this.onPoint(null); }
    const moved = (-dx * (this.begun.t1 - this.begun.t0)) / (this.width - this.gutter);
    this.move(this.begun.t0 + moved, this.begun.t1 + moved);
    if (event.pointerType === "mouse") this.scroller.scrollTop = this.begun.scroll - dy;
  }

  up(event) {
    const was = this.pointers.delete(event.pointerId);
    this.scroller.classList.remove("grabbing");
    if (event.type === "pointerup" && was && !this.pinch && !this.begun.moved) {
      const found = this.at(...this.place(event));
      this.choose(found && found.bar ? found.bar : null);
    }
    if (!this.pointers.size) this.pinch = null;
  }

  point(at, event) {
    const found = this.at(...at), key = found && found.bar ? found.bar.key : null;
    this.scroller.classList.toggle("pointing", key !== null);
    this.onPoint(found, event.clientX, event.clientY);
    if (key !== this.hover) { this.hover = key; this.request(); }
  }

  choose(bar) {
    this.chosen = bar;
    if (bar) this.focus = bar;
    this.onChoose(bar);
    this.request();
  }

  // --- keys -------------------------------------------------------------------------------------

  key(event) {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const span = this.t1 - this.t0, { key } = event;
    const pan = { ArrowLeft: -0.2, ArrowRight: 0.2 }[key];
    if (key === "+" || key === "=") this.zoom(0.7, this.focus ? (this.focus.s + this.focus.e) / 2 : undefined);
    else if (key === "-" || key === "_") this.zoom(1 / 0.7, this.focus ? (this.focus.s + this.focus.e) / 2 : undefined);
    else if (key === "0") this.fit();
    else if (event.shiftKey && pan) this.move(this.t0 + pan * span, this.t1 + pan * span);
    else if (key === "ArrowLeft" || key === "ArrowRight") this.step(key === "ArrowRight" ? 1 : -1);
    else if (key === "ArrowUp" || key === "ArrowDown") this.jump(key === "ArrowDown" ? 1 : -1);
    else if (key === "Home" || key === "End") this.edge(key === "End");
    else if (key === "Enter" || key === " ") this.choose(this.focus);
    else if (key === "Escape") this.choose(null);
    else return;
    event.preventDefault();
  }

  /** The bars of the row in which the focus is, in order of time; with its index and the focus'. */
  focusedRow() {
    const place = this.focus && this.barIn.get(this.focus.key);
    const k = place ? place[0] : this.rows.findIndex((row) => row.lanes && row.lanes[0].length);
    if (k < 0) return null;
    const bars = this.rows[k].lanes.flat().sort((a, b) => a.s - b.s || a.e - b.e);
    return { k, bars, index: place ? bars.indexOf(this.focus) : -1 };
  }

  step(by) {
    const row = this.focusedRow();
    if (!row || !row.bars.length) return;
    const next = row.bars[Math.max(0, Math.min(row.bars.length - 1, row.index + by))];
    this.focused(row.index < 0 ? row.bars[0] : next);
  }

  jump(by) {
    const row = this.focusedRow();
    if (!row) { this.scroller.scrollTop += by * 60; return; }
    let k = row.k + by;
    while (k >= 0 && k < this.rows.length && !(this.rows[k].lanes && this.rows[k].lanes[0].length)) k += by;
    if (k < 0 || k >= this.rows.length) return;
    const at = this.focus ? this.focus.s : this.t0;
    const bars = this.rows[k].lanes.flat();
    this.focused(bars.reduce((best, bar) => (Math.abs(bar.s - at) < Math.abs(best.s - at) ? bar : best)));
  }

  edge(last) {
    const row = this.focusedRow();
    if (row && row.bars.length) this.focused(row.bars[last ? row.bars.length - 1 : 0]);
  }

  focused(bar) {
    this.reveal(bar, false);
    this.onPoint({ bar, spoken: true });
  }
}
