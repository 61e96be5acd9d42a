// Opens the built page in Chromium: `node test.mjs [--keep DIR]`. CHROMIUM says where it is, Debian's by default; NATIVE
// is the program `native` if it is built already.
//
// The page loads, a slider moves and the picture changes, work is cancelled, a file is saved and is sound, the address has all, a
// phone's width has no sideways scrolling, each control has a label, and the same seed gives the same bytes as natively.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import validator from "gltf-validator";
import { chromium } from "playwright-core";
import { serve } from "./run.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const keep = process.argv.indexOf("--keep");
const out = keep > 0 ? process.argv[keep + 1] : mkdtempSync(join(tmpdir(), "treesynth-"));
mkdirSync(out, { recursive: true });
const sum = (bytes) => createHash("sha256").update(bytes).digest("hex");

let passed = 0;
const test = async (name, body) => {
  await body();
  passed += 1;
  console.log(`ok ${name}`);
};

const server = await serve(0);
const address = `http://127.0.0.1:${server.address().port}/`;
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});

const errors = [];
const open = async (hash = "", options = {}) => {
  const page = await browser.newPage({ viewport: { width: 1200, height: 800 }, acceptDownloads: true, ...options });
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  await page.goto(address + hash);
  return page;
};
const whole = (page) => page.waitForSelector('body[data-state="whole"]', { timeout: 120_000 });
const picture = (page) => page.locator("#canvas").screenshot();
const slide = (page, id, value) =>
  page.locator(`#${id}`).evaluate((input, value) => {
    input.value = value;
    input.dispatchEvent(new Event("input", { bubbles: true }));
  }, String(value));
const save = async (page, format) => {
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(`[data-format="${format}"]`)]);
  const path = join(out, download.suggestedFilename());
  await download.saveAs(path);
  return path;
};

try {
  const hash = "#tree=silver+birch&seed=3&height=6&budget=4&textures=128&wind=0";
  const page = await open(hash);
  await whole(page);

  await test("the page shows a tree", async () => {
    const said = await page.textContent("#status");
    assert.match(said, /^silver birch: 6\.0 m tall, .* leaves, [\d,]+ triangles, \d+ ms$/);
    await page.screenshot({ path: join(out, "desktop.png") });
    assert.equal(await page.locator("#tree option").count() > 40, true);
  });

  await test("each setting has a name", async () => {
    const nameless = await page.evaluate(() =>
      [...document.querySelectorAll("input, select, button, canvas, progress")]
        .filter((control) => !(control.labels?.length || control.ariaLabel || control.textContent.trim()))
        .map((control) => control.id || control.outerHTML));
    assert.deepEqual(nameless, []);
  });

  await test("a slider changes the picture, first by a preview", async () => {
    const before = await picture(page);
    const states = await page.evaluate(() => {
      window.states = [];
      new MutationObserver(() => window.states.push([document.body.dataset.state, Number(document.body.dataset.milliseconds)]))
        .observe(document.body, { attributes: true, attributeFilter: ["data-state"] });
    });
    assert.equal(states, undefined);
    await slide(page, "day", 288);
    await page.waitForFunction(() => document.body.dataset.state === "whole" && window.states.length > 1, null, { timeout: 120_000 });
    const seen = await page.evaluate(() => window.states);
    assert.ok(seen.some(([state]) => state === "preview"), JSON.stringify(seen));
    console.log(`   from slider to picture: preview ${seen.find(([state]) => state === "preview")[1]} ms, whole ${seen.at(-1)[1]} ms`);
    assert.notEqual(sum(before), sum(await picture(page)));
    assert.match(page.url(), /day=288/);
  });

  await test("arrow keys turn the tree", async () => {
    const before = await picture(page);
    await page.focus("#canvas");
    for (let i = 0; i < 5; i += 1) await page.keyboard.press("ArrowRight");
    await page.waitForTimeout(300);
    assert.notEqual(sum(before), sum(await picture(page)));
  });

  await test("the saved file is sound, and that of the native build", async () => {
    const path = await save(page, "glb");
    const saved = readFileSync(path);
    const { issues } = await validator.validateBytes(new Uint8Array(saved));
    assert.equal(issues.numErrors + issues.numWarnings, 0, JSON.stringify(issues.messages.slice(0, 3)));
    const ask = await page.evaluate(() => document.body.dataset.tree);
    const native = join(out, "native.glb");
    const [program, ...args] = process.env.NATIVE
      ? [process.env.NATIVE]
      : ["cargo", "run", "--profile", "native", "--locked", "--quiet", "--bin", "native", "--"];
    execFileSync(program, [...args, ask, native], { cwd: here, stdio: "inherit" });
    assert.equal(sum(saved), sum(readFileSync(native)));
  });

  await test("skeleton, USD and picture are saved", async () => {
    assert.ok(JSON.parse(readFileSync(await save(page, "json"))).positions.length > 100);
    assert.equal(readFileSync(await save(page, "usdz")).subarray(0, 2).toString(), "PK");
    assert.equal(readFileSync(await save(page, "png")).subarray(1, 4).toString(), "PNG");
  });

  await test("the address alone brings the tree back", async () => {
    const other = await open(new URL(page.url()).hash);
    await whole(other);
    for (const id of ["tree", "seed", "day", "height", "budget"]) {
      assert.equal(await other.inputValue(`#${id}`), await page.inputValue(`#${id}`), id);
    }
    const [one, two] = await Promise.all([page, other].map((page) => page.evaluate(() => document.body.dataset.tree)));
    assert.equal(one, two);
    await other.close();
  });

  await test("an address that is wrong does no harm", async () => {
    const other = await open("#tree=no+such+tree&seed=-5&height=NaN&day=999&budget=x&textures=7&<script>");
    await whole(other);
    await other.close();
  });

  await test("what a species cannot meet is said", async () => {
    const other = await open("#tree=silver+birch&seed=1&height=20&dbh=0.02&budget=3.5&textures=128");
    await other.waitForSelector('body[data-state="error"]', { timeout: 60_000 });
    assert.match(await other.textContent("#status"), /must be/);
    // And another tree grows after it.
    await other.locator("#height-on").uncheck();
    await whole(other);
    await other.close();
  });

  await test("work is cancelled, and the next tree grows", async () => {
    const other = await open("#tree=beech&seed=1&age=150&budget=5&textures=1024");
    await other.locator("#cancel").click({ timeout: 60_000 });
    assert.equal(await other.textContent("#status"), "Cancelled");
    await other.selectOption("#tree", "hazel");
    await whole(other);
    assert.match(await other.textContent("#status"), /^hazel/);
    await other.close();
  });

  await test("the wind moves it", async () => {
    const other = await open("#tree=hazel&seed=1&budget=3.7&textures=128&wind=0.8");
    await whole(other);
    const before = await picture(other);
    await other.waitForTimeout(700);
    assert.notEqual(sum(before), sum(await picture(other)));
    await other.close();
  });

  await test("a preset grows by least-cost paths", async () => {
    const other = await open("#tree=figure-17a&seed=1&nodes=20000&budget=4&textures=128");
    await whole(other);
    console.log(`   20,000 nodes: ${await other.evaluate(() => document.body.dataset.grown)} ms of synthesis`);
    await other.close();
  });

  for (const scheme of ["light", "dark"]) {
    await test(`a phone's width, ${scheme}`, async () => {
      const other = await open(hash, { viewport: { width: 360, height: 740 }, colorScheme: scheme, isMobile: true, hasTouch: true });
      await whole(other);
      const width = await other.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(width <= 360, `${width} pixels wide`);
      await other.screenshot({ path: join(out, `phone-${scheme}.png`) });
      await other.close();
    });
  }
  await test("no error on the console", async () => assert.deepEqual(errors, []));
  console.log(`${passed} passed, 0 failed`);
} finally {
  await browser.close();
  server.close();
  if (keep < 0) rmSync(out, { recursive: true, force: true });
}
