// The page: files in, two views, files out. Everything that takes time runs in a worker.

import { AbfWorker } from "./abf/worker.js";
import { RANGES, chartColour, colour, distortion } from "./distortion.js";
import { bounds, edges, read, writeGlb, writeObj, writeSvg } from "./files.js";
import { curves, layouts } from "./curves.js";
import { View } from "./view.js";

const SOLVERS = ["auto", "linabf", "abf++", "abf-newton", "uzawa", "minres", "barrier", "descent", "habf++", "hlinabf", "lscm"];
/** Those with iterations, and the paper of each; the first three are compared unless others are chosen. */
const PAPERS = {
  linabf: "Zayer, Lévy, Seidel 2007",
  "abf++": "Sheffer, Lévy, Mogilnitsky, Bogomyakov 2005",
  barrier: "interior points",
  abf: "Sheffer, de Sturler 2001",
  "abf-newton": "Zayer, Rössl, Seidel 2005",
  uzawa: "Zayer, Rössl, Seidel 2004",
  minres: "the same, by MINRES",
};
const [FEWEST, MOST] = [2, 4];
const SAMPLES = { mask: "mask", hemisphere: "hemisphere", "wavy-saddle": "wavy saddle", cyclide: "ring cyclide", "letter-x": "letter X" };

const $ = (id) => document.getElementById(id);
const worker = new AbfWorker(new URL("./abf/abf.wasm", import.meta.url));
let mesh;
let result;
let quality;
let picked;

const views = [
  new View($("model"), { flat: false, pick }),
  new View($("layout"), { flat: true, pick }),
];

function say(text, bad = false) {
  $("status").textContent = text;
  $("status").classList.toggle("bad", bad);
}

function enable() {
  const busy = worker.busy;
  $("run").disabled = busy || !mesh;
  const count = chosen().length;
  $("compare").disabled = busy || !mesh || count < FEWEST || count > MOST;
  $("cancel").disabled = !busy;
  for (const id of ["save-glb", "save-obj", "save-svg"]) $(id).disabled = busy || !result;
  document.body.setAttribute("aria-busy", String(busy));
}

/** Takes a file. What was there stays when it cannot be read. */
async function open(name, buffer) {
  if (worker.busy) worker.cancel();
  try {
    const next = await read(name, buffer);
    [mesh, result, quality, picked] = [next, undefined, undefined, undefined];
    if (name !== `${$("sample").value}.obj`) $("sample").value = "";
    for (const id of ["certificate", "curves"]) $(id).hidden = true;
    views[0].show({ points: corners(mesh.positions, mesh.indices, 3) });
    views[1].clear();
    $("picked").textContent = "";
    say(`${name}: ${mesh.positions.length / 3} vertices, ${mesh.indices.length / 3} triangles`);
    enable();
    await run();
  } catch (error) {
    say(error.message, true);
    enable();
  }
}

function settings() {
  const options = { solver: $("solver").value };
  if ($("energy").value) options.energy = $("energy").value;
  const seconds = Number($("seconds").value);
  if (seconds > 0) options.timeLimit = seconds;
  if ($("mode").value === "unwrap") {
    Object.assign(options, { resolution: Number($("resolution").value), margin: Number($("margin").value) });
    options.maxStretch = Number($("stretch").value);
    const coverage = Number($("coverage").value);
    if (coverage > 0) options.coverage = coverage / 100;
  } else {
    if ($("boundary").value !== "free") options.boundary = $("boundary").value;
    options.injective = $("injective").value;
  }
  return options;
}

async function run() {
  if (!mesh || worker.busy) return;
  const mode = $("mode").value;
  const began = performance.now();
  const positions = mode === "unwrap" ? Float32Array.from(mesh.positions) : mesh.positions;
  const job = worker[mode](positions, mesh.indices, { ...settings(), onProgress: progress });
  $("progress").removeAttribute("value");
  say(mode === "unwrap" ? "Unwrapping…" : "Flattening…");
  enable();
  try {
    result = await job;
    result.seconds = (performance.now() - began) / 1000;
    show();
    say(`${result.chartCount} ${result.chartCount === 1 ? "chart" : "charts"} in ${result.seconds.toFixed(2)} s`);
  } catch (error) {
    const hint = error.code === "not-a-disk" || error.code === "topology" ? "; choose “an atlas”, which takes any mesh" : "";
    say(error.code === "cancelled" ? "Cancelled. The model and the last result are still there." : error.message + hint, error.code !== "cancelled");
  } finally {
    $("progress").value = 0;
    enable();
  }
}

function progress(event) {
  if (event.faces > 0) {
    $("progress").value = event.facesDone / event.faces;
    const of = event.components > 1 ? `component ${event.component + 1} of ${event.components}, ` : "";
    say(`Unwrapping: ${of}round ${event.round + 1}, ${event.facesDone} of ${event.faces} triangles done`);
  } else if (event.kind === "iteration") {
    const residual = event.stage !== "relax" && Number.isFinite(event.residual) ? `: residual ${event.residual.toExponential(1)}` : "";
    say(`${event.stage === "relax" ? "Relaxing, step" : "Iteration"} ${event.iteration}${residual}`);
  }
}

/** Three values in a row per corner. */
function corners(values, indices, size) {
  const out = new Float32Array(size * indices.length);
  indices.forEach((index, at) => {
    for (let k = 0; k < size; ++k) out[size * at + k] = values[size * index + k];
  });
  return out;
}

function show() {
  const uv = result.uvs ?? result.uv;
  const indices = result.indices ?? mesh.indices;
  const page = result.uvs ? [result.width, result.height] : [1, 1];
  quality = distortion(mesh, result, page);
  const { low, high } = bounds(uv);
  const size = result.uvs ? 1 : Math.max(high[0] - low[0], high[1] - low[1]) || 1;
  const flat = corners(uv, indices, 2);
  const uvs = flat.map((x, at) => (x - (result.uvs ? 0 : low[at % 2])) / size);
  const plane = new Float32Array((3 * flat.length) / 2);
  for (let c = 0; c < flat.length / 2; ++c) plane.set([flat[2 * c] * page[0], flat[2 * c + 1] * page[1]], 3 * c);
  const { border, corner } = edges(indices, uv);
  const seams = [new Float32Array(6 * border.length), new Float32Array(6 * border.length)];
  border.forEach(([a, b], at) => {
    const place = corner[at];
    const ends = [mesh.indices[place], mesh.indices[place % 3 === 2 ? place - 2 : place + 1]];
    ends.forEach((v, end) => seams[0].set(mesh.positions.subarray(3 * v, 3 * v + 3), 6 * at + 3 * end));
    [a, b].forEach((v, end) => seams[1].set([uv[2 * v] * page[0], uv[2 * v + 1] * page[1], 0.01], 6 * at + 3 * end));
  });
  views[0].show({ points: corners(mesh.positions, mesh.indices, 3), uvs, seams: seams[0] });
  views[1].show({ points: plane, uvs, seams: seams[1] });
  picked = undefined;
  paint();
  certificate();
}

function paint() {
  if (!result) return;
  const kind = $("colours").value;
  const charts = result.triangleCharts;
  const count = mesh.indices.length / 3;
  const colours = new Float32Array(9 * count);
  for (let f = 0; f < count; ++f) {
    let [r, g, b] = [1, 1, 1];
    if (kind === "chart") [r, g, b] = chartColour(charts ? charts[f] : 0);
    else if (kind !== "checker") [r, g, b] = colour(kind, quality[kind][f]);
    if (picked !== undefined && charts && charts[f] !== picked) [r, g, b] = [r, g, b].map((x) => 0.35 * x + 0.35);
    for (let k = 0; k < 3; ++k) colours.set([r, g, b], 9 * f + 3 * k);
  }
  views.forEach((view) => view.paint(colours, kind !== "checker"));
  const range = RANGES[kind];
  $("legend").hidden = !range;
  if (!range) return;
  const stops = Array.from({ length: 9 }, (_, k) => range[0] * (range[1] / range[0]) ** (k / 8));
  const css = stops.map((value) => `rgb(${colour(kind, value).map((x) => Math.round(255 * x)).join(" ")})`);
  $("scale").style.background = `linear-gradient(to right, ${css.join(", ")})`;
  $("low").textContent = range[0];
  $("high").textContent = `${range[1]} or more`;
}

function pick(triangle) {
  const charts = result?.triangleCharts;
  const chart = triangle === undefined || !charts ? undefined : charts[triangle];
  picked = chart === picked ? undefined : chart;
  let text = "";
  if (picked !== undefined) {
    let [count, worst] = [0, 1];
    charts.forEach((own, f) => {
      if (own !== picked) return;
      count += 1;
      if (quality.stretch[f] > worst) worst = quality.stretch[f];
    });
    text = `Chart ${picked + 1}: ${count} triangles, largest stretch ${worst.toFixed(2)}`;
  }
  $("picked").textContent = text;
  paint();
}

function certificate() {
  const yes = (fact) => ({ text: fact ? "yes" : "no", mood: fact ? "good" : "bad" });
  const number = (x, digits = 4) => ({ text: Number.isFinite(x) ? x.toPrecision(digits) : "infinite" });
  const rows = [
    ["Valid: nothing flipped, collapsed or wound twice", yes(result.valid)],
    ["Injective: nothing overlaps", yes(result.injective)],
    ["Certified: valid, and the solver ended as asked", yes(result.certified)],
    ["Flipped, collapsed, wound, overlaps", { text: [result.flips, result.collapsed, result.wound, result.overlaps].join(", ") }],
    ["Angle error F / 3nt, rad²", { text: result.angleError.toExponential(6) }],
    ["L² stretch", number(result.stretchL2)],
    ["Quasi-conformal distortion, mean and largest", { text: `${result.qcMean.toPrecision(4)}, ${result.qcMax.toPrecision(4)}` }],
    ...(result.relaxSteps > 0
      ? [["Energy before and after", { text: `${result.energyBefore.toPrecision(4)}, ${result.energyAfter.toPrecision(4)} in ${result.relaxSteps} steps` }]]
      : []),
    ["Solver, and how it ended", { text: `${result.solver}, ${result.termination}` }],
  ];
  if (result.uvs) {
    rows.push(["Charts, pages", { text: `${result.chartCount}, ${result.pageCount}` }], ["Covered", { text: `${(100 * result.coverage).toFixed(1)} %` }]);
    rows.push(["Repaired", { text: result.repairs || "nothing" }]);
  }
  const body = $("certificate").querySelector("tbody");
  body.replaceChildren(...rows.map(([name, { text, mood }]) => {
    const row = document.createElement("tr");
    const head = Object.assign(document.createElement("th"), { scope: "row", textContent: name });
    const cell = Object.assign(document.createElement("td"), { textContent: text, className: mood ?? "" });
    row.append(head, cell);
    return row;
  }));
  $("certificate").hidden = false;
}

/** The solvers that are to be compared. */
function chosen() {
  return [...document.querySelectorAll("#papers input:checked")].map(({ value }) => value);
}

/** Flattens the same disk with several solvers, one after the other, and draws how they converge. */
async function compare() {
  if (!mesh || worker.busy) return;
  const runs = [];
  const failed = [];
  try {
    for (const solver of chosen()) {
      const points = [];
      const began = performance.now();
      const hear = (event) => {
        if (event.kind === "iteration" && Number.isFinite(event.residual)) points.push([event.iteration, event.residual]);
        say(`${solver}: iteration ${event.iteration}`);
      };
      const job = worker.flatten(mesh.positions, mesh.indices, { solver, onProgress: hear });
      enable();
      try {
        const flat = await job;
        runs.push({ solver, points, flat, seconds: (performance.now() - began) / 1000 });
      } catch (error) {
        if (error.code === "not-a-disk") throw error;
        failed.push(error.code === "cancelled" ? "Cancelled." : `${solver}: ${error.message}`);
        if (error.code === "cancelled") break;
      }
    }
    // What is finished is shown.
    if (runs.length > 0) {
      $("curves").querySelector("div").replaceChildren(...curves(runs), layouts(mesh, runs));
      $("curves").hidden = false;
    }
    const done = `${runs.length} solvers on ${mesh.indices.length / 3} triangles`;
    const cancelledAtOnce = runs.length === 0 && failed.length === 1 && failed[0] === "Cancelled.";
    say([...(runs.length > 0 ? [done] : []), ...failed].join("; "), failed.length > 0 && !cancelledAtOnce);
  } catch (error) {
    say(error.message + (error.code === "not-a-disk" ? ": only disks are compared" : ""), true);
  } finally {
    enable();
  }
}

function save(ending, writer) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(writer(mesh, result));
  link.download = `${mesh.name}-uv.${ending}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

Object.entries(PAPERS).forEach(([solver, paper], at) => {
  const box = Object.assign(document.createElement("input"), { type: "checkbox", value: solver, checked: at < 3 });
  const label = document.createElement("label");
  label.append(box, `${solver} (${paper})`);
  box.addEventListener("change", enable);
  document.querySelector("#papers fieldset").append(label);
});
// What a pointer sees when it rests on a setting is there for everyone.
for (const label of document.querySelectorAll("#settings label[title]")) {
  const name = label.firstChild.textContent.trim();
  const meaning = Object.assign(document.createElement("dd"), { textContent: label.title, id: `means-${label.control.id}` });
  document.querySelector("#help dl").append(Object.assign(document.createElement("dt"), { textContent: name }), meaning);
  label.control.setAttribute("aria-describedby", meaning.id);
}
$("solver").append(...SOLVERS.map((name) => new Option(name)));
$("sample").append(...Object.entries(SAMPLES).map(([file, name]) => new Option(name, file)));
$("settings").addEventListener("submit", (event) => {
  event.preventDefault();
  run();
});
$("mode").addEventListener("change", () => {
  const isAtlas = $("mode").value === "unwrap";
  for (const label of document.querySelectorAll(".of-unwrap, .of-flatten")) {
    label.hidden = label.classList.contains("of-unwrap") !== isAtlas;
    // What nobody sees is not checked either.
    label.control.disabled = label.hidden;
  }
  $("run").textContent = isAtlas ? "Unwrap" : "Flatten";
});
$("cancel").addEventListener("click", () => worker.cancel());
$("compare").addEventListener("click", compare);
$("colours").addEventListener("change", paint);
$("file").addEventListener("change", async ({ target }) => {
  const [file] = target.files;
  target.value = "";
  if (file) await open(file.name, await file.arrayBuffer());
});
$("sample").addEventListener("change", async ({ target }) => {
  if (!target.value) return;
  const name = `${target.value}.obj`;
  const response = await fetch(`samples/${name}`);
  if (response.ok) await open(name, await response.arrayBuffer());
  else say(`${name} cannot be loaded: ${response.status}`, true);
});
for (const [ending, writer] of [["glb", writeGlb], ["obj", writeObj], ["svg", writeSvg]]) {
  $(`save-${ending}`).addEventListener("click", () => save(ending, writer));
}
addEventListener("dragover", (event) => {
  event.preventDefault();
  document.body.classList.add("dropping");
});
addEventListener("dragleave", () => document.body.classList.remove("dropping"));
addEventListener("drop", async (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  const [file] = event.dataTransfer.files;
  if (file) await open(file.name, await file.arrayBuffer());
});
addEventListener("keydown", (event) => {
  const isTyping = /^(input|select|textarea)$/i.test(event.target.tagName);
  if (event.key === "Escape") worker.cancel();
  if (isTyping || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "o") $("file").click();
  if (event.key === "u") run();
});
say("Drop a model, open one, or choose a sample.");
document.documentElement.dataset.ready = "yes";
