// Times of previews in Chromium, after a build: `node measure.mjs [--turns N] [NAME...]`. For each tree a slider moves some steps, and a
// table says in milliseconds how long it took from the slider to the picture (median, least and most), and what of it took how long.
// CHROMIUM says where Chromium is. The picture is drawn by the processor, which a page on a machine with a graphics card is spared.

import { chromium } from "playwright-core";
import { LAUNCH } from "./launch.mjs";
import { serve } from "./run.mjs";

const args = process.argv.slice(2);
const turnsAt = args.indexOf("--turns");
const turns = turnsAt < 0 ? 5 : Number(args.splice(turnsAt, 2)[1]);

const server = await serve(0);
const browser = await chromium.launch(LAUNCH);
try {
  const page = await browser.newPage({ viewport: { width: 1200, height: 800 } });
  page.on("pageerror", (error) => console.error(error.message));
  await page.goto(`http://127.0.0.1:${server.address().port}/#budget=2&textures=128`);
  await page.waitForSelector('body[data-state="whole"]', { timeout: 120_000 });
  const names = args.length ? args : await page.$$eval("#tree option", (options) => options.map((option) => option.value));
  const columns = ["median", "least", "most", "grown", "message", "read", "drawn", "nodes", "triangles", "kB"];
  console.log(`| tree | ${columns.join(" | ")} |\n|---|${columns.map(() => "---:").join("|")}|`);
  for (const name of names) {
    const rows = await page.evaluate(async ({ name, turns }) => {
      const shown = () => new Promise((resolve) => {
        const observer = new MutationObserver(() => {
          const { state } = document.body.dataset;
          if (state !== "preview" && state !== "error") return;
          observer.disconnect();
          resolve(JSON.parse(document.body.dataset.times));
        });
        observer.observe(document.body, { attributes: true });
      });
      const tree = document.getElementById("tree");
      tree.value = name;
      // No whole tree is to be waited for.
      tree.dispatchEvent(new Event("change"));
      document.getElementById("cancel").click();
      const input = document.querySelector("#sliders input[type=range]");
      const rows = [];
      // Down, as many sliders begin at the most that a preview shows.
      const from = Number(input.value);
      for (let turn = 0; turn < turns; turn += 1) {
        const asked = shown();
        input.value = from - Number(input.step) * (turn + 1);
        input.dispatchEvent(new Event("input", { bubbles: true }));
        rows.push(await asked);
        document.getElementById("cancel").click();
        await new Promise((resolve) => setTimeout(resolve, 200));
      }
      return rows;
    }, { name, turns });
    // The first one after a new tree has shaders and the worker's module to make ready.
    const of = (key) => rows.map((row) => row[key]).sort((a, b) => a - b);
    const median = (key) => Math.round(of(key)[turns >> 1]);
    console.log(`| ${name} | ${median("all")} | ${Math.round(of("all")[0])} | ${Math.round(of("all").at(-1))} | `
      + `${columns.slice(3).map((column) => median(column)).join(" | ")} |`);
  }
} finally {
  await browser.close();
  server.close();
}
