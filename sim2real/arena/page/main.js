// The page of the arena: what the server sends is drawn, and where a person points is sent.
import { Drawing } from "./drawing.js";
import { Link } from "./link.js";
import { Pointer } from "./pointer.js";
import { Smoothing } from "./smoothing.js";

const AIM_EVERY = 8; // ms between two aims at least
const part = (id) => document.getElementById(id);
const canvas = part("table");
const drawing = new Drawing(canvas);
const pointer = new Pointer(canvas, drawing);
const smoothing = new Smoothing();
let seat = null, newest = null, sent = 0, acted = 0, lag = null, before = performance.now();

const hear = {
  welcome(message) {
    seat = message.seat;
    drawing.table = message.table;
    drawing.fit();
    smoothing.clear();
    message.names.forEach((name, k) => { part(`name-${k}`).textContent = k === seat ? "you" : name; });
    part("note").textContent = seat === null ? "watching" : "";
    part("again").hidden = part("replay").hidden = true;
    canvas.style.cursor = seat === null ? "default" : "none";
    if (seat !== null) canvas.focus();
  },
  state(message) {
    newest = message;
    if (message.aim !== acted) [acted, lag] = [message.aim, performance.now() - message.aim];
    smoothing.add(message, performance.now() / 1000);
    part("score").textContent = message.score.join(" : ");
    const left = Math.ceil(message.left);
    part("clock").textContent = `${Math.floor(left / 60)}:${String(left % 60).padStart(2, "0")}`;
    if (message.ending) ended(message);
  },
  recorded(message) {
    const address = new URL("replay", location.href);
    address.search = new URLSearchParams({ name: message.name, token: link.token });
    part("replay").href = address;
    part("replay").hidden = false;
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
  part("again").hidden = false;
}

// The round trip, and from where a person pointed to the first state that came of it.
function latency() {
  const line = `${link.roundTrip.toFixed(0)} ms`;
  return lag === null ? line : `${line}, pointer ${lag.toFixed(0)} ms`;
}

function frame(time) {
  requestAnimationFrame(frame);
  const state = smoothing.at(time / 1000);
  if (seat !== null && state) {
    pointer.move((time - before) / 1000, state.mallets[seat]);
    if (pointer.place && time - sent >= AIM_EVERY) {
      sent = time;
      link.say({ kind: "aim", x: pointer.place[0], y: pointer.place[1], sent: time });
    }
  }
  before = time;
  if (state) drawing.draw(state, seat === null ? null : pointer.place);
  part("latency").textContent = link.roundTrip === null ? "" : latency();
  if (newest) [canvas.dataset.shown, canvas.dataset.mallet] = [newest.time, JSON.stringify(newest.mallets[seat ?? 0])];
}
requestAnimationFrame(frame);
