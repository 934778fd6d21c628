// The table of a tournament: shown between matches, and at any time by a button.
const points = (value) => (value === null ? "" : `${value < 0 ? "−" : "+"}${Math.abs(value).toFixed(0)}`);

export class Standings {
  constructor(section, button) {
    Object.assign(this, { section, button });
    button.onclick = () => this.show(section.hidden);
  }

  fill({ rows, next }) {
    this.button.hidden = false;
    this.section.querySelector("tbody").replaceChildren(...rows.map((row) => {
      const line = document.createElement("tr");
      const interval = row.low === null ? "" : `${points(row.low)} to ${points(row.high)}`;
      for (const text of [row.name, row.matches, row.won, row.drawn, row.lost, points(row.rating), interval]) {
        line.insertCell().textContent = text;
      }
      return line;
    }));
    this.next = next;
    this.tell();
  }

  // Who plays now: the match that was to come next, or one that is over.
  playing(names) {
    this.names = names;
    this.tell();
  }

  tell() {
    if (!this.next) return;
    const now = this.next.every((name, k) => name === this.names?.[k]);
    this.section.querySelector("p").textContent = `${now ? "now" : "next"}: ${this.next.join(" against ")}`;
  }

  show(shown) {
    this.section.hidden = !shown || this.button.hidden; // no other game has standings
    this.button.setAttribute("aria-expanded", String(!this.section.hidden));
  }
}
