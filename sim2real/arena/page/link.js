// The WebSocket to the server: it comes back by itself, into the same game, and measures the round trip.
const PING_EVERY = 1000; // ms
const FINAL = [4001, 4002]; // codes after which there is nothing to come back to, see lobby.py
const FIRST_WAIT = 250, LONGEST_WAIT = 5000; // ms before it is tried again

export class Link {
  constructor(heard) {
    this.heard = heard;
    const asked = new URLSearchParams(location.search);
    this.token = asked.get("token") ?? "";
    this.watch = asked.get("watch"); // the game that is looked on at, if this page does not play
    this.id = sessionStorage.getItem("game") ?? ""; // so that a page that is loaded anew comes back into its game
    this.wait = FIRST_WAIT;
    this.roundTrip = null;
    this.open();
    setInterval(() => this.say({ kind: "ping", sent: performance.now() }), PING_EVERY);
  }

  open() {
    const address = new URL("game", location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    address.search = new URLSearchParams({ token: this.token, ...(this.watch ? { watch: this.watch } : { id: this.id }) });
    this.socket = new WebSocket(address);
    this.socket.onmessage = (event) => this.take(JSON.parse(event.data));
    this.socket.onclose = (event) => this.closed(event);
  }

  take(message) {
    if (message.kind === "pong") {
      this.roundTrip = performance.now() - message.sent;
      return;
    }
    if (message.kind === "welcome") {
      this.wait = FIRST_WAIT;
      if (message.id) sessionStorage.setItem("game", (this.id = message.id));
    }
    this.heard(message);
  }

  closed(event) {
    this.roundTrip = null;
    if (FINAL.includes(event.code)) {
      this.heard({ kind: "closed", reason: event.reason });
      return;
    }
    this.heard({ kind: "closed", reason: event.reason || "connection lost, trying again" });
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
  }

  say(message) {
    const held = message.kind === "aim" && this.socket.bufferedAmount > 0; // a line that stands still gets no backlog
    if (this.socket.readyState === WebSocket.OPEN && !held) this.socket.send(JSON.stringify(message));
  }
}
