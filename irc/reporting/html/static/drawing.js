// The drawing of the chart: its visible rows, the names beside them, the axis, arrows, the overview.

const AXIS = 40, LEAST_APART = 84;

/** What a chart draws; the chart itself says which rows and which times. */
class Drawing {
  draw(all) {
    const { ctx, paint } = this, top = all ? 0 : this.scroller.scrollTop;
    const v = {
      t0: this.t0, t1: this.t1, left: this.gutter, right: this.width, x: (t) => this.x(t), matches: this.matches,
      focus: this.focus, hover: this.hover, critical: this.critical, changes: this.changes, colourOf: this.colourOf,
    };
    ctx.font = '13px system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "DejaVu Sans", sans-serif';
    ctx.textBaseline = "middle";
    ctx.fillStyle = paint.back;
    ctx.fillRect(0, 0, this.width, this.height);
    const ticks = this.axis.ticks(this.t0, this.t1, this.width - this.gutter, LEAST_APART);
    const first = firstOf(this.rows, (row) => row.y + row.height > top);
    this.clip(this.gutter, AXIS, () => {
      this.drawGrid(ticks);
      for (let k = first; k < this.rows.length && this.rows[k].y < top + this.height; k++) {
        this.drawRow(this.rows[k], AXIS + this.rows[k].y - top, v);
      }
      this.drawArrows(top, v);
      this.drawNow();
    });
    this.clip(0, AXIS, () => this.drawNames(first, top));
    this.drawAxis(ticks);
    this.drawOverview();
    this.frames += 1;
  }

  clip(x, y, draw) {
    const { ctx } = this;
    ctx.save();
    ctx.beginPath();
    ctx.rect(x, y, this.width - x, this.height - y);
    ctx.clip();
    draw();
    ctx.restore();
  }

  drawGrid(ticks) {
    const { ctx, paint } = this;
    ctx.strokeStyle = mix(paint.line, paint.back, 0.75);
    ctx.lineWidth = 1;
    ctx.beginPath();
    for (const { t } of ticks) {
      const x = Math.round(this.x(t)) + 0.5;
      ctx.moveTo(x, AXIS);
      ctx.lineTo(x, this.height);
    }
    ctx.stroke();
  }

  drawRow(row, y, v) {
    const { ctx, paint } = this;
    if (row.kind === "bars") drawBars(ctx, paint, row, y, v);
    else if (row.kind === "state") drawState(ctx, paint, row, y, v);
    else drawProfile(ctx, paint, row, y, v);
    ctx.strokeStyle = paint.line;
    ctx.lineWidth = 1;
    ctx.beginPath();
    ctx.moveTo(0, Math.round(y + row.height) - 0.5);
    ctx.lineTo(this.width, Math.round(y + row.height) - 0.5);
    ctx.stroke();
  }

  drawNames(first, top) {
    const { ctx, paint } = this;
    ctx.fillStyle = paint.back;
    ctx.fillRect(0, AXIS, this.gutter, this.height);
    for (let k = first; k < this.rows.length && this.rows[k].y < top + this.height; k++) {
      const row = this.rows[k], y = AXIS + row.y - top;
      const middle = row.kind === "bars" && row.lanes.length > 1 ? y + PAD + BAR / 2 : y + row.height / 2;
      const subWidth = row.sub ? paint.width(ctx, row.sub) + 8 : 0;
      ctx.fillStyle = row.soft ? paint.soft : paint.ink;
      const under = row.sub && row.kind !== "bars" && row.height >= PROFILE;
      ctx.fillText(paint.fit(ctx, row.title, this.gutter - 14 - (under ? 0 : subWidth)), 8, under ? middle - 9 : middle);
      if (row.sub) {
        ctx.fillStyle = paint.soft;
        if (under) ctx.fillText(row.sub, 8, middle + 9);
        else ctx.fillText(row.sub, this.gutter - subWidth, middle);
      }
      ctx.strokeStyle = paint.line;
      ctx.beginPath();
      ctx.moveTo(0, Math.round(y + row.height) - 0.5);
      ctx.lineTo(this.gutter, Math.round(y + row.height) - 0.5);
      ctx.stroke();
    }
    ctx.strokeStyle = paint.line;
    ctx.beginPath();
    ctx.moveTo(this.gutter - 0.5, AXIS);
    ctx.lineTo(this.gutter - 0.5, this.height);
    ctx.stroke();
  }

  drawAxis(ticks) {
    const { ctx, paint } = this, width = this.width - this.gutter;
    ctx.fillStyle = paint.panel;
    ctx.fillRect(0, 0, this.width, AXIS);
    ctx.strokeStyle = paint.line;
    ctx.beginPath(); ctx.moveTo(0, AXIS - 0.5); ctx.lineTo(this.width, AXIS - 0.5); ctx.stroke();
    ctx.fillStyle = paint.soft;
    if (!this.axis.origin) ctx.fillText(this.axis.unit, 8, AXIS / 2);
    ctx.save();
    ctx.beginPath(); ctx.rect(this.gutter, 0, width, AXIS); ctx.clip();
    const above = ticks.filter((tick) => tick.above), context = this.axis.context(this.t0, this.t1, width, LEAST_APART);
    const low = this.axis.origin ? 28 : AXIS / 2;
    for (const { t, text } of ticks) {
      const x = this.x(t);
      if (x + 4 + paint.width(ctx, text) <= this.width) ctx.fillText(text, x + 4, low);
      ctx.beginPath(); ctx.moveTo(Math.round(x) + 0.5, AXIS - 8); ctx.lineTo(Math.round(x) + 0.5, AXIS); ctx.stroke();
    }
    ctx.fillStyle = paint.ink;
    let reached = this.gutter + 4;
    const firstAbove = above.length ? this.x(above[0].t) : Infinity;
    if (context && firstAbove > reached + paint.width(ctx, context) + 8) {
      ctx.fillText(context, reached, 11);
      reached += paint.width(ctx, context) + 10;
    }
    for (const tick of above) {
      const x = Math.max(this.gutter, this.x(tick.t)) + 4;
      if (x >= reached && x + paint.width(ctx, tick.above) <= this.width) { ctx.fillText(tick.above, x, 11); reached = x + paint.width(ctx, tick.above) + 10; }
    }
    ctx.restore();
  }

  /** The place of a bar in the chart: [left, right, middle]; null where it has no row. */
  placeOf(bar, top) {
    const place = this.barIn.get(bar.key);
    if (!place) return null;
    const row = this.rows[place[0]];
    const y = AXIS + row.y - top + (row.height > BAR ? PAD : 0) + place[1] * BAR + BAR / 2;
    return [this.x(bar.s), this.x(bar.e), y];
  }

  drawArrows(top, v) {
    const { ctx, paint } = this;
    if (this.critical) {
      for (let k = 1; k < this.plan.chain.length; k++) this.arrow(this.plan.chain[k - 1], this.plan.chain[k], top, paint.critical);
    }
    const about = this.chosen || this.focus;
    if (about) {
      for (const [, key] of about.why) {
        const before = key && this.plan.byKey.get(key);
        if (before) this.arrow(before, about, top, paint.accent);
      }
    }
    if (!this.changes) return;
    const seen = this.plan.ghosts.filter((ghost) => ghost.bar && ghost.s <= v.t1 && ghost.e >= v.t0);
    for (const ghost of seen.length > 60 ? seen.filter((g) => g.bar === about || g.key === this.hover) : seen) {
      const place = this.placeOf(ghost.bar, top);
      if (!place || place[2] < AXIS - BAR || place[2] > this.height + BAR) continue;
      const from = this.x(ghost.s), row = this.rows.find((r) => r.ghosts && r.ghosts.includes(ghost));
      const y = row ? AXIS + row.y - top + (row.height > BAR ? PAD : 0) + (row.laneOf.get(ghost.key) || 0) * BAR + BAR / 2 : place[2];
      const same = Math.abs(y - place[2]) < 4, low = same ? BAR / 2 - 1 : 0;
      if (!same || Math.abs(from - place[0]) > 6) {
        drawArrow(ctx, [from, y + low], [place[0], place[2] + low], paint.soft, !same, place[0] < from && same);
      }
    }
  }

  arrow(before, after, top, colour) {
    const a = this.placeOf(before, top), b = this.placeOf(after, top);
    if (!a || !b || (a[2] < 0 && b[2] < 0) || (a[2] > this.height && b[2] > this.height)) return;
    if (Math.max(a[1], b[0]) < this.gutter || Math.min(a[1], b[0]) > this.width) return;
    if (a[2] === b[2] && Math.abs(b[0] - a[1]) < 8) return;
    drawArrow(this.ctx, [a[1], a[2]], [b[0], b[2]], colour, false);
  }

  drawNow() {
    const { ctx, paint } = this, { now } = this.plan;
    if (now === null || now < this.t0 || now > this.t1) return;
    const x = Math.round(this.x(now));
    ctx.strokeStyle = ctx.fillStyle = paint.accent;
    ctx.lineWidth = 2;
    ctx.beginPath(); ctx.moveTo(x, AXIS); ctx.lineTo(x, this.height); ctx.stroke();
    const width = paint.width(ctx, "now") + 10;
    ctx.fillRect(x, AXIS, width, 18);
    ctx.fillStyle = paint.back;
    ctx.fillText("now", x + 5, AXIS + 9);
  }

  drawOverview() {
    const to = this.overview.getContext("2d"), ratio = window.devicePixelRatio || 1, { paint } = this;
    const width = this.overview.width, height = this.overview.height;
    if (!this.area) {
      this.area = document.createElement("canvas");
      this.area.width = width;
      this.area.height = height;
      if (width) this.drawArea(this.area.getContext("2d"), width, height);
    }
    to.clearRect(0, 0, width, height);
    if (!width) return;
    to.drawImage(this.area, 0, 0);
    const all = this.whole * 1.02, x = (t) => (t / all) * width;
    const left = Math.max(0, x(this.t0)), right = Math.min(width, x(this.t1));
    to.fillStyle = mix(paint.ink, paint.back, 0.5);
    to.globalAlpha = 0.25;
    to.fillRect(0, 0, left, height);
    to.fillRect(right, 0, width - right, height);
    to.globalAlpha = 1;
    to.strokeStyle = paint.accent;
    to.lineWidth = 2 * ratio;
    to.strokeRect(left + ratio, ratio, Math.max(4, right - left - 2 * ratio), height - 2 * ratio);
  }

  /** The number of actions that run, over the whole time. */
  drawArea(to, width, height) {
    const { paint } = this, all = this.whole * 1.02, counts = new Float64Array(width + 1);
    for (const bar of this.plan.bars) {
      counts[Math.max(0, Math.min(width, Math.floor((bar.s / all) * width)))] += 1;
      counts[Math.max(0, Math.min(width, Math.floor((bar.e / all) * width)))] -= 1;
    }
    let level = 0, most = 1;
    const levels = counts.map((change) => { level += change; most = Math.max(most, level); return level; });
    to.fillStyle = mix(PALETTE[0], paint.back, 0.55);
    levels.forEach((n, x) => to.fillRect(x, height - (n / most) * (height - 6), 1, (n / most) * (height - 6)));
  }
}
