// Shows the values under the pointer, the finger or the arrow keys. The curves themselves are the data.
"use strict";
const panels = [...document.querySelectorAll(".panel")].map((box) => ({
  box,
  fold: box.closest("details"),
  area: box.querySelector(".area"),
  start: +box.dataset.start,
  length: +box.dataset.length,
  zero: +box.dataset.zero,
  digits: +(box.dataset.digits || 3),
  cursor: box.querySelector(".cursor"),
  tail: box.querySelector(".cursor").getAttribute("d").replace(/^M\S+/, ""),
  marks: [...box.querySelectorAll("output")],
  lines: [...box.querySelectorAll(".line")],
  phases: [...box.querySelectorAll(".phase")],
  events: [...box.querySelectorAll(".event")].map((mark) => [
    +mark.getAttribute("d").match(/M([-\d.]+)/)[1],
    mark.textContent,
  ]),
}));
const curvesOf = (panel) =>
  (panel.curves ??= panel.lines.map((line) => {
    const points = [];
    for (const [, pen, x, y] of line.getAttribute("d").matchAll(/([ML])([-\d.]+) ([-\d.]+)/g)) {
      if (pen === "M" && points.length) points.push([points.at(-1)[0], NaN]);
      points.push([+x, +y]);
    }
    return points;
  }));
const tracks = [...document.querySelectorAll(".track")].map((box) => ({
  box,
  start: +box.dataset.start,
  points: box.dataset.points.split(";").map((point) => point.split(" ").map(Number)),
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

const shown = (value, { box, digits }) =>
  Number.isFinite(value) ? String(+value.toPrecision(digits)) + (box.dataset.unit ? " " + box.dataset.unit : "") : "unknown";

// Minutes and seconds, as on the scale of time.
function minutes(seconds) {
  const tenths = Math.round(Math.abs(seconds) * 10);
  return (seconds < 0 ? "-" : "") + Math.floor(tenths / 600) + ":" + ((tenths % 600) / 10).toFixed(1).padStart(4, "0");
}

// Where a point of the track is, from its first one.
function place([, x, y], [, fromX, fromY]) {
  const [east, north] = [x - fromX, fromY - y].map(Math.round);
  return Math.abs(north) + " m " + (north < 0 ? "south" : "north") + ", " + Math.abs(east) + " m " + (east < 0 ? "west" : "east") + " of take-off";
}

// A comparison has flights of its own clocks; all panels of one flight have the same one.
let share = 0.5;
function show(of) {
  const inputs = [];
  for (const panel of panels) {
    if (panel.fold && !panel.fold.open) continue;
    const x = share * panel.length;
    panel.cursor.setAttribute("d", "M" + x + panel.tail);
    panel.marks.forEach((mark, i) => (mark.textContent = shown(held(curvesOf(panel)[i], x), panel)));
    if (panel.box.dataset.input) inputs[panel.box.dataset.input] = held(curvesOf(panel)[0], x);
  }
  const x = share * of.length, main = panels[0];
  const words = [minutes(of.start + x - of.zero) + " min", (of.start + x).toFixed(1) + " s of the log"];
  if (main.start === of.start) {
    const phase = main.phases.find((p) => parseFloat(p.style.left) <= share * 100 && share * 100 <= parseFloat(p.style.left) + parseFloat(p.style.width));
    if (phase) words.push(phase.textContent);
    const near = main.events.filter(([t]) => Math.abs(t - x) < of.length * 0.01).map(([, text]) => text);
    words.push(...near.slice(0, 3));
  }
  now.textContent = words.join(" · ");
  for (const track of tracks) {
    const there = track.points.findLast(([t]) => t <= of.start + x - track.start) ?? track.points[0];
    track.box.querySelector(".here").setAttribute("d", "M" + there[1] + " " + there[2] + "h0");
    track.box.querySelector("output").textContent = place(there, track.points[0]);
  }
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
for (const panel of panels) panel.fold?.addEventListener("toggle", () => now.textContent && show(panels[0]));
document.addEventListener("input", ({ target }) => {
  const wanted = target.value.toLowerCase();
  for (const row of target.closest(".searched")?.querySelectorAll("tr") ?? []) row.hidden = !row.textContent.toLowerCase().includes(wanted);
});
addEventListener("keydown", (event) => {
  const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (!step || !panels.length || event.target.matches("input")) return;
  share = Math.min(1, Math.max(0, share + (step * (event.shiftKey ? 10 : 1)) / 500));
  show(panels[0]);
  event.preventDefault();
});
