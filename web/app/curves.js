// How solvers converge: residuals per iteration on a logarithmic scale, and a table.

import { RANGES, colour, distortion } from "./distortion.js";

const SVG = "http://www.w3.org/2000/svg";
const COLOURS = ["#2a86a8", "#d2561c", "#5b8c2a", "#9a5fc0"];
/** Lines differ in more than their colours. */
const DASHES = ["none", "8 4", "2 3", "10 3 2 3"];
const [WIDTH, HEIGHT, LEFT, BELOW] = [640, 260, 52, 28];

function element(name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

/** Texels along a side of the picture of a layout. */
const SIDE = 480;

/** The layouts of runs side by side, coloured by their distortion of angles. */
export function layouts(mesh, runs) {
  const all = document.createElement("div");
  all.className = "layouts";
  const angles = runs.map(({ flat }) => distortion(mesh, flat, [1, 1]).angle);
  // One scale for all: red is what few triangles are above.
  const most = Math.max(1.01, ...angles.map((angle) => Float32Array.from(angle.filter(Number.isFinite)).sort().at(-1 - Math.floor(angle.length / 100)) ?? 1));
  for (const [at, { solver, flat }] of runs.entries()) {
    const figure = document.createElement("figure");
    const canvas = Object.assign(document.createElement("canvas"), { width: SIDE, height: SIDE });
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `The layout of ${solver}, coloured by its distortion of angles`);
    draw(canvas.getContext("2d"), mesh, flat, angles[at].map((value) => value ** (Math.log(RANGES.angle[1]) / Math.log(most))));
    const worst = Number.isFinite(flat.qcMax) ? flat.qcMax.toFixed(2) : "infinite";
    const caption = `${solver}: quasi-conformal distortion ${flat.qcMean.toFixed(4)}, at most ${worst}`;
    figure.append(canvas, Object.assign(document.createElement("figcaption"), { textContent: caption }));
    all.append(figure);
  }
  const legend = document.createElement("p");
  legend.textContent = `From light to red: quasi-conformal distortion from 1 to ${most.toFixed(2)} and more, which a hundredth of the triangles has.`;
  all.append(legend);
  return all;
}

function draw(context, { indices }, { uv }, angle) {
  const low = [0, 1].map((axis) => indices.reduce((least, v) => Math.min(least, uv[2 * v + axis]), Infinity));
  const high = [0, 1].map((axis) => indices.reduce((most, v) => Math.max(most, uv[2 * v + axis]), -Infinity));
  const scale = (SIDE - 16) / (Math.max(high[0] - low[0], high[1] - low[1]) || 1);
  const x = (v) => SIDE / 2 + (uv[2 * v] - (low[0] + high[0]) / 2) * scale;
  const y = (v) => SIDE / 2 - (uv[2 * v + 1] - (low[1] + high[1]) / 2) * scale;
  for (let f = 0; f < indices.length / 3; ++f) {
    const [a, b, c] = indices.subarray(3 * f, 3 * f + 3);
    const rgb = colour("angle", angle[f]).map((part) => Math.round(255 * part));
    context.fillStyle = context.strokeStyle = `rgb(${rgb.join(" ")})`;
    context.beginPath();
    context.moveTo(x(a), y(a));
    context.lineTo(x(b), y(b));
    context.lineTo(x(c), y(c));
    context.closePath();
    context.fill();
    context.stroke();
  }
}

/** The drawing and the table of runs: { solver, points: [iteration, residual][], flat, seconds }. */
export function curves(runs) {
  const most = Math.max(1, ...runs.flatMap(({ points }) => points.map(([iteration]) => iteration)));
  const [top, bottom] = [1, -16];
  const x = (iteration) => LEFT + ((iteration - 0.5) / most) * (WIDTH - LEFT - 10);
  const y = (residual) => {
    const log = Math.min(Math.max(Math.log10(Math.max(residual, 1e-300)), bottom), top);
    return 10 + ((top - log) / (top - bottom)) * (HEIGHT - BELOW - 10);
  };
  const svg = element("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img" });
  svg.append(element("title", {}, runs.map(({ solver, points }) => `${solver}: ${points.length} iterations`).join("; ")));
  for (let log = 0; log >= bottom; log -= 4) {
    const at = y(10 ** log);
    svg.append(element("line", { x1: LEFT, x2: WIDTH - 10, y1: at, y2: at, stroke: "currentColor", "stroke-opacity": 0.15 }));
    svg.append(element("text", { x: LEFT - 6, y: at + 4, "text-anchor": "end", "font-size": 11, fill: "currentColor" }, `1e${log}`));
  }
  svg.append(element("text", { x: WIDTH - 10, y: HEIGHT - 6, "text-anchor": "end", "font-size": 11, fill: "currentColor" }, `iteration, 1 to ${most}`));
  runs.forEach(({ solver, points }, at) => {
    const stroke = COLOURS[at % COLOURS.length];
    const dashes = DASHES[at % DASHES.length];
    const path = points.map(([iteration, residual]) => `${x(iteration).toFixed(1)},${y(residual).toFixed(1)}`).join(" ");
    svg.append(element("polyline", { points: path, fill: "none", stroke, "stroke-width": 2, "stroke-dasharray": dashes }));
    for (const [iteration, residual] of points) svg.append(element("circle", { cx: x(iteration), cy: y(residual), r: 3, fill: stroke }));
    const [left, middle] = [LEFT + 120 * at, HEIGHT - 10];
    svg.append(element("line", { x1: left, x2: left + 24, y1: middle, y2: middle, stroke, "stroke-width": 2, "stroke-dasharray": dashes }));
    svg.append(element("text", { x: left + 30, y: HEIGHT - 6, "font-size": 12, fill: stroke }, solver));
  });
  const table = document.createElement("table");
  const heads = ["solver", "iterations", "seconds", "angle error", "L² stretch", "valid", "ended"];
  const rows = runs.map(({ solver, points, flat, seconds }) => [
    solver,
    points.length,
    seconds.toFixed(2),
    flat.angleError.toExponential(3),
    flat.stretchL2.toFixed(3),
    flat.valid ? "yes" : "no",
    flat.termination,
  ]);
  for (const [at, cells] of [heads, ...rows].entries()) {
    const row = table.insertRow();
    for (const text of cells) {
      const cell = Object.assign(document.createElement(at === 0 ? "th" : "td"), { textContent: text });
      if (at === 0) cell.scope = "col";
      row.append(cell);
    }
  }
  return [svg, table];
}
