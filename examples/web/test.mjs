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
import { unzipSync } from "three/examples/jsm/libs/fflate.module.js";
import { LAUNCH } from "./launch.mjs";
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
const browser = await chromium.launch(LAUNCH);

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

  await test("moving the wind and going back grow nothing anew", async () => {
    await slide(page, "wind", 0.4);
    await page.waitForFunction(() => document.body.dataset.state === "whole" && JSON.parse(document.body.dataset.tree).wind);
    const grown = () => page.evaluate(() => document.body.dataset.times);
    const before = await grown();
    await slide(page, "wind", 0.7);
    await whole(page);
    assert.equal(await grown(), before);
    await slide(page, "wind", 0);
    await page.waitForFunction(() => document.body.dataset.state === "whole" && !JSON.parse(document.body.dataset.tree).wind);
  });

  await test("arrow keys turn the tree", async () => {
    const before = await picture(page);
    await page.focus("#canvas");
    for (let i = 0; i < 5; i += 1) await page.keyboard.press("ArrowRight");
    await page.waitForTimeout(300);
    assert.notEqual(sum(before), sum(await picture(page)));
    assert.match(page.url(), /view=\d+%2C\d+%2C1(&|$)/);
  });

  await test("all is reached by keys", async () => {
    await page.focus("#tree");
    const seen = new Set();
    for (let i = 0; i < 60; i += 1) {
      seen.add(await page.evaluate(() => document.activeElement.id || document.activeElement.dataset.format || document.activeElement.ariaLabel));
      await page.keyboard.press("Tab");
    }
    for (const id of ["tree", "seed", "dice", "age", "Play age", "height-on", "day", "budget", "textures", "level", "wind", "glb", "recipe", "link"]) {
      assert.ok(seen.has(id), `${id} is not reached: ${[...seen].join(" ")}`);
    }
  });

  await test("what is shown is said", async () => {
    assert.match(await page.locator("#canvas").getAttribute("aria-label"), /^silver birch: 6\.0 m tall.*Arrow keys/);
    assert.equal(await page.locator("#status").getAttribute("aria-live"), "polite");
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
    const png = readFileSync(await save(page, "png"));
    assert.equal(png.subarray(1, 4).toString(), "PNG");
    // Of the tree itself, not of an empty page.
    assert.ok(png.length > 10_000, `${png.length} bytes`);
  });

  await test("OBJ is saved with its materials and images", async () => {
    const files = unzipSync(new Uint8Array(readFileSync(await save(page, "obj"))));
    const text = (name) => new TextDecoder().decode(files[name]);
    assert.match(text("tree.obj"), /^# treesynth[^]*mtllib tree\.mtl[^]*\nf /);
    const images = [...text("tree.mtl").matchAll(/^(?:map_\w+|norm) (.*)$/gm)].map(([, name]) => name);
    assert.ok(images.length > 0);
    for (const name of images) assert.equal(Buffer.from(files[name]).subarray(1, 4).toString(), "PNG", name);
  });

  await test("the recipe has what the tree was grown by", async () => {
    const recipe = JSON.parse(readFileSync(await save(page, "recipe")));
    assert.deepEqual([recipe.species, recipe.seed, recipe.height, recipe.day], ["silver birch", 3, 6, 288]);
    for (const [tree, key] of [["figure-07", "stages"], ["growth-15-cottonwood", "architecture"]]) {
      const other = await open(`#tree=${tree}&seed=4&nodes=3000&age=3.6&budget=3&textures=128`);
      await whole(other);
      const { [key]: what, seed } = JSON.parse(readFileSync(await save(other, "recipe")));
      assert.ok(what, tree);
      assert.equal(seed, 4);
      await other.close();
    }
  });

  await test("levels are drawn and saved", async () => {
    const other = await open("#tree=silver+birch&seed=3&height=4&budget=4&textures=128&wind=0&level=0");
    const triangles = async () => JSON.parse(await other.evaluate(() => document.body.dataset.times)).triangles;
    await whole(other);
    let [last, seen] = [await triangles(), await picture(other)];
    for (const level of ["1", "2", "3"]) {
      await other.selectOption("#level", level);
      await whole(other);
      const [now, picture_now] = [await triangles(), await picture(other)];
      assert.ok(now < 0.5 * last, `level ${level}: ${now} triangles after ${last}`);
      assert.notEqual(sum(seen), sum(picture_now), `level ${level}`);
      [last, seen] = [now, picture_now];
      await other.screenshot({ path: join(out, `level-${level}.png`) });
    }
    assert.match(other.url(), /level=3/);
    const saved = readFileSync(await save(other, "levels"));
    const { issues, info } = await validator.validateBytes(new Uint8Array(saved));
    assert.equal(issues.numErrors + issues.numWarnings, 0, JSON.stringify(issues.messages.slice(0, 3)));
    const names = saved.toString("latin1").match(/_LOD\d/g);
    assert.deepEqual([...new Set(names)], ["_LOD0", "_LOD1", "_LOD2", "_LOD3"], JSON.stringify(info));
    await other.close();
  });

  await test("a tree grows over the years", async () => {
    const other = await open("#tree=growth-15-cottonwood&seed=1&age=3.6&budget=3.7&textures=128");
    await whole(other);
    const height = async () => Number(/([\d.]+) m tall/.exec(await other.textContent("#status"))[1]);
    const young = await height();
    await slide(other, "age", 9.6);
    await whole(other);
    assert.ok(await height() > 1.5 * young, `${await height()} m after ${young} m`);
    await other.screenshot({ path: join(out, "years.png") });
    await other.close();
  });

  await test("the years play, and stop", async () => {
    const other = await open("#tree=hazel&seed=1&age=3&budget=3.5&textures=128");
    await whole(other);
    const play = other.getByRole("button", { name: "Play age" });
    const age = async () => Number(await other.inputValue("#age"));
    await play.click();
    await other.waitForFunction(() => Number(document.getElementById("age").value) >= 6, null, { timeout: 60_000 });
    assert.equal(await play.getAttribute("aria-pressed"), "true");
    await play.click();
    const stopped = await age();
    await whole(other);
    assert.equal(await play.getAttribute("aria-pressed"), "false");
    assert.equal(await age(), stopped);
    await other.close();
  });

  await test("the address alone brings the tree back", async () => {
    const other = await open(new URL(page.url()).hash);
    await whole(other);
    for (const id of ["tree", "seed", "day", "height", "budget", "level", "textures", "wind"]) {
      assert.equal(await other.inputValue(`#${id}`), await page.inputValue(`#${id}`), id);
    }
    const [one, two] = await Promise.all([page, other].map((page) => page.evaluate(() => document.body.dataset.tree)));
    assert.equal(one, two);
    // And from the same side, in the same light.
    const query = (page) => new URLSearchParams(new URL(page.url()).hash.slice(1));
    assert.equal(query(other).get("view"), query(page).get("view"));
    await other.close();
    const dark = await open(`${new URL(page.url()).hash}&theme=dark`);
    await whole(dark);
    assert.equal(await dark.evaluate(() => getComputedStyle(document.documentElement).colorScheme), "dark");
    await dark.close();
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
