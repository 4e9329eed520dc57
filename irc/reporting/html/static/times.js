// Times: exact texts as numbers to draw with, and the labels of the time axis.

/** The number to draw with of an exact one: 12, "0.5", "1/3". */
function number(exact) {
  if (typeof exact === "number") return exact;
  const [above, below] = String(exact).split("/");
  return below === undefined ? Number(above) : Number(above) / Number(below);
}

const DAYS = ["Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"];
const MONTHS = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];
const SECOND = 1000, MINUTE = 60 * SECOND, HOUR = 60 * MINUTE, DAY = 24 * HOUR;
const CLOCK_STEPS = [
  SECOND, 2 * SECOND, 5 * SECOND, 10 * SECOND, 15 * SECOND, 30 * SECOND,
  MINUTE, 2 * MINUTE, 5 * MINUTE, 10 * MINUTE, 15 * MINUTE, 30 * MINUTE,
  HOUR, 2 * HOUR, 3 * HOUR, 6 * HOUR, 12 * HOUR, DAY, 2 * DAY, 7 * DAY, 14 * DAY, 28 * DAY, 91 * DAY, 364 * DAY,
];

const two = (n) => String(n).padStart(2, "0");

/** The time axis of a task: clock times where it has an origin, otherwise numbers of its unit. */
class Axis {
  constructor(payload) {
    this.unit = payload.unit;
    this.origin = payload.origin;
    this.unitMs = payload.unit_seconds === null ? null : number(payload.unit_seconds) * 1000;
    if (this.origin) {
      this.zero = Date.parse(this.origin.local + "Z");
      this.offsets = this.origin.offsets.map(([at, seconds]) => [number(at), seconds * 1000]);
    }
  }

  /** How far clocks are ahead of those at t = 0, in milliseconds: 0 until clocks change. */
  shift(t) {
    let shift = 0;
    for (const [at, ahead] of this.offsets) if (at <= t) shift = ahead;
    return shift;
  }

  /** The local time at t, in milliseconds as if it were UTC. */
  wall(t) { return this.zero + t * this.unitMs + this.shift(t); }

  /** The t at which clocks show a local time. */
  at(wall) {
    const guess = (wall - this.zero) / this.unitMs;
    return (wall - this.zero - this.shift(guess)) / this.unitMs;
  }

  /** The labels of an axis from t0 to t1: [{t, text, above}], `above` where a longer unit begins. */
  ticks(t0, t1, width, least) {
    return this.origin ? this.clockTicks(t0, t1, width, least) : this.unitTicks(t0, t1, width, least);
  }

  unitTicks(t0, t1, width, least) {
    const rough = ((t1 - t0) * least) / width;
    let step = 10 ** Math.floor(Math.log10(rough));
    for (const k of [1, 2, 5, 10]) if (step * k >= rough) { step *= k; break; }
    if (this.unit === "min" || this.unit === "s") {
      const round = [15, 30, 60, 120, 240, 480, 720, 1440].find((s) => s >= rough);
      if (round !== undefined && rough > 10) step = round;
    }
    const places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const ticks = [];
    for (let k = Math.ceil(t0 / step - 1e-9); k * step <= t1 && ticks.length < 400; k++) {
      ticks.push({ t: k * step, text: (k * step + 0).toLocaleString("en", { maximumFractionDigits: places }) });
    }
    return ticks;
  }

  clockTicks(t0, t1, width, least) {
    const rough = ((t1 - t0) * this.unitMs * least) / width;
    const step = CLOCK_STEPS.find((s) => s >= rough) || Math.ceil(rough / (364 * DAY)) * 364 * DAY;
    // (Weeks begin on a Monday: 5 January 1970.)
    const base = step > DAY ? 4 * DAY : 0;
    const first = Math.ceil((this.wall(t0) - base) / step) * step + base;
    const ticks = [];
    let before = this.longer(new Date(this.wall(t0)), step);
    for (let wall = first; ticks.length < 400; wall += step) {
      const t = this.at(wall);
      if (t > t1) break;
      const date = new Date(wall);
      const long = this.longer(date, step);
      const text = step >= DAY ? `${DAYS[date.getUTCDay()]} ${date.getUTCDate()}` : this.hour(date, step);
      ticks.push({ t, text, above: long === before ? null : step >= DAY ? long : long.slice(0, -5) });
      before = long;
    }
    return ticks;
  }

  /** The label of the longer unit that holds t: what stands at the left end of the axis. */
  context(t0, t1, width, least) {
    if (!this.origin) return "";
    const rough = ((t1 - t0) * this.unitMs * least) / width;
    return this.longer(new Date(this.wall(t0)), CLOCK_STEPS.find((s) => s >= rough) || DAY);
  }

  longer(date, step) { return step >= DAY ? this.month(date) : this.day(date); }

  hour(date, step) {
    const text = `${two(date.getUTCHours())}:${two(date.getUTCMinutes())}`;
    return step < MINUTE ? `${text}:${two(date.getUTCSeconds())}` : text;
  }

  day(date) {
    return `${DAYS[date.getUTCDay()]} ${date.getUTCDate()} ${MONTHS[date.getUTCMonth()]} ${date.getUTCFullYear()}`;
  }

  month(date) { return `${MONTHS[date.getUTCMonth()]} ${date.getUTCFullYear()}`; }
}
