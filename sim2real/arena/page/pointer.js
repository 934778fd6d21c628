// Where a person points, in metres of the table: with mouse or finger, or with the arrow keys.
const KEY_SPEED = 1.2; // m/s
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }; // on the screen

export class Pointer {
  // aimed: called with a new place and when the hand was there [ms], before the next picture
  constructor(canvas, drawing, aimed) {
    this.drawing = drawing;
    this.aimed = aimed;
    this.place = null;
    this.down = new Set();
    this.released = new Set(); // keys that went up since the last picture: a short tap moves by one picture's step
    canvas.addEventListener("pointermove", (event) => this.point(canvas, event));
    canvas.addEventListener("pointerdown", (event) => this.point(canvas, event));
    canvas.addEventListener("keydown", (event) => this.key(event, true));
    canvas.addEventListener("keyup", (event) => this.key(event, false));
    canvas.addEventListener("blur", () => this.down.clear());
  }

  point(canvas, event) {
    if (!this.drawing.table) return;
    const box = canvas.getBoundingClientRect();
    this.place = this.inside(this.drawing.metres(event.clientX - box.left, event.clientY - box.top));
    this.aimed(this.place, event.timeStamp);
  }

  key(event, pressed) {
    if (!(event.key in KEYS)) return;
    event.preventDefault();
    if (pressed) this.down.add(event.key);
    this.released[pressed ? "delete" : "add"](event.key);
  }

  // Move on by the keys pressed for `seconds`; `mallet`: from where, if there is no place yet.
  move(seconds, mallet) {
    if (!this.down.size) return;
    const [across, down] = this.drawing.pixel(this.place ?? mallet);
    const step = KEY_SPEED * seconds * this.drawing.scale;
    const sum = [...this.down].map((key) => KEYS[key]).reduce((a, b) => [a[0] + b[0], a[1] + b[1]]);
    this.place = this.inside(this.drawing.metres(across + step * sum[0], down + step * sum[1]));
    for (const key of this.released) this.down.delete(key);
    this.released.clear();
  }

  inside([x, y]) {
    const { length, width } = this.drawing.table;
    return [Math.min(Math.max(x, 0), length), Math.min(Math.max(y, 0), width)];
  }
}
