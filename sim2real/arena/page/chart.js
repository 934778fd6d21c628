// The distance from the prediction over the seconds around the moment that is shown.
const AROUND = 4; // s, of which the moment is the middle
const LEAST = 5; // mm, the height of the chart at least

export class Chart {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
  }

  draw({ glides, contacts }, time) {
    const density = window.devicePixelRatio || 1;
    const { width, height } = this.canvas.getBoundingClientRect();
    this.canvas.width = Math.round(width * density);
    this.canvas.height = Math.round(height * density);
    this.context.setTransform(density, 0, 0, density, 0, 0);
    const colours = getComputedStyle(document.documentElement);
    const colour = (name) => colours.getPropertyValue(`--${name}`);
    const across = (t) => ((t - time) / AROUND + 0.5) * width;
    const near = glides.filter(({ t }) => t.at(-1) > time - AROUND / 2 && t[0] < time + AROUND / 2);
    const top = Math.max(LEAST, ...near.flatMap(({ off_mm }) => off_mm)) * 1.1;
    const down = (off) => height - (off / top) * (height - 2) - 1;
    for (const contact of contacts) {
      if (Math.abs(contact.t - time) > AROUND / 2) continue;
      this.stroke([[across(contact.t), 0], [across(contact.t), height]], colour(contact.kind === "unexplained" ? "one" : "rail"), 1);
    }
    for (const { t, off_mm, noise_mm, fitted } of near) {
      const points = (values) => values.map((off, k) => [across(t[k]), down(off)]);
      this.stroke(points(noise_mm), colour("line"), 2);
      this.stroke(points(off_mm).slice(0, fitted), colour("muted"), 2);
      this.stroke(points(off_mm).slice(fitted - 1), colour("two"), 2);
    }
    this.stroke([[width / 2, 0], [width / 2, height]], colour("ink"), 1);
    this.context.fillStyle = colour("muted");
    this.context.font = "12px system-ui, sans-serif";
    this.context.fillText(`${top.toFixed(0)} mm`, 2, 12);
  }

  stroke(points, colour, width) {
    const { context } = this;
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    points.forEach(([x, y], k) => context[k ? "lineTo" : "moveTo"](x, y));
    context.stroke();
  }
}
