// The page in headless Chromium: every format dropped, a broken file, cancelling, picking, and what is downloaded judged by the program.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { WAIT, openPage } from "./browser.mjs";
import { ramp, sheet, torus } from "./shapes.mjs";

const faults = [];
let [page, folder, close] = [];

before(async () => ({ page, folder, close } = await openPage({ faults })));

after(async () => {
  await close?.();
  assert.deepEqual(faults, []);
});

const status = () => page.textContent("#status");
const cell = (name) => page.locator("#certificate tr", { hasText: new RegExp(`^${name}`) }).locator("td").textContent();

/** Drops a file onto the page, as a hand would. */
async function drop(name, bytes) {
  await page.evaluate(([name, base64]) => {
    // What is waited for has to be said anew.
    document.getElementById("status").textContent = "";
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([bytes], name));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
  }, [name, Buffer.from(bytes).toString("base64")]);
}

async function done(pattern = /charts? in [\d.]+ s/) {
  await page.waitForFunction((source) => new RegExp(source).test(document.getElementById("status").textContent), pattern.source, WAIT);
}

/** What the page saves with this ending. */
async function download(ending) {
  const [saved] = await Promise.all([page.waitForEvent("download"), page.click(`#save-${ending}`)]);
  const path = join(folder, saved.suggestedFilename());
  await saved.saveAs(path);
  return path;
}

/** What the program says of a file. */
function judged(file) {
  return JSON.parse(execFileSync(process.env.ABF_PROGRAM, ["metrics", file, "--json", "-"], { stdio: ["ignore", "pipe", "ignore"] })).results[0];
}

async function shot(name) {
  if (process.env.ABF_SHOTS) await page.screenshot({ path: join(process.env.ABF_SHOTS, `${name}.png`), fullPage: true });
}

function asObj({ positions, indices }) {
  const lines = [];
  for (let v = 0; v < positions.length; v += 3) lines.push(`v ${positions.slice(v, v + 3).join(" ")}`);
  for (let c = 0; c < indices.length; c += 3) lines.push(`f ${Array.from(indices.slice(c, c + 3), (v) => v + 1).join(" ")}`);
  return Buffer.from(lines.join("\n"));
}

function asPly({ positions, indices }) {
  const [vertices, faces] = [positions.length / 3, indices.length / 3];
  const head = `ply\nformat ascii 1.0\nelement vertex ${vertices}\nproperty float x\nproperty float y\nproperty float z\n` +
    `element face ${faces}\nproperty list uchar int vertex_indices\nend_header\n`;
  const rows = (values, lead) => Array.from({ length: values.length / 3 }, (_, at) => lead + values.slice(3 * at, 3 * at + 3).join(" "));
  return Buffer.from(head + [...rows(positions, ""), ...rows(indices, "3 ")].join("\n") + "\n");
}

function asStl({ positions, indices }) {
  const bytes = Buffer.alloc(84 + 50 * (indices.length / 3));
  bytes.writeUInt32LE(indices.length / 3, 80);
  indices.forEach((vertex, at) => {
    const from = 84 + 50 * Math.floor(at / 3) + 12 + 12 * (at % 3);
    for (let k = 0; k < 3; ++k) bytes.writeFloatLE(positions[3 * vertex + k], from + 4 * k);
  });
  return bytes;
}

function asGlb({ positions, indices }) {
  const parts = [Buffer.from(Float32Array.from(positions).buffer), Buffer.from(indices.buffer)];
  const length = parts[0].length + parts[1].length;
  const json = JSON.stringify({
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0, scale: [2, 2, 2] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: positions.length / 3, type: "VEC3", min: [-9, -9, -9], max: [9, 9, 9] },
      { bufferView: 1, componentType: 5125, count: indices.length, type: "SCALAR" }],
    bufferViews: [{ buffer: 0, byteLength: parts[0].length }, { buffer: 0, byteOffset: parts[0].length, byteLength: parts[1].length }],
    buffers: [{ byteLength: length }],
  });
  const text = Buffer.from(json.padEnd(Math.ceil(json.length / 4) * 4));
  const words = (...list) => Buffer.from(Uint32Array.from(list).buffer);
  return Buffer.concat([words(0x46546c67, 2, 28 + text.length + length, text.length, 0x4e4f534a), text, words(length, 0x004e4942), ...parts]);
}

const shape = torus(60, 24);

for (const [name, write] of [["torus.obj", asObj], ["torus.ply", asPly], ["torus.stl", asStl], ["torus.glb", asGlb]]) {
  test(`${name} is dropped, unwrapped and shown`, async () => {
    await drop(name, write(shape));
    await done();
    assert.equal(await cell("Valid"), "yes");
    assert.equal(await cell("Injective"), "yes");
    const drawn = await page.evaluate(() => ["model", "layout"].map((id) => {
      const copy = document.createElement("canvas");
      [copy.width, copy.height] = [64, 64];
      const context = copy.getContext("2d");
      context.drawImage(document.getElementById(id), 0, 0, 64, 64);
      return new Set(new Uint32Array(context.getImageData(0, 0, 64, 64).data.buffer)).size;
    }));
    assert.ok(drawn.every((colours) => colours > 20), `the views have ${drawn} colours`);
  });
}

test("the button unwraps with the settings as they come", async () => {
  await page.evaluate(() => (document.getElementById("status").textContent = ""));
  await page.click("#run");
  await done();
  assert.deepEqual(await page.evaluate(() => [...document.querySelectorAll("#settings :invalid")].map(({ id }) => id)), []);
});

test("colours, and a chart that is picked", async () => {
  for (const kind of ["angle", "area", "stretch", "chart"]) {
    await page.selectOption("#colours", kind);
    assert.equal(await page.isVisible("#legend"), kind !== "chart");
    await shot(`page-${kind}`);
  }
  const box = await page.locator("#model").boundingBox();
  for (const [x, y] of [[0.5, 0.5], [0.4, 0.6], [0.6, 0.6], [0.5, 0.7], [0.3, 0.5], [0.7, 0.5]]) {
    await page.mouse.click(box.x + box.width * x, box.y + box.height * y);
    if (/Chart \d+: \d+ triangles/.test(await page.textContent("#picked"))) break;
  }
  assert.match(await page.textContent("#picked"), /Chart \d+: \d+ triangles, largest stretch/);
  await page.selectOption("#colours", "checker");
});

test("what is downloaded is certified by the program", async () => {
  for (const ending of ["obj", "glb"]) {
    const result = judged(await download(ending));
    assert.ok(result.valid && result.injective, `${ending}: ${JSON.stringify(result).slice(0, 400)}`);
    assert.equal(result.triangles, shape.indices.length / 3);
  }
  const drawing = await download("svg");
  assert.match(readFileSync(drawing, "utf8"), /^<svg [^]*<path d="M[^]*<\/svg>\n$/);
  assert.ok(statSync(drawing).size > 1000);
});

test("what cannot be read is told, and what was there stays", async () => {
  const before = await page.textContent("#certificate");
  const wrong = [["broken.obj", "v 0 0\nf 1 2 3"], ["empty.obj", "# nothing"], ["far.obj", "v 0 0 0\nf 1 2 3"], ["broken.glb", "glTF?"], ["notes.txt", "no"], ["x.stl", ""]];
  for (const [name, text] of wrong) {
    await drop(name, text);
    await page.waitForFunction((name) => document.getElementById("status").textContent.includes(name), name, WAIT);
    assert.match(await page.getAttribute("#status", "class"), /bad/, name);
  }
  assert.equal(await page.textContent("#certificate"), before);
});

test("a disk is flattened as it is, and a mesh that is none is told what to do", async () => {
  await page.selectOption("#mode", "flatten");
  assert.equal(await page.isVisible("#resolution"), false);
  await drop("torus.obj", asObj(shape));
  await page.waitForFunction(() => /closed.*choose “an atlas”/.test(document.getElementById("status").textContent), null, WAIT);
  await drop("sheet.obj", asObj(sheet(30)));
  await done();
  assert.match(await cell("Angle error"), /e-/);
});

test("a map is relaxed to an energy, which the certificate tells", async () => {
  const plain = Number(await cell("L² stretch"));
  await page.selectOption("#energy", "isometric");
  await page.evaluate(() => (document.getElementById("status").textContent = ""));
  await page.click("#run");
  await done();
  assert.match(await cell("Energy before and after"), /^[\d.e+-]+, [\d.e+-]+ in \d+ steps$/);
  assert.ok(Number(await cell("L² stretch")) < plain);
  assert.equal(await cell("Certified"), "yes");
  await page.selectOption("#energy", "");
  assert.match(await page.textContent("#means-energy"), /symmetric Dirichlet/);
});

test("a map that lies over itself is parted or deformed", async () => {
  await drop("ramp.obj", asObj(ramp(1.3)));
  await done();
  assert.equal(await cell("Injective"), "no");
  for (const rule of ["split", "deform"]) {
    await page.selectOption("#injective", rule);
    await page.evaluate(() => (document.getElementById("status").textContent = ""));
    await page.click("#run");
    await done();
    assert.equal(await cell("Injective"), "yes");
    assert.ok(judged(await download("obj")).injective, rule);
  }
  await page.selectOption("#injective", "off");
  await drop("sheet.obj", asObj(sheet(30)));
  await done();
});

test("solvers stand side by side with their curves and their layouts", async () => {
  await page.click("#papers summary");
  await page.uncheck('#papers input[value="linabf"]');
  await page.uncheck('#papers input[value="barrier"]');
  assert.equal(await page.isDisabled("#compare"), true);
  await page.check('#papers input[value="linabf"]');
  await page.check('#papers input[value="barrier"]');
  await page.click("#compare");
  await done(/3 solvers on 1800 triangles/);
  assert.deepEqual(await page.locator("#curves td:first-child").allTextContents(), ["linabf", "abf++", "barrier"]);
  assert.deepEqual(await page.locator("#curves td:nth-child(6)").allTextContents(), ["yes", "yes", "yes"]);
  assert.equal(await page.locator("#curves polyline").count(), 3);
  const drawn = await page.evaluate(() => [...document.querySelectorAll(".layouts canvas")].map((canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.filter((value, at) => at % 4 === 3 && value > 0).length / (canvas.width * canvas.height);
  }));
  assert.ok(drawn.length === 3 && drawn.every((share) => share > 0.3), `the layouts cover ${drawn}`);
  await shot("page-compare");
});

test("Escape cancels at once, and the page goes on", async () => {
  await page.selectOption("#mode", "unwrap");
  await drop("large.obj", asObj(torus(500, 200)));
  await page.waitForFunction(() => !document.getElementById("cancel").disabled, null, WAIT);
  // The page answers while the worker works: frames come.
  const slowest = await page.evaluate(async () => {
    let [worst, last] = [0, performance.now()];
    for (let i = 0; i < 30; ++i) {
      await new Promise((next) => setTimeout(next, 20));
      [worst, last] = [Math.max(worst, performance.now() - last), performance.now()];
    }
    return worst;
  });
  assert.ok(slowest < 2000, `the page did not answer for ${slowest} ms`);
  await page.keyboard.press("Escape");
  await done(/Cancelled/);
  await page.selectOption("#sample", "hemisphere");
  await done(/^1 chart in/);
  assert.equal(await cell("Valid"), "yes");
});

test("keys, a narrow window and dark mode", async () => {
  await drop("sheet.obj", asObj(sheet(40)));
  await done();
  await page.focus("#model");
  const picture = () => page.evaluate(() => document.getElementById("model").toDataURL());
  const first = await picture();
  await page.keyboard.press("ArrowLeft");
  assert.notEqual(await picture(), first);
  await page.evaluate(() => (document.getElementById("status").textContent = ""));
  await page.keyboard.press("u");
  await done();
  await shot("page-light");
  await page.emulateMedia({ colorScheme: "dark" });
  await shot("page-dark");
  await page.setViewportSize({ width: 390, height: 844 });
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `the page is ${wide} pixels wide in a window of 390`);
  await shot("page-narrow");
  const unnamed = await page.evaluate(() => [...document.querySelectorAll("button, select, input, canvas, progress")]
    .filter((e) => !(e.getAttribute("aria-label") || e.textContent.trim() || e.labels?.length)).map((e) => e.id));
  assert.deepEqual(unnamed, []);
});
