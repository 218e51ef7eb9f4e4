// How solvers converge: residuals per iteration on a logarithmic scale, and a table.

const SVG = "http://www.w3.org/2000/svg";
const COLOURS = ["#1c6e8c", "#c2410c", "#5b8c2a"];
const [WIDTH, HEIGHT, LEFT, BELOW] = [640, 260, 52, 28];

function element(name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
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
    const path = points.map(([iteration, residual]) => `${x(iteration).toFixed(1)},${y(residual).toFixed(1)}`).join(" ");
    svg.append(element("polyline", { points: path, fill: "none", stroke, "stroke-width": 2 }));
    for (const [iteration, residual] of points) svg.append(element("circle", { cx: x(iteration), cy: y(residual), r: 3, fill: stroke }));
    svg.append(element("text", { x: LEFT + 8 + 90 * at, y: HEIGHT - 6, "font-size": 12, fill: stroke }, solver));
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
    for (const text of cells) row.append(Object.assign(document.createElement(at === 0 ? "th" : "td"), { textContent: text }));
  }
  return [svg, table];
}
