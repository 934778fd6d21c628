// The page of a recording: what was seen, beside what the simulator predicts, with a slider through time.
import { Chart } from "./chart.js";
import { Diagnosis } from "./diagnosis.js";
import { Drawing } from "./drawing.js";
import { contactAt, glideAt, placeAt, trail, words } from "./timeline.js";

const TRAIL = 0.4; // s of the puck's path
const STEP = 1 / 120; // s that an arrow key moves
const MARK = 0.015; // m, radius of the ring about a contact
const part = (id) => document.getElementById(id);
const drawing = new Drawing(part("table"));
const chart = new Chart(part("chart"));
let recording = null, plain = null, time = 0, end = 0, playing = false, before = 0, drawn = null;

async function load() {
  const given = new URLSearchParams(location.search);
  const answer = await fetch(`recording?${given}`);
  if (!answer.ok) {
    part("note").textContent = await answer.text();
    document.body.classList.add("empty");
    return;
  }
  recording = plain = await answer.json();
  new Diagnosis((found) => {
    recording = { ...plain, ...found };
    drawn = null;
  });
  part("name").textContent = recording.name;
  part("note").textContent = recording.note;
  end = Math.max(...[recording.puck, ...recording.mallets].map(({ t }) => t.at(-1) ?? 0));
  part("time").max = end;
  drawing.table = recording.table;
  drawing.fit();
  move(Number(given.get("at")) || 0);
  requestAnimationFrame(frame);
}

function move(to) {
  time = Math.min(Math.max(to, 0), end);
  part("time").value = time;
}

function frame(now) {
  requestAnimationFrame(frame);
  if (playing) move(time + (Number(part("speed").value) * (now - before)) / 1000);
  if (time >= end) playing = false;
  before = now;
  if (time !== drawn) draw();
}

function draw() {
  drawn = time;
  part("play").textContent = playing ? "Pause" : "Play";
  part("clock").textContent = `${time.toFixed(2)} of ${end.toFixed(1)} s`;
  part("what").textContent = words(recording, time);
  show(glideAt(recording.glides, time));
  chart.draw(recording, time);
}

function show(glide) {
  const puck = placeAt(recording.puck, time);
  const mallets = recording.mallets.map((track) => placeAt(track, time));
  drawing.draw({ puck, mallets }, null);
  drawing.line(trail(recording.puck, time, TRAIL), "ink");
  const expected = glide ? placeAt({ t: glide.t, place: glide.path }, time) : null;
  if (glide) {
    drawing.line(glide.path.slice(0, glide.fitted), "muted");
    drawing.line(glide.path.slice(glide.fitted - 1), "two");
    drawing.ring(expected, recording.table.puck_radius, "two");
  }
  const contact = contactAt(recording.contacts, time);
  if (contact) drawing.ring(contact.place, MARK, contact.kind === "unexplained" ? "one" : "ink");
  const shown = { shown: time, puck, expected, mallet: mallets[0] };
  for (const [name, value] of Object.entries(shown)) part("table").dataset[name] = JSON.stringify(value);
}

part("play").onclick = () => {
  if (time >= end) move(0);
  playing = !playing;
  drawn = null;
};
const resized = new ResizeObserver(() => { drawn = null; }); // which empties a canvas
resized.observe(part("table").parentElement);
resized.observe(part("chart"));
matchMedia("(prefers-color-scheme: dark)").onchange = () => { drawn = null; };
part("time").oninput = () => move(Number(part("time").value));
document.addEventListener("keydown", (event) => {
  const step = { ArrowLeft: -STEP, ArrowRight: STEP }[event.key];
  if (step === undefined || event.target.tagName === "SELECT") return;
  event.preventDefault();
  playing = false;
  move(time + step);
});
load();
