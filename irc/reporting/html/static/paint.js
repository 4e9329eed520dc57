// Colours, patterns, and the drawing of rows.

// Okabe and Ito's colours, which people with any kind of colour vision tell apart; its vermilion is for
// what is critical. Beyond seven, patterns tell more apart.
const PALETTE = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#a89c00", "#7a7a7a"];
const GREY = PALETTE.length - 1;
/** The index of a grey that none of n things has. */
const greyBeyond = (n) => (n <= GREY ? GREY : GREY + PALETTE.length * Math.ceil(n / PALETTE.length));
const PATTERNS = ["plain", "stripes", "dots", "back stripes", "bars"];

class Paint {
  constructor() { this.patterns = new Map(); this.widths = new Map(); this.prefixes = new Map(); this.read(); }

  /** Reads the colours of the page, which depend on light and dark. */
  read() {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["back", "panel", "ink", "soft", "line", "accent", "critical", "bad", "good"]) {
      this[name] = style.getPropertyValue(`--${name}`).trim();
    }
    this.dark = style.colorScheme === "dark";
    this.patterns.clear();
  }

  colour(k) { return PALETTE[k % PALETTE.length]; }

  tint(k) { return mix(this.colour(k), this.back, this.dark ? 0.42 : 0.3); }

  /** The fill of the k-th order or resource: a tint with its pattern. */
  fill(ctx, k) {
    if (!this.patterns.has(k)) this.patterns.set(k, this.pattern(ctx, k));
    return this.patterns.get(k);
  }

  pattern(ctx, k) {
    const kind = PATTERNS[Math.floor(k / PALETTE.length) % PATTERNS.length];
    if (kind === "plain") return this.tint(k);
    return tile(ctx, 8, (to) => {
      to.fillStyle = this.tint(k);
      to.fillRect(0, 0, 8, 8);
      to.strokeStyle = to.fillStyle = this.colour(k);
      to.globalAlpha = 0.55;
      drawPattern(to, kind);
    });
  }

  /** The shading of closed times. */
  closed(ctx) {
    if (!this.patterns.has("closed")) {
      this.patterns.set("closed", tile(ctx, 8, (to) => {
        to.fillStyle = mix(this.soft, this.back, 0.14);
        to.fillRect(0, 0, 8, 8);
        to.strokeStyle = mix(this.soft, this.back, 0.34);
        drawPattern(to, "back stripes");
      }));
    }
    return this.patterns.get("closed");
  }

  /** The fill of set-ups. */
  setup(ctx) {
    if (!this.patterns.has("setup")) {
      this.patterns.set("setup", tile(ctx, 6, (to) => {
        to.fillStyle = mix(this.ink, this.back, 0.2);
        to.fillRect(0, 0, 6, 6);
        to.strokeStyle = mix(this.ink, this.back, 0.75);
        to.lineWidth = 1;
        to.beginPath();
        to.moveTo(0, 6); to.lineTo(6, 0); to.moveTo(0, 0); to.lineTo(6, 6);
        to.stroke();
      }));
    }
    return this.patterns.get("setup");
  }

  width(ctx, text) {
    let width = this.widths.get(text);
    if (width === undefined) {
      if (this.widths.size > 20000) this.widths.clear();
      this.widths.set(text, (width = ctx.measureText(text).width));
    }
    return width;
  }

  /** The text, cut with "…" to a width; empty where not even two signs fit. */
  fit(ctx, text, room) {
    if (this.width(ctx, text) <= room) return text;
    let found = this.prefixes.get(text);
    if (!found) {
      const signs = Array.from(text), starts = signs.map((_, k) => signs.slice(0, k + 1).join("") + "…");
      found = { starts, widths: starts.map((start) => ctx.measureText(start).width) };
      if (this.prefixes.size > 5000) this.prefixes.clear();
      this.prefixes.set(text, found);
    }
    const fitting = firstOf(found.widths, (width) => width > room);
    return fitting < 2 ? "" : found.starts[fitting - 1];
  }
}

function tile(ctx, size, draw) {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = size;
  draw(canvas.getContext("2d"));
  return ctx.createPattern(canvas, "repeat");
}

function drawPattern(to, kind) {
  to.lineWidth = 1.3;
  to.beginPath();
  if (kind === "stripes") for (const k of [-8, 0, 8]) { to.moveTo(k, 8); to.lineTo(k + 8, 0); }
  if (kind === "back stripes") for (const k of [-8, 0, 8]) { to.moveTo(k, 0); to.lineTo(k + 8, 8); }
  if (kind === "bars") { to.moveTo(4, 0); to.lineTo(4, 8); }
  to.stroke();
  if (kind === "dots") for (const [x, y] of [[2, 2], [6, 6]]) { to.beginPath(); to.arc(x, y, 1.2, 0, 7); to.fill(); }
}

/** A part of one colour in another, both "#rrggbb". */
function mix(a, b, part) {
  const read = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
  const [x, y] = [read(a), read(b)];
  return "#" + x.map((v, k) => Math.round(v * part + y[k] * (1 - part)).toString(16).padStart(2, "0")).join("");
}

/** Draws the bars, set-ups and closed times of a row; `v` is the visible part of the chart. */
function drawBars(ctx, paint, row, top, v) {
  const height = row.lanes.length * BAR + (row.height > BAR ? 2 * PAD : 0);
  drawClosed(ctx, paint, row, top, height, v);
  const first = top + (row.height > BAR ? PAD : 0);
  for (const setup of row.setups) drawSetup(ctx, paint, setup, first, v);
  if (v.changes) for (const ghost of row.ghosts) drawGhost(ctx, paint, row, ghost, first, v);
  row.lanes.forEach((lane, k) => drawLane(ctx, paint, lane, first + k * BAR, v));
  for (const due of row.dues) drawDue(ctx, paint, due, top, height, v);
}

function drawClosed(ctx, paint, row, top, height, v) {
  ctx.fillStyle = paint.closed(ctx);
  for (let k = firstOf(row.closed, ([, end]) => end > v.t0); k < row.closed.length && row.closed[k][0] < v.t1; k++) {
    const left = Math.max(v.left, v.x(row.closed[k][0])), right = Math.min(v.right, v.x(row.closed[k][1]));
    if (right - left >= 0.5) ctx.fillRect(left, top, right - left, height);
  }
}

function drawSetup(ctx, paint, setup, top, v) {
  if (setup.e < v.t0 || setup.s > v.t1) return;
  const x = v.x(setup.s), width = Math.max(2, v.x(setup.e) - x);
  ctx.fillStyle = paint.setup(ctx);
  ctx.fillRect(x, top + 7, width, BAR - 14);
  ctx.strokeStyle = paint.ink;
  ctx.lineWidth = 1;
  if (width > 4) ctx.strokeRect(x + 0.5, top + 7.5, width - 1, BAR - 15);
}

function drawLane(ctx, paint, lane, top, v) {
  let last = -Infinity;
  const from = firstOf(lane, (bar) => bar.e >= v.t0);
  for (let k = from; k < lane.length && lane[k].s <= v.t1; k++) {
    const bar = lane[k], x = v.x(bar.s), end = v.x(bar.e);
    if (end - x < 1.5 && x - last < 1 && !bar.critical) continue;
    last = Math.max(x, end);
    const next = k + 1 < lane.length ? v.x(lane[k + 1].s) : v.right;
    drawBar(ctx, paint, bar, x, end, next, top, v);
  }
}

function drawBar(ctx, paint, bar, x, end, next, top, v) {
  const y = top + 2, height = BAR - 4;
  const dim = v.matches && !v.matches.has(bar.key);
  ctx.globalAlpha = dim ? 0.18 : bar.cells[STATUS] ? 0.6 : 1;
  if (bar.e === bar.s) drawMilestone(ctx, paint, bar, x, y, height, v);
  else drawBody(ctx, paint, bar, x, end, y, height, v);
  if (bar === v.focus || bar.key === v.hover) {
    ctx.globalAlpha = 1;
    ctx.strokeStyle = bar === v.focus ? paint.accent : paint.ink;
    ctx.lineWidth = bar === v.focus ? 3 : 1.5;
    const [left, width] = bar.e === bar.s ? [x - 10, 20] : [x - 1.5, Math.max(4, end - x + 3)];
    ctx.strokeRect(left, y - 1, width, height + 2);
  }
  drawLabel(ctx, paint, bar, x, end, next, y + height / 2, v);
  ctx.globalAlpha = 1;
}

function drawBody(ctx, paint, bar, x, end, y, height, v) {
  const left = Math.max(x, v.left - 4), width = Math.max(1.5, Math.min(end, v.right + 4) - left);
  const k = v.colourOf(bar);
  ctx.fillStyle = width < 3 ? paint.colour(k) : paint.fill(ctx, k);
  ctx.fillRect(left, y, width, height);
  for (const [a, b] of bar.pauses) drawPause(ctx, paint, k, v.x(a), v.x(b), y, height);
  if (width >= 3) {
    ctx.fillStyle = paint.colour(k);
    if (x >= left) ctx.fillRect(left, y, Math.min(4, width / 2), height);
    ctx.strokeStyle = paint.colour(k);
    ctx.lineWidth = 1;
    ctx.strokeRect(left + 0.5, y + 0.5, width - 1, height - 1);
  }
  if (bar.cells[STATUS] && width > 6) {
    ctx.strokeStyle = paint.bad;
    ctx.lineWidth = 1.5;
    ctx.beginPath(); ctx.moveTo(left, y + height); ctx.lineTo(left + width, y); ctx.stroke();
  }
  if (bar.critical && v.critical) {
    ctx.fillStyle = paint.critical;
    ctx.fillRect(left, y, width, 2);
    ctx.fillRect(left, y + height - 4, width, 4);
  }
}

/** The pause of an action: its bar is hollow there. */
function drawPause(ctx, paint, k, a, b, y, height) {
  ctx.fillStyle = paint.back;
  ctx.fillRect(a, y, b - a, height);
  ctx.fillStyle = paint.closed(ctx);
  ctx.fillRect(a, y, b - a, height);
  ctx.strokeStyle = paint.colour(k);
  ctx.lineWidth = 1.5;
  ctx.setLineDash([3, 3]);
  ctx.strokeRect(a, y + 0.75, b - a, height - 1.5);
  ctx.setLineDash([]);
}

function drawMilestone(ctx, paint, bar, x, y, height, v) {
  const r = height / 2 - 2;
  ctx.fillStyle = bar.critical && v.critical ? paint.critical : paint.colour(v.colourOf(bar));
  ctx.beginPath();
  ctx.moveTo(x, y + 2); ctx.lineTo(x + r, y + height / 2); ctx.lineTo(x, y + height - 2); ctx.lineTo(x - r, y + height / 2);
  ctx.fill();
}

function drawLabel(ctx, paint, bar, x, end, next, middle, v) {
  const milestone = bar.e === bar.s;
  const left = Math.max(x, v.left) + 8, room = Math.min(end, v.right) - left - 5;
  ctx.fillStyle = paint.ink;
  if (!milestone && room > 16) {
    const text = paint.fit(ctx, bar.name, room);
    if (text) {
      if (bar.pauses.length) haloed(ctx, paint, text, left, middle); else ctx.fillText(text, left, middle);
      return;
    }
  }
  const beside = (milestone ? x + 12 : end + 4), free = Math.min(next, v.right) - beside - 6;
  if (end > v.left && free > 24) {
    const width = paint.width(ctx, bar.name);
    if (width <= free) { ctx.fillStyle = paint.soft; ctx.fillText(bar.name, beside, middle); }
  }
}

function drawGhost(ctx, paint, row, ghost, first, v) {
  if (ghost.e < v.t0 || ghost.s > v.t1) return;
  const y = first + (row.laneOf.get(ghost.key) || 0) * BAR + 4, x = v.x(ghost.s), width = Math.max(3, v.x(ghost.e) - x);
  ctx.setLineDash([4, 3]);
  ctx.strokeStyle = paint.soft;
  ctx.lineWidth = 1.5;
  ctx.strokeRect(x, y, width, BAR - 8);
  ctx.setLineDash([]);
  if (!ghost.bar && width > 8) {
    ctx.beginPath(); ctx.moveTo(x, y); ctx.lineTo(x + width, y + BAR - 8);
    ctx.moveTo(x, y + BAR - 8); ctx.lineTo(x + width, y); ctx.stroke();
  }
}

function drawDue(ctx, paint, due, top, height, v) {
  if (due < v.t0 || due > v.t1) return;
  const x = v.x(due);
  ctx.strokeStyle = ctx.fillStyle = paint.bad;
  ctx.lineWidth = 1.5;
  ctx.beginPath(); ctx.moveTo(x, top); ctx.lineTo(x, top + height); ctx.stroke();
  ctx.beginPath(); ctx.moveTo(x, top); ctx.lineTo(x + 8, top + 4); ctx.lineTo(x, top + 8); ctx.fill();
}

/** Draws an arrow from one place to another; `back`: straight to the left. */
function drawArrow(ctx, from, to, colour, dashed, back) {
  ctx.strokeStyle = ctx.fillStyle = colour;
  ctx.lineWidth = 1.5;
  if (dashed) ctx.setLineDash([3, 3]);
  const bend = Math.max(14, Math.min(60, Math.abs(to[0] - from[0]) / 2)), head = back ? 7 : -7;
  ctx.beginPath();
  ctx.moveTo(from[0], from[1]);
  if (from[1] === to[1]) ctx.lineTo(to[0], to[1]);
  else ctx.bezierCurveTo(from[0] + bend, from[1], to[0] - bend, to[1], to[0] - 1, to[1]);
  ctx.stroke();
  ctx.setLineDash([]);
  ctx.beginPath();
  ctx.moveTo(to[0], to[1]); ctx.lineTo(to[0] + head, to[1] - 3.5); ctx.lineTo(to[0] + head, to[1] + 3.5);
  ctx.fill();
}

/** Draws the load of a resource, or the level of a stock or a number, as steps. */
function drawProfile(ctx, paint, row, top, v) {
  drawClosed(ctx, paint, row, top, row.height, v);
  const inner = row.height - 14, span = row.most - row.least || 1;
  const y = (level) => top + 7 + inner - ((level - row.least) / span) * inner;
  const colour = row.kind === "load" ? PALETTE[0] : PALETTE[2];
  const path = stepsPath(row.points, y, v);
  if (path.length) {
    ctx.beginPath();
    ctx.moveTo(path[0][0], y(Math.max(0, row.least)));
    for (const [x, level] of path) ctx.lineTo(x, level);
    ctx.lineTo(path[path.length - 1][0], y(Math.max(0, row.least)));
    ctx.fillStyle = mix(colour, paint.back, paint.dark ? 0.42 : 0.3);
    ctx.fill();
    ctx.strokeStyle = colour;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    path.forEach(([x, level], k) => (k ? ctx.lineTo(x, level) : ctx.moveTo(x, level)));
    ctx.stroke();
  }
  ctx.setLineDash([6, 3]);
  ctx.strokeStyle = paint.bad;
  if (row.capacity.length) strokeSteps(ctx, stepsPath(row.capacity, y, v));
  for (const limit of [row.min, row.max]) {
    if (limit !== null && limit !== undefined) strokeSteps(ctx, [[v.left, y(limit)], [v.right, y(limit)]]);
  }
  ctx.setLineDash([]);
  ctx.textAlign = "right";
  for (const level of new Set([row.most, row.least])) {
    haloed(ctx, paint, String(level), v.right - 4, Math.min(top + row.height - 9, Math.max(top + 10, y(level))));
  }
  ctx.textAlign = "left";
}

/** A text that can be read on whatever is below it. */
function haloed(ctx, paint, text, x, y) {
  ctx.strokeStyle = paint.back;
  ctx.fillStyle = paint.ink;
  ctx.lineWidth = 4;
  ctx.lineJoin = "round";
  ctx.strokeText(text, x, y);
  ctx.fillText(text, x, y);
}

function strokeSteps(ctx, path) {
  ctx.beginPath();
  path.forEach(([x, y], k) => (k ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
  ctx.stroke();
}

/** The corners of the visible steps; steps within one pixel are drawn as their extent. */
function stepsPath(points, y, v) {
  const from = Math.max(0, firstOf(points, ([t]) => t > v.t0) - 1);
  const path = [];
  let level = from > 0 || (points.length && points[0][0] <= v.t0) ? points[from][1] : 0;
  if (points.length) path.push([v.left, y(points[0][0] <= v.t0 ? level : 0)]);
  let current = points.length && points[0][0] <= v.t0 ? level : 0;
  for (let k = from; k < points.length && points[k][0] <= v.t1; k++) {
    const x = Math.max(v.left, v.x(points[k][0]));
    path.push([x, y(current)], [x, y(points[k][1])]);
    current = points[k][1];
  }
  if (points.length) path.push([v.right, y(current)]);
  return path;
}

/** Draws the values of a state variable as boxes with the value in them. */
function drawState(ctx, paint, row, top, v) {
  const values = [...new Set(row.points.map(([, value]) => value))];
  row.points.forEach(([t, value], k) => {
    const until = k + 1 < row.points.length ? row.points[k + 1][0] : Infinity;
    if (until < v.t0 || t > v.t1) return;
    const x = Math.max(v.left, v.x(t)), end = Math.min(v.right, until === Infinity ? v.right : v.x(until));
    if (end <= x) return;
    const colour = values.indexOf(value);
    ctx.fillStyle = paint.fill(ctx, colour);
    ctx.fillRect(x, top + PAD, end - x, BAR);
    ctx.strokeStyle = paint.colour(colour);
    ctx.lineWidth = 1;
    ctx.strokeRect(x + 0.5, top + PAD + 0.5, end - x - 1, BAR - 1);
    ctx.fillStyle = paint.ink;
    const text = end - x > 16 ? paint.fit(ctx, value, end - x - 10) : "";
    if (text) ctx.fillText(text, x + 6, top + PAD + BAR / 2);
  });
}
