// A film of a part of the recording: made by the server, and saved by the browser.
const AROUND = 5; // s before and after the moment that is shown
const part = (id) => document.getElementById(id);

part("film").ontoggle = () => {
  const [shown, end] = [Number(part("table").dataset.shown ?? 0), Number(part("time").max)];
  part("from").value = Math.max(shown - AROUND, 0).toFixed(1);
  part("to").value = Math.min(shown + AROUND, Math.max(end, 0.1)).toFixed(1);
  part("from").max = part("to").max = end.toFixed(1);
  part("making").textContent = "";
};

const form = part("film").querySelector("form");
form.onkeydown = (event) => event.stopPropagation(); // arrow keys move through the recording elsewhere
form.onsubmit = async (event) => {
  event.preventDefault();
  const given = new URLSearchParams(location.search);
  const [name, from, to] = [given.get("name"), part("from").value, part("to").value];
  part("making").textContent = "is being made";
  const link = document.createElement("a");
  try {
    const answer = await fetch(`film?${new URLSearchParams({ name, from, to, token: given.get("token") })}`);
    part("making").textContent = answer.ok ? "" : await answer.text();
    if (!answer.ok) return;
    link.href = URL.createObjectURL(await answer.blob());
  } catch (error) {
    part("making").textContent = `the server does not answer (${error.message})`;
    return;
  }
  link.download = `${name}_${from}-${to}s.mp4`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000); // once it is surely saved
};
