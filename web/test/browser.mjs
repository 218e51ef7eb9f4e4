// The built page in headless Chromium, served from this machine.
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { extname, join, normalize } from "node:path";

const { chromium } = createRequire(join(process.env.ABF_PACKAGES, "package.json"))("playwright-core");
const root = new URL("../app/dist/", import.meta.url).pathname;
const TYPES = {
  ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".obj": "text/plain", ".txt": "text/plain",
};
export const WAIT = { timeout: 120_000 };

/** Opens the page. `files` are further files by their addresses. `faults` gets what goes wrong in it. */
export async function openPage({ files = {}, faults = [] } = {}) {
  const folder = mkdtempSync(join(tmpdir(), "check-web-"));
  const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname));
    try {
      const content = readFileSync(files[path] ?? join(root, path === "/" ? "index.html" : path));
      response.writeHead(200, { "content-type": path === "/" ? "text/html" : (TYPES[extname(path)] ?? "application/octet-stream") });
      response.end(content);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  const here = `http://127.0.0.1:${server.address().port}`;
  const context = await chromium.launchPersistentContext(join(folder, "profile"), {
    executablePath: process.env.ABF_BROWSER,
    headless: true,
    viewport: { width: 1280, height: 900 },
    args: ["--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
      "--disable-quic", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
  const page = await context.newPage();
  page.on("console", (message) => { if (message.type() === "error") faults.push(`console: ${message.text()}`); });
  page.on("pageerror", (error) => faults.push(`page: ${error}`));
  page.on("request", (request) => {
    if (!/^(blob|data):/.test(request.url()) && !request.url().startsWith(here)) faults.push(`loaded from elsewhere: ${request.url()}`);
  });
  await page.goto(`${here}/`);
  await page.waitForFunction('document.documentElement.dataset.ready === "yes"', null, WAIT);
  const close = async () => {
    await context.close();
    server.close();
    rmSync(folder, { recursive: true, force: true });
  };
  return { page, folder, close };
}
