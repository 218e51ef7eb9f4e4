// Times of the page beside the program: node time.mjs MESH [RUNS [RESULTS]]. Run by scripts/time-web.
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import { basename } from "node:path";
import { openPage } from "./browser.mjs";

const [mesh, runs = "7", results = "100"] = process.argv.slice(2);
const TICKS = Number(execFileSync("getconf", ["CLK_TCK"]));
const AIM = 1.15;

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** The CPU seconds of a process and all that it has started, so far: of those that live. */
function cpu(pid) {
  const stats = readdirSync("/proc").filter((name) => /^\d+$/.test(name)).flatMap((name) => {
    try {
      const fields = readFileSync(`/proc/${name}/stat`, "utf8").replace(/^.*\) /, "").split(" ");
      return [{ pid: Number(name), parent: Number(fields[1]), seconds: (Number(fields[11]) + Number(fields[12])) / TICKS }];
    } catch {
      return [];
    }
  });
  const family = new Set([pid]);
  for (let before = 0; before < family.size; ) {
    before = family.size;
    for (const { pid, parent } of stats) if (family.has(parent)) family.add(pid);
  }
  family.delete(pid);
  return stats.filter(({ pid }) => family.has(pid)).reduce((sum, { seconds }) => sum + seconds, 0);
}

/** A run of the program on one thread: its CPU seconds, and what it says. */
function native(...options) {
  const script = 'TIMEFORMAT="%U %S"; { time "$0" "$@" --threads 1 --json - 2>/dev/null >&3; } 3>&1';
  const command = ["-c", `exec 2>&1; ${script}`, process.env.ABF_PROGRAM, mesh, ...options];
  const said = execFileSync("bash", command, { maxBuffer: 1 << 29, encoding: "utf8" }).trimEnd();
  const at = said.lastIndexOf("\n");
  const seconds = said.slice(at + 1).split(" ").map(Number).reduce((a, b) => a + b);
  return { seconds, result: JSON.parse(said.slice(0, at)) };
}

const faults = [];
const { page, close } = await openPage({ faults, files: { "/mesh.obj": mesh } });
await page.evaluate(async () => {
  const { AbfWorker } = await import("./abf/worker.js");
  const { read } = await import("./files.js");
  const { positions, indices } = await read("mesh.obj", await (await fetch("/mesh.obj")).arrayBuffer());
  const worker = new AbfWorker(new URL("./abf/abf.wasm", location.href));
  // Looks every 10 ms whether the page answers.
  let [last, slowest] = [performance.now(), 0];
  setInterval(() => {
    const now = performance.now();
    [last, slowest] = [now, Math.max(slowest, now - last)];
  }, 10);
  window.timed = async (method) => {
    slowest = 0;
    const began = performance.now();
    const result = await worker[method](method === "unwrap" ? Float32Array.from(positions) : positions, indices, {});
    const { angleError, stretchL2, chartCount, certified, memoryBytes } = result;
    return { wall: (performance.now() - began) / 1000, slowest, angleError, stretchL2, chartCount, certified, memoryBytes };
  };
});

async function inPage(method) {
  const before = cpu(process.pid);
  const said = await page.evaluate((method) => window.timed(method), method);
  return { ...said, seconds: cpu(process.pid) - before };
}

// Arrays are joined where vertices lie in one place. A file that is one disk is not, unless that is said.
const ATLAS = ["--cut-disks", "--atlas", "one", "--pack", "fast", "--weld", "0"];
const rows = [];
let memory = 0;
for (const [method, options] of [["flatten", ["--solver", "auto"]], ["unwrap", ATLAS]]) {
  const [web, program] = [[], []];
  let [here, there] = [];
  // The first one compiles.
  await inPage(method);
  for (let run = 0; run < Number(runs); ++run) {
    here = await inPage(method);
    there = native(...options);
    web.push(here.seconds);
    program.push(there.seconds);
  }
  const said = there.result.results[0];
  memory = Math.max(memory, here.memoryBytes);
  rows.push({ method, web: median(web), program: median(program), ratio: median(web.map((x, at) => x / program[at])), here, said });
}
console.log(`${basename(mesh)}, ${rows[0].said.triangles} triangles, median of ${runs}, CPU seconds, the program on one thread\n`);
console.log("| call | page | program | page / program | wall | page silent for at most | charts | of the program |");
console.log("| --- | --- | --- | --- | --- | --- | --- | --- |");
for (const { method, web, program, ratio, here, said } of rows) {
  const cells = [method, web.toFixed(2), program.toFixed(2), ratio.toFixed(2), `${here.wall.toFixed(2)} s`, `${here.slowest.toFixed(0)} ms`, here.chartCount, said.charts];
  console.log(`| ${cells.join(" | ")} |`);
}
const [flat, atlas] = rows;
const difference = Math.abs(flat.here.angleError / flat.said.f - 1);
console.log(`\nF of flatten: ${flat.here.angleError} in the page, ${flat.said.f} by the program: ${difference.toExponential(1)} apart`);
console.log(`L² stretch of unwrap: ${atlas.here.stretchL2.toFixed(4)}, certified: ${atlas.here.certified}`);
const first = await page.evaluate(() => window.timed("flatten"));
for (let at = 1; at < Number(results); ++at) memory = (await page.evaluate(() => window.timed("flatten"))).memoryBytes;
console.log(`${results} results in a row: ${(first.memoryBytes / 1e6).toFixed(0)} MB after the first, ${(memory / 1e6).toFixed(0)} MB after the last`);
await close();
const { charts } = atlas.said;
const wrong = [
  ...faults,
  difference < 1e-7 ? [] : "F differs within seven digits",
  atlas.here.stretchL2 <= AIM && atlas.here.certified ? [] : "the atlas misses its aim",
  Math.abs(atlas.here.chartCount - charts) <= 0.1 * charts ? [] : "the charts are not as many",
  memory <= first.memoryBytes ? [] : "the memory grows",
].flat();
wrong.forEach((text) => console.error(text));
process.exit(wrong.length === 0 ? 0 : 1);
