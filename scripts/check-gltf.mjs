// The part of scripts/check-gltf that runs in Node: CACHE (where the packages are), FOLDER (list.json, before/, after/),
// and the path of a Chromium, which may be empty.
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { extname, join, normalize } from "node:path";

const [cache, folder, browser] = process.argv.slice(2);
const require = createRequire(join(cache, "package.json"));
const documents = JSON.parse(readFileSync(join(folder, "list.json"), "utf8"));
const faults = [];

/// Errors and warnings of the validator, by code, and how often each is found.
async function issues(path) {
  const validator = require("gltf-validator");
  const near = (uri) => new Uint8Array(readFileSync(join(path, "..", decodeURIComponent(uri))));
  const report = await validator.validateBytes(new Uint8Array(readFileSync(path)), {
    uri: path,
    maxIssues: 0,
    externalResourceFunction: (uri) => Promise.resolve(near(uri)),
  });
  const counts = { 0: {}, 1: {} };
  for (const { severity, code, pointer, message } of report.issues.messages) {
    if (severity > 1) continue;
    (counts[severity][code] ??= []).push(`${pointer}: ${message}`);
  }
  return counts;
}

const before = {};
let old = 0;
for (const { file, before: name } of documents) {
  before[name] ??= await issues(join(folder, "before", name));
  const after = await issues(join(folder, "after", file));
  for (const [severity, what] of [[0, "error"], [1, "warning"]]) {
    for (const [code, list] of Object.entries(after[severity])) {
      const known = before[name][severity][code]?.length ?? 0;
      if (list.length > known) faults.push(`${file}: new ${what} ${code}: ${list.join("; ")}`);
      else old += list.length;
    }
  }
}
const originals = Object.keys(before).length;
console.log(`validator: ${documents.length} documents made from ${originals}, ${faults.length} new issues, ${old} old ones`);
for (const [name, { 0: errors }] of Object.entries(before)) {
  for (const [code, list] of Object.entries(errors)) console.log(`  ${name} had ${code} before: ${list[0]}`);
}

const PAGE = `<!doctype html><script type="importmap">{"imports": {
  "three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"}}</script>
<script type="module">
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
window.describe = async (url) => {
  const { scene } = await new GLTFLoader().loadAsync(url);
  const found = new Map();
  scene.traverse((node) => {
    if (!node.isMesh) return;
    const { attributes, index, uuid } = node.geometry;
    const uvs = {};
    for (const [set, name] of ["uv", "uv1", "uv2", "uv3"].entries()) {
      const uv = attributes[name];
      if (uv) uvs[set] = { count: uv.count, finite: [...uv.array].every(Number.isFinite) };
    }
    found.set(uuid, { vertices: attributes.position.count, corners: (index ?? attributes.position).count, uvs });
  });
  return [...found.values()];
};
window.ready = true;
</script>`;
const TYPES = { ".js": "text/javascript", ".html": "text/html", ".gltf": "model/gltf+json", ".glb": "model/gltf-binary" };

function serve(request, response) {
  const path = normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname));
  try {
    let content = PAGE;
    if (path.startsWith("/three/")) content = readFileSync(join(cache, "node_modules", path));
    else if (path.startsWith("/after/") || path.startsWith("/before/")) content = readFileSync(join(folder, path));
    else if (path !== "/") throw new Error("nothing there");
    response.writeHead(200, { "content-type": path === "/" ? "text/html" : (TYPES[extname(path)] ?? "application/octet-stream") });
    response.end(content);
  } catch {
    response.writeHead(404).end();
  }
}

async function inBrowser() {
  const { chromium } = require("playwright-core");
  const server = createServer(serve);
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  const profile = mkdtempSync(join(tmpdir(), "check-gltf-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: browser,
    headless: true,
    args: ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
      "--disable-component-update", "--disable-sync", "--disable-quic"],
  });
  try {
    const page = await context.newPage();
    page.on("console", (message) => { if (message.type() === "error" && !message.text().includes("404")) faults.push(`console: ${message.text()}`); });
    page.on("pageerror", (error) => faults.push(`page: ${error}`));
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    await page.waitForFunction("window.ready", null, { timeout: 30_000 });
    for (const { file, set, vertices, corners } of documents) {
      const found = await page.evaluate((url) => window.describe(url), `/after/${encodeURIComponent(file)}`);
      const expect = (fact, text) => { if (!fact) faults.push(`${file} in three.js: ${text}: ${JSON.stringify(found)}`); };
      const sorted = (list) => JSON.stringify([...list].sort((a, b) => a - b));
      expect(sorted(found.map((mesh) => mesh.vertices)) === sorted(vertices), `vertices are not ${vertices}`);
      expect(found.reduce((sum, mesh) => sum + mesh.corners, 0) >= corners, `fewer corners than ${corners}`);
      for (const mesh of found) {
        expect(mesh.uvs[set]?.count === mesh.vertices && mesh.uvs[set].finite, `no UVs in set ${set}`);
      }
    }
    console.log(`three.js: ${documents.length} documents opened`);
  } finally {
    await context.close();
    server.close();
    rmSync(profile, { recursive: true, force: true });
  }
}

if (browser) await inBrowser();
else console.log("there is no chromium on the PATH: three.js is left out");
for (const fault of faults.slice(0, 30)) console.log(`  ${fault}`);
process.exit(faults.length === 0 ? 0 : 1);
