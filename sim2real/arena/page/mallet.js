// A person's own mallet, moved here by the law of the server's gantry, so that it is seen where it is pointed at once.
//
// An axis is the sum of three modes, [rest, slow, fast], as in puckpilot_env/physics/gantry/mallet.py. Its plan is +volts
// until t1, -volts until t2, then none (plan.py there). A plan that is made anew on its way to the same place is the same
// one: it is made here where the aim changes. What the server's states say of the mallet is brought forward by the aims
// on which it had not acted, and the own one is drawn there by a little in each picture; the law does the rest.
const TICKS = 120; // of the server, a second
const KEPT = 2; // s of aims; a state that acted on none of these says nothing of now
const BLEND = 0.15, MOST = 0.001; // s in which a difference fades, and m of it in a picture at most

// An axis after `seconds` towards `target` [m].
function moved(law, modes, target, volts, seconds) {
  const [rest, slow] = modes, steady = law.slow_gain * volts;
  const heading = slow < 0 || (slow === 0 && target >= rest) ? 1 : -1;
  const ahead = (heading * (target - rest)) / (law.rest_gain * volts);
  const growth = Math.exp(law.slow_rate * ahead);
  const beyond = growth * (1 + Math.abs(slow) / steady) >= 1; // of the place where braking at once would stop
  const [sign, lead, shrink] = beyond ? [heading, ahead, 1 / growth] : [-heading, -ahead, growth];
  const pause = Math.log(1 + Math.sqrt(Math.max(1 - (1 + (sign * slow) / steady) * shrink, 0))) / law.slow_rate;
  const first = Math.max(lead + pause, 0);
  for (const [signed, length] of [[sign * volts, first], [-sign * volts, pause], [0, Infinity]]) {
    modes = driven(law, modes, signed, Math.min(length, seconds));
    seconds -= length;
    if (seconds <= 0) break;
  }
  return modes;
}

// An axis after `seconds` under constant volts.
function driven(law, [rest, slow, fast], volts, seconds) {
  const [slowEnd, fastEnd] = [-law.slow_gain * volts, law.fast_gain * volts];
  return [
    rest + law.rest_gain * volts * seconds,
    slowEnd + (slow - slowEnd) * Math.exp(-law.slow_rate * seconds),
    fastEnd + (fast - fastEnd) * Math.exp(-law.fast_rate * seconds),
  ];
}

const placeOf = (axes) => axes.map((modes) => modes[0] + modes[1] + modes[2]);

export class Mallet {
  // law: `axes`, the constants of x and y; `volts`; and `low`, `high` [m], between which targets are
  constructor(law) {
    this.law = law;
    this.aims = []; // { time [s], place [m] }, the oldest first
    this.axes = null; // at this.time, once there is an aim
    this.state = null; // the server's newest
    this.placed = null; // how often the server had placed the mallet anew
    this.over = false;
  }

  // A person points at `place` since `time` [s].
  aim(time, place) {
    if (this.over || !this.state) return;
    this.axes ??= this.state.own;
    this.time ??= time;
    this.aims.push({ time: Math.max(time, this.aims.at(-1)?.time ?? time), place });
    while (this.aims.length > 1 && this.aims[1].time < time - KEPT) this.aims.shift();
  }

  // What the server says of the mallet.
  take(state, now) {
    this.state = state;
    if (!this.axes) this.placed = state.placed;
    if (state.ending && !this.over && this.axes) this.aims.push({ time: now, place: placeOf(state.own) });
    this.over = Boolean(state.ending);
  }

  // Where the mallet is [m] at `now` [s], by which its picture is drawn; null before there was an aim.
  at(now) {
    if (!this.axes) return null;
    const passed = Math.max(now - this.time, 0);
    this.axes = this.run(this.axes, this.time, now);
    this.time = Math.max(now, this.time);
    const { aim, age, own, placed } = this.state;
    const since = aim / 1000 + age / TICKS; // the time in the page whose aims had brought the server's mallet there
    if (placed !== this.placed) this.axes = aim ? this.run(own, since, now) : own;
    else if (aim && !this.over && now - since < KEPT) this.blend(this.run(own, since, now), 1 - Math.exp(-passed / BLEND));
    this.placed = placed;
    return placeOf(this.axes);
  }

  // The axes at `to` that were these at `from`, by the aims in between.
  run(axes, from, to) {
    this.aims.forEach(({ place }, k) => {
      const until = Math.min(this.aims[k + 1]?.time ?? to, to);
      if (until <= from) return;
      const target = place.map((value, a) => Math.min(Math.max(value, this.law.low[a]), this.law.high[a]));
      axes = axes.map((modes, a) => moved(this.law.axes[a], modes, target[a], this.law.volts, until - from));
      from = until;
    });
    return axes;
  }

  // Go a share of the way to other axes.
  blend(axes, share) {
    const [here, there] = [placeOf(this.axes), placeOf(axes)];
    const limited = Math.min(share, MOST / (Math.hypot(there[0] - here[0], there[1] - here[1]) || 1));
    this.axes = this.axes.map((modes, a) => modes.map((mode, k) => mode + limited * (axes[a][k] - mode)));
  }
}
