// The diagnosis of the recording that is shown: it is asked for, waited for, and its predictions can be shown.
const ASKED_EVERY = 2000; // ms, while it goes on
const part = (id) => document.getElementById(id);

export class Diagnosis {
  // `show` is called with what is predicted with what was found, or with null for the simulator as it is.
  constructor(show) {
    this.found = null;
    part("diagnose").onclick = () => this.ask("POST");
    this.awaited = false; // whether who looks asked for it, and waits to see what it makes of the prediction
    part("law").onchange = () => show(part("law").value === "after" ? this.found : null);
    this.ask("GET");
  }

  async ask(method) {
    this.awaited ||= method === "POST";
    const answer = await this.fetched("diagnosis", method);
    if (!answer) return;
    const { state, words, concealed } = answer;
    part("diagnose").hidden = state === "going" || state === "there";
    part("progress").textContent = state === "failed" ? `no diagnosis: ${words}` : words;
    if (state === "going") setTimeout(() => this.ask("GET"), ASKED_EVERY);
    if (state === "there") await this.load(concealed);
    if (state === "there" && this.awaited) this.choose("after");
  }

  async load(concealed) {
    part("progress").textContent = "reading the diagnosis";
    this.found = await this.fetched("diagnosed", "GET");
    if (!this.found) return;
    part("progress").textContent = "";
    part("report").href = `report?${new URLSearchParams(location.search)}`;
    part("found").textContent = this.found.summary.join("\n");
    part("left-out").textContent = this.found.left_out.map((what) => `not in the prediction: ${what}`).join("; ");
    part("concealed").textContent = concealed ? `concealed was ${concealed.words}` : "";
    part("findings").hidden = part("switch").hidden = false;
  }

  choose(law) {
    part("law").value = law;
    part("law").dispatchEvent(new Event("change"));
  }

  // What the server says; null where it says why not, or nothing.
  async fetched(what, method) {
    try {
      const answer = await fetch(`${what}?${new URLSearchParams(location.search)}`, { method });
      if (answer.ok) return await answer.json();
      part("progress").textContent = await answer.text();
    } catch (error) {
      part("progress").textContent = `the server does not answer (${error.message})`;
    }
    part("diagnose").hidden = false;
    return null;
  }
}
