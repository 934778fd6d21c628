// Between states of the server, which come 60 times a second and never quite evenly, the picture is interpolated. It is
// shown a little late: by the longest that a state came late in the last seconds.
const KEPT = 2.0; // s of states
const LEAST_DELAY = 0.017, MOST_DELAY = 0.3; // s
const FALLS = 0.05; // by which the delay falls each second, if states come evenly

export class Smoothing {
  constructor() {
    this.clear();
  }

  clear() {
    this.states = [];
    this.offset = -Infinity; // of the server's clock against the page's, by the quickest state
    this.delay = LEAST_DELAY;
    this.looked = null;
  }

  add(state, now) {
    if (this.states.length && state.time <= this.states.at(-1).time) return;
    this.states.push(state);
    while (state.time - this.states[0].time > KEPT) this.states.shift();
    const late = Math.max(this.offset - (state.time - now), 0);
    if (late > MOST_DELAY) this.offset = -Infinity; // the server dropped time, which does not come back
    this.offset = Math.max(this.offset, state.time - now);
    this.delay = Math.max(this.delay, LEAST_DELAY + Math.min(late, MOST_DELAY - LEAST_DELAY));
  }

  // The state that is to be shown at the page's time `now` [s]; null before there is one.
  at(now) {
    if (!this.states.length) return null;
    if (this.looked !== null) this.delay = Math.max(this.delay - FALLS * (now - this.looked), LEAST_DELAY);
    this.looked = now;
    const time = now + this.offset - this.delay;
    const after = this.states.findIndex((state) => state.time >= time);
    if (after <= 0) return after === 0 ? this.states[0] : this.states.at(-1);
    const [a, b] = [this.states[after - 1], this.states[after]];
    return between(a, b, (time - a.time) / (b.time - a.time));
  }
}

const FARTHEST = 0.25; // m that anything goes between two states; what went farther was placed anew, or was not seen

function between(a, b, share) {
  return {
    ...a,
    puck: mix(a.puck, b.puck, share),
    mallets: a.mallets.map((mallet, k) => mix(mallet, b.mallets[k], share)),
  };
}

export function mix(a, b, share) {
  if (!a || !b || Math.hypot(b[0] - a[0], b[1] - a[1]) > FARTHEST) return share < 0.5 ? a : b;
  return [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
}
