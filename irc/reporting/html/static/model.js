// The payload as plans, and a plan as rows of bars.

const BAR = 26, PAD = 4, PROFILE = 58;

/** The columns of an action's cells that the chart reads. */
const NAME = 0, OCCURRENCE = 1, FROM = 2, TO = 3, START = 4, END = 5, MODE = 7, RESOURCES = 8, ORDER = 9, DUE = 10;
const SLACK = 12, STATUS = 13;

class Plan {
  constructor(payload, k) {
    const plan = payload.plans[k];
    this.raw = plan;
    this.payload = payload;
    this.bars = plan.rows.map((r) => barOf(payload, payload.rows[r]));
    this.byKey = new Map(this.bars.map((bar) => [bar.key, bar]));
    this.bars.sort((a, b) => a.s - b.s || a.e - b.e);
    this.end = Math.max(0, ...chunkMax(this.bars, (bar) => bar.e));
    const before = k ? payload.plans[k - 1].rows : payload.previous;
    this.ghosts = before ? ghostsOf(before.map((r) => barOf(payload, payload.rows[r])), this.byKey) : [];
    this.ghostOf = new Map(this.ghosts.map((ghost) => [ghost.key, ghost]));
    this.now = plan.at === null ? null : number(plan.at);
    this.chain = plan.chain.map((key) => this.byKey.get(key)).filter(Boolean);
    const last = [this.end, ...chunkMax(this.ghosts, (bar) => bar.e), this.now ?? 0];
    this.latest = Math.max(...last);
  }
}

/** The greatest value of a list as a list of at most one element (lists can be long). */
function chunkMax(list, of) {
  let most = -Infinity;
  for (const item of list) most = Math.max(most, of(item));
  return list.length ? [most] : [];
}

function barOf(payload, row) {
  const cells = row.c;
  const occurrence = cells[OCCURRENCE];
  const name = row.n || cells[NAME];
  return {
    row, cells, name: occurrence === "" ? name : `${name} (${occurrence})`,
    key: keyOf(cells), s: number(cells[START]), e: number(cells[END]),
    uses: row.u, order: row.o, critical: row.k === 1,
    pauses: (row.p || []).map(([a, b]) => [number(a), number(b)]), why: row.w || [],
  };
}

const keyOf = (cells) => `${cells[NAME]}\u0000${cells[OCCURRENCE]}`;

/** The bars of the previous plan that moved, or that are gone. */
function ghostsOf(before, now) {
  const ghosts = [];
  for (const old of before) {
    const bar = now.get(old.key);
    const same = bar && bar.cells[START] === old.cells[START] && bar.cells[MODE] === old.cells[MODE] &&
      JSON.stringify(bar.uses) === JSON.stringify(old.uses);
    if (!same) ghosts.push({ ...old, ghost: true, bar: bar || null });
  }
  return ghosts;
}

/** Bars in lanes in which none overlaps another. */
function lanesOf(bars) {
  const lanes = [], ends = [];
  for (const bar of bars) {
    let k = ends.findIndex((end) => end <= bar.s);
    if (k < 0) { k = lanes.length; lanes.push([]); ends.push(0); }
    lanes[k].push(bar);
    ends[k] = Math.max(bar.e, bar.s);
  }
  return lanes.length ? lanes : [[]];
}

function barRow(title, bars, extra) {
  const lanes = lanesOf(bars);
  const row = { kind: "bars", title, lanes, setups: [], closed: [], ghosts: [], dues: [], height: lanes.length * BAR + 2 * PAD, ...extra };
  row.laneOf = new Map();
  lanes.forEach((lane, k) => lane.forEach((bar) => row.laneOf.set(bar.key, k)));
  return row;
}

/** The closed times, or the capacity over time, of a resource in a plan. */
const spansOf = (plan, what, r) => spans(plan.payload.spans[plan.raw[what][r]]);

const spans = (pairs) => (pairs || []).map(([a, b]) => [number(a), number(b)]);

const VIEWS = {
  resource: {
    title: "Resources",
    offered: (payload) => payload.resources.some((resource) => !resource.stock),
    rows(plan) {
      const of = plan.payload.resources.map(() => []);
      const without = [];
      for (const bar of plan.bars) {
        if (!bar.uses.length) without.push(bar);
        for (const [r] of bar.uses) of[r].push(bar);
      }
      const rows = [];
      plan.payload.resources.forEach((resource, r) => {
        if (resource.stock) return;
        const setups = plan.raw.setups.filter((setup) => setup[0] === r)
          .map(([, s, e, from, to]) => ({ s: number(s), e: number(e), from, to, st: s, et: e }));
        rows.push(barRow(resource.name, of[r], {
          resource: r, sub: resource.capacity > 1 ? `×${resource.capacity}` : "",
          closed: spansOf(plan, "closed", r), setups,
        }));
      });
      if (without.length) rows.push(barRow("no resource", without, { soft: true }));
      placeGhosts(plan, rows, (ghost, row) => row.resource === undefined ? !ghost.uses.length && row.soft
        : ghost.uses.some(([r]) => r === row.resource));
      return rows;
    },
  },
  order: {
    title: "Orders",
    offered: (payload) => payload.orders.length > 0,
    rows(plan) {
      const of = plan.payload.orders.map(() => []), without = [];
      for (const bar of plan.bars) (bar.order < 0 ? without : of[bar.order]).push(bar);
      const rows = plan.payload.orders.map((name, k) => barRow(name, of[k], {
        order: k, dues: plan.raw.dues.filter((due) => due[0] === k).map(([, t]) => number(t)),
      })).filter((row) => row.lanes[0].length);
      if (without.length) rows.push(barRow("no order", without, { soft: true }));
      placeGhosts(plan, rows, (ghost, row) => (row.order === undefined ? -1 : row.order) === ghost.order);
      return rows;
    },
  },
  action: {
    title: "Actions",
    offered: () => true,
    rows(plan) {
      const rows = plan.bars.map((bar) => barRow(bar.name, [bar], {
        key: bar.key, height: BAR, dues: bar.cells[DUE] === "" ? [] : [number(bar.cells[DUE])],
      }));
      const gone = plan.ghosts.filter((ghost) => !ghost.bar);
      for (const ghost of gone) rows.push(barRow(ghost.name, [], { key: ghost.key, height: BAR, soft: true }));
      const byKey = new Map(rows.map((row) => [row.key, row]));
      for (const ghost of plan.ghosts) byKey.get(ghost.key).ghosts.push(ghost);
      return rows;
    },
  },
  load: {
    title: "Load",
    offered: (payload) => payload.resources.some((resource) => !resource.stock),
    rows(plan) {
      const rows = [];
      plan.payload.resources.forEach((resource, r) => {
        if (!resource.stock) rows.push(profileRow(resource.name, "load", loadOf(plan, r), {
          capacity: spansOf(plan, "capacity", r), closed: spansOf(plan, "closed", r), sub: `of ${resource.capacity}`,
        }));
      });
      return rows;
    },
  },
  levels: {
    title: "Stock and state",
    offered: (payload) => payload.plans.some((plan) => plan.stock.length || plan.state.length),
    rows(plan) {
      const stock = plan.raw.stock.map((level) => profileRow(level.name, "stock", spans(level.points), {
        min: level.min === null ? null : number(level.min), max: level.max === null ? null : number(level.max), sub: "stock",
      }));
      const state = plan.raw.state.map((variable) => (variable.numeric
        ? profileRow(variable.name, "stock", spans(variable.points), { min: null, max: null, sub: "number" })
        : { kind: "state", title: variable.name, sub: "state", height: BAR + 2 * PAD, closed: [],
            points: variable.points.map(([t, value]) => [number(t), value]) }));
      return [...stock, ...state];
    },
  },
};

/** Gives each row the bars of the previous plan that were in it. */
function placeGhosts(plan, rows, isIn) {
  if (plan.ghosts.length * rows.length > 4e6) return;
  for (const row of rows) row.ghosts = plan.ghosts.filter((ghost) => isIn(ghost, row));
}

function profileRow(title, kind, points, extra) {
  let most = 1, least = 0;
  for (const [, level] of points) { most = Math.max(most, level); least = Math.min(least, level); }
  for (const [, level] of extra.capacity || []) most = Math.max(most, level);
  if (extra.max !== null && extra.max !== undefined) most = Math.max(most, extra.max);
  return { kind, title, points, most, least, height: PROFILE, closed: [], capacity: [], ...extra };
}

/** The amounts in use of a resource over time, [[t, amount]]. */
function loadOf(plan, r) {
  const changes = new Map();
  for (const bar of plan.bars) {
    for (const [of, amount] of bar.uses) {
      if (of !== r) continue;
      changes.set(bar.s, (changes.get(bar.s) || 0) + amount);
      changes.set(bar.e, (changes.get(bar.e) || 0) - amount);
    }
  }
  let level = 0;
  return [...changes.keys()].sort((a, b) => a - b).map((t) => [t, (level += changes.get(t))]);
}

/** The first index from which all items of a sorted list fulfil a condition. */
function firstOf(list, holds) {
  let low = 0, high = list.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (holds(list[middle])) high = middle; else low = middle + 1;
  }
  return low;
}
