// Brings the charts of speed against accuracy to life: a box for every point, families one at a time. Without it
// the browser shows the titles of the points.
for (const chart of document.querySelectorAll(".trade")) {
  const box = chart.querySelector(".trade-box");
  const marks = [...chart.querySelectorAll(".trade-panels .mark")];
  const buttons = [...chart.querySelectorAll(".trade-legend button")];
  let held = null;

  for (const mark of marks) {
    const title = mark.querySelector("title");
    mark.setAttribute("aria-label", title.textContent);
    title.remove();
  }

  const dim = (family) => {
    for (const mark of marks) mark.classList.toggle("dim", family !== null && mark.dataset.family !== family);
  };

  const hide = () => {
    box.hidden = true;
    for (const mark of marks) mark.classList.remove("twin");
  };

  const show = (mark) => {
    hide();
    box.textContent = mark.getAttribute("aria-label");
    box.hidden = false;
    const around = chart.getBoundingClientRect(), at = mark.getBoundingClientRect();
    const left = at.left + at.width / 2 - around.left, below = at.bottom - around.top + 8;
    box.style.left = Math.max(0, Math.min(left - box.offsetWidth / 2, around.width - box.offsetWidth)) + "px";
    box.style.top = below + "px";
    for (const other of marks) other.classList.toggle("twin", other !== mark && other.dataset.run === mark.dataset.run);
  };

  const step = (mark, by) => {
    const row = [...mark.parentNode.querySelectorAll(".mark")].sort((a, b) => a.dataset.x - b.dataset.x);
    const next = row[row.indexOf(mark) + by];
    if (next) next.focus();
  };

  for (const mark of marks) {
    mark.addEventListener("pointerenter", () => show(mark));
    mark.addEventListener("pointerleave", hide);
    mark.addEventListener("focus", () => show(mark));
    mark.addEventListener("blur", hide);
    mark.addEventListener("keydown", (event) => {
      const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (event.key === "Escape") hide();
      if (!by) return;
      event.preventDefault();
      step(mark, by);
    });
  }

  for (const button of buttons) {
    const family = button.dataset.family;
    button.setAttribute("aria-pressed", "false");
    button.addEventListener("pointerenter", () => dim(family));
    button.addEventListener("pointerleave", () => dim(held));
    button.addEventListener("focus", () => dim(family));
    button.addEventListener("blur", () => dim(held));
    button.addEventListener("click", () => {
      held = held === family ? null : family;
      for (const other of buttons) other.setAttribute("aria-pressed", String(other.dataset.family === held));
      dim(held);
    });
  }
}
