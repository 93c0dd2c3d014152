// Shows the values under the pointer, the finger or the arrow keys. The curves themselves are the data.
"use strict";
const panels = [...document.querySelectorAll(".panel")].map((box) => ({
  box,
  area: box.querySelector(".area"),
  start: +box.dataset.start,
  length: +box.dataset.length,
  cursor: box.querySelector(".cursor"),
  tail: box.querySelector(".cursor").getAttribute("d").replace(/^M\S+/, ""),
  marks: [...box.querySelectorAll("output")],
  curves: [...box.querySelectorAll(".line")].map((line) => {
    const points = [];
    for (const [, pen, x, y] of line.getAttribute("d").matchAll(/([ML])([-\d.]+) ([-\d.]+)/g)) {
      if (pen === "M" && points.length) points.push([points.at(-1)[0], NaN]);
      points.push([+x, +y]);
    }
    return points;
  }),
  phases: [...box.querySelectorAll(".phase")],
  events: [...box.querySelectorAll(".event")].map((mark) => [
    +mark.getAttribute("d").match(/M([-\d.]+)/)[1],
    mark.textContent,
  ]),
}));
const maps = [...document.querySelectorAll(".map")];
const now = document.getElementById("now");

// The latest value at or before x.
function held(points, x) {
  let low = 0, high = points.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (points[middle][0] <= x) low = middle + 1;
    else high = middle;
  }
  return low ? points[low - 1][1] : NaN;
}

const shown = (value, unit) =>
  Number.isFinite(value) ? String(+value.toPrecision(3)) + (unit ? " " + unit : "") : "unknown";

// A comparison has flights of its own clocks; all panels of one flight have the same one.
let share = 0.5;
function show(of) {
  const inputs = [];
  for (const panel of panels) {
    const x = share * panel.length;
    panel.cursor.setAttribute("d", "M" + x + panel.tail);
    panel.marks.forEach((mark, i) => (mark.textContent = shown(held(panel.curves[i], x), panel.box.dataset.unit)));
    if (panel.box.dataset.input) inputs[panel.box.dataset.input] = held(panel.curves[0], x);
  }
  const x = share * of.length, main = panels[0];
  const words = [(of.start + x).toFixed(1) + " s"];
  if (main.start === of.start) {
    const phase = main.phases.find((p) => parseFloat(p.style.left) <= share * 100 && share * 100 <= parseFloat(p.style.left) + parseFloat(p.style.width));
    if (phase) words.push(phase.textContent);
    const near = main.events.filter(([t]) => Math.abs(t - x) < of.length * 0.01).map(([, text]) => text);
    words.push(...near.slice(0, 3));
  }
  now.textContent = words.join(" · ");
  for (const map of maps) {
    const [left, right, low, high] = map.dataset.box.split(" ").map(Number);
    const size = map.querySelector("svg").viewBox.baseVal.width;
    const across = ((inputs[map.dataset.x] - left) / (right - left)) * size;
    const up = ((inputs[map.dataset.y] - low) / (high - low)) * size;
    const there = Number.isFinite(across) && Number.isFinite(up);
    map.querySelector(".here").setAttribute("d", there ? "M" + across + " " + up + "h0" : "M-9-9h0");
  }
}

for (const panel of panels) {
  const point = (event) => {
    const box = panel.area.getBoundingClientRect();
    share = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    show(panel);
  };
  panel.area.addEventListener("pointermove", point);
  panel.area.addEventListener("pointerdown", point);
}
for (const map of maps) {
  map.querySelector("svg").addEventListener("pointerover", (event) => {
    const value = event.target.dataset.v;
    if (value) map.querySelector("output").textContent = "here " + value;
  });
}
addEventListener("keydown", (event) => {
  const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (!step || !panels.length) return;
  share = Math.min(1, Math.max(0, share + (step * (event.shiftKey ? 10 : 1)) / 500));
  show(panels[0]);
  event.preventDefault();
});
