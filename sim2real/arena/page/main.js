// The page of the arena: what the server sends is drawn, and where a person points is sent.
import { Drawing } from "./drawing.js";
import { Link } from "./link.js";
import { Mallet } from "./mallet.js";
import { Pointer } from "./pointer.js";
import { Smoothing } from "./smoothing.js";
import { Standings } from "./standings.js";

const AIM_EVERY = 8; // ms between two aims at least
const HINT = "point, or press an arrow key";
const part = (id) => document.getElementById(id);
const canvas = part("table");
const drawing = new Drawing(canvas);
const pointer = new Pointer(canvas, drawing, aimed);
const smoothing = new Smoothing();
const standings = new Standings(part("standings"), part("ratings"));
let seat = null, mallet = null, newest = null, sent = 0, acted = 0, lag = null, again = false, notice = "", hinted = false, before = performance.now();

const hear = {
  welcome(message) {
    seat = message.seat;
    mallet = seat === null ? null : new Mallet(message.law);
    if (message.watch) linked("watch", "", { watch: message.watch });
    again = message.again;
    drawing.table = message.table;
    drawing.fit();
    smoothing.clear();
    message.names.forEach((name, k) => { part(`name-${k}`).textContent = k === seat ? `you (${name})` : name; });
    standings.playing(message.names);
    notice = message.notice ?? "";
    part("note").textContent = [seat === null ? "watching" : HINT, ...(notice ? [notice] : [])].join("; ");
    hinted = seat !== null;
    part("again").hidden = part("replay").hidden = true;
    standings.show(false);
    canvas.style.cursor = seat === null ? "default" : "none";
    if (seat !== null) canvas.focus();
  },
  state(message) {
    newest = message;
    mallet?.take(message, performance.now() / 1000);
    if (seat !== null && message.aim && message.aim !== acted) [acted, lag] = [message.aim, performance.now() - message.aim];
    smoothing.add(message, performance.now() / 1000);
    part("score").textContent = message.score.join(" : ");
    const left = Math.ceil(message.left);
    part("clock").textContent = `${Math.floor(left / 60)}:${String(left % 60).padStart(2, "0")}`;
    if (message.ending) ended(message);
  },
  recorded(message) {
    linked("replay", "replay", { name: message.name });
  },
  standings(message) {
    standings.fill(message);
  },
  closed(message) {
    part("note").textContent = message.reason;
  },
};

const link = new Link((message) => hear[message.kind]?.(message));
part("again").onclick = () => link.say({ kind: "again" });

function ended({ score, ending }) {
  const won = score[0] === score[1] ? "a draw" : `${part(`name-${score[0] > score[1] ? 0 : 1}`).textContent} won`;
  part("note").textContent = `${won} (${ending})`;
  part("again").hidden = !again;
  standings.show(true);
}

function linked(id, page, query) {
  const address = new URL(page || location.pathname, location.href);
  address.search = new URLSearchParams({ token: link.token, ...query });
  part(id).href = address;
  part(id).hidden = false;
}

// A person points at a place since `time` [ms]: the own mallet follows at once, but for what is drawn already, and the
// server hears of it.
function aimed(place, time) {
  if (seat === null || time - sent < AIM_EVERY) return;
  if (hinted) part("note").textContent = notice;
  hinted = false;
  sent = Math.max(time, before);
  mallet.aim(sent / 1000, place);
  link.say({ kind: "aim", x: place[0], y: place[1], sent });
}

// The round trip, and from where a person pointed to the first state that came of it.
function latency() {
  const line = `line ${link.roundTrip.toFixed(0)} ms`;
  return lag === null ? line : `${line}, pointer ${lag.toFixed(0)} ms`;
}

function frame() {
  requestAnimationFrame(frame);
  const now = performance.now();
  let state = smoothing.at(now / 1000);
  if (seat !== null && state) {
    pointer.move((now - before) / 1000, state.mallets[seat]);
    if (pointer.place) aimed(pointer.place, now);
    state = { ...state, mallets: state.mallets.with(seat, mallet.at(now / 1000) ?? state.mallets[seat]) };
  }
  before = now;
  if (state) drawing.draw(state, seat === null ? null : pointer.place);
  part("latency").textContent = link.roundTrip === null ? "" : latency();
  if (!state) return; // as between a welcome and its first state
  const shown = { shown: newest.time, puck: newest.puck, mallet: newest.mallets[seat ?? 0] };
  for (const [name, value] of Object.entries(shown)) canvas.dataset[name] = JSON.stringify(value);
  canvas.dataset.drawn = JSON.stringify([now, ...state.mallets[seat ?? 0]]);
}
requestAnimationFrame(frame);
