// The table on the canvas: metres of the table to pixels, x to the right and y upwards; upright where it is narrow.
const MARGIN = 0.07; // m around the table

export class Drawing {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.table = null;
    new ResizeObserver(() => this.fit()).observe(canvas.parentElement);
  }

  fit() {
    if (!this.table) return;
    const room = this.canvas.parentElement.getBoundingClientRect();
    const [long, short] = [this.table.length + 2 * MARGIN, this.table.width + 2 * MARGIN];
    this.upright = room.height > room.width;
    const [across, down] = this.upright ? [short, long] : [long, short];
    this.scale = Math.max(Math.min(room.width / across, room.height / down), 1);
    this.canvas.style.width = `${across * this.scale}px`;
    this.canvas.style.height = `${down * this.scale}px`;
    const density = window.devicePixelRatio || 1;
    this.canvas.width = Math.round(across * this.scale * density);
    this.canvas.height = Math.round(down * this.scale * density);
    this.density = density;
  }

  // The place [px] of a point [m], and the other way round; player 0 is at the left, or below.
  pixel([x, y]) {
    const { length, width } = this.table;
    return this.upright
      ? [(MARGIN + width - y) * this.scale, (MARGIN + length - x) * this.scale]
      : [(MARGIN + x) * this.scale, (MARGIN + width - y) * this.scale];
  }

  metres(across, down) {
    const { length, width } = this.table;
    return this.upright
      ? [length + MARGIN - down / this.scale, width + MARGIN - across / this.scale]
      : [across / this.scale - MARGIN, width + MARGIN - down / this.scale];
  }

  draw(state, aim) {
    if (!this.table) return;
    const { context, table } = this;
    const colours = getComputedStyle(document.documentElement);
    const colour = (name) => colours.getPropertyValue(`--${name}`);
    context.setTransform(this.density, 0, 0, this.density, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.box([-0.05, -0.05], [table.length + 0.05, table.width + 0.05], colour("rail"));
    this.box([0, 0], [table.length, table.width], colour("ice"));
    this.box([table.length / 2 - 0.004, 0], [table.length / 2 + 0.004, table.width], colour("line"));
    const post = (table.width - table.goal_width) / 2;
    this.box([-0.05, post], [0, table.width - post], colour("one"));
    this.box([table.length, post], [table.length + 0.05, table.width - post], colour("two"));
    this.disc(state.puck, table.puck_radius, colour("puck"));
    this.disc(state.puck, 0.6 * table.puck_radius, colour("ring"));
    state.mallets.forEach((mallet, k) => {
      this.disc(mallet, table.mallet_radius, colour(k ? "two" : "one"));
      this.disc(mallet, 0.45 * table.mallet_radius, colour("ice"));
    });
    this.disc(aim, 0.008, colour("muted"));
  }

  // A line through places [m], of a colour by name; a place that is null interrupts it.
  line(places, name, width = 2) {
    const { context } = this;
    context.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`);
    context.lineWidth = width;
    context.beginPath();
    places.forEach((place, k) => {
      if (place) context[k && places[k - 1] ? "lineTo" : "moveTo"](...this.pixel(place));
    });
    context.stroke();
  }

  // A circle around a place [m], of a colour by name.
  ring(place, radius, name) {
    if (!place) return;
    this.context.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue(`--${name}`);
    this.context.lineWidth = 2;
    this.context.beginPath();
    this.context.arc(...this.pixel(place), radius * this.scale, 0, 2 * Math.PI);
    this.context.stroke();
  }

  box(from, to, colour) {
    const [a, b] = [this.pixel(from), this.pixel(to)];
    this.context.fillStyle = colour;
    this.context.fillRect(Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.abs(a[0] - b[0]), Math.abs(a[1] - b[1]));
  }

  // Nothing is drawn of a place that is not known.
  disc(place, radius, colour) {
    if (!place) return;
    const [x, y] = this.pixel(place);
    this.context.fillStyle = colour;
    this.context.beginPath();
    this.context.arc(x, y, radius * this.scale, 0, 2 * Math.PI);
    this.context.fill();
  }
}
