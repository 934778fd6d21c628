// What a recording holds at a moment: places between rows, the glide that goes on, and the last contact.
import { mix } from "./smoothing.js";

const SHOWN = 0.25; // s after it that a contact is shown
const LONGEST_GAP = 0.1; // s between rows over which nothing is drawn

// The index of the last time that is not after `t`; -1 before the first.
export function before(times, t) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

// Where a track {t, place} is at a time; null where it was not seen.
export function placeAt({ t, place }, time) {
  const k = before(t, time);
  if (k < 0) return null;
  if (k + 1 === t.length) return time - t[k] < LONGEST_GAP ? place[k] : null;
  if (!place[k] || !place[k + 1] || t[k + 1] - t[k] > LONGEST_GAP) return time - t[k] < LONGEST_GAP ? place[k] : null;
  return mix(place[k], place[k + 1], (time - t[k]) / (t[k + 1] - t[k]));
}

// The places of a track in the `seconds` before a time.
export function trail({ t, place }, time, seconds) {
  return place.slice(Math.max(before(t, time - seconds), 0), before(t, time) + 1);
}

// The glide that goes on at a time, or undefined.
export function glideAt(glides, time) {
  const glide = glides[before(glides.map(({ t }) => t[0]), time)];
  return glide && time <= glide.t.at(-1) ? glide : undefined;
}

// The contact that was a moment ago, or undefined.
export function contactAt(contacts, time) {
  const contact = contacts[before(contacts.map(({ t }) => t), time)];
  return contact && time - contact.t < SHOWN ? contact : undefined;
}

// In words, what was found last before a time.
export function words({ glides, contacts }, time) {
  const glide = glideAt(glides, time);
  const contact = contacts[before(contacts.map(({ t }) => t), time)];
  const last = contact ? `${contactWords(contact)}, ${(time - contact.t).toFixed(2)} s ago` : "";
  if (!glide) return last;
  const k = before(glide.t, time);
  const off = `${glide.off_mm[k].toFixed(1)} mm from the prediction (noise ${glide.noise_mm[k].toFixed(1)} mm)`;
  return last ? `${off}; ${last}` : off;
}

function contactWords({ kind, where, after, predicted, guessed }) {
  const what = kind === "unexplained" ? `an unexplained change of motion (${where})` : `${kind} ${where}`;
  if (!after) return what;
  const speed = (pair) => pair.map((v) => v.toFixed(2)).join(", ");
  return `${what}: (${speed(after)}) m/s after it, predicted (${speed(predicted)})${guessed ? " but for its spin, which is not known" : ""}, along the normal and across`;
}
