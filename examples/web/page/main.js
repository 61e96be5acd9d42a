// The page: controls from the module's list, the address, what is grown and shown.

import { Controls } from "./controls.js";
import { Grower } from "./grower.js";
import { View } from "./view.js";

const at = (id) => document.getElementById(id);

const status = (text, isError = false) => {
  at("status").textContent = text;
  at("status").classList.toggle("error", isError);
};

const theme = () => {
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  return document.documentElement.dataset.theme ?? (dark ? "dark" : "light");
};

async function start() {
  const view = new View(at("canvas"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => view.paint());
  at("theme").addEventListener("click", () => {
    document.documentElement.dataset.theme = theme() === "dark" ? "light" : "dark";
    view.paint();
  });

  const module = await WebAssembly.compileStreaming(fetch("treesynth.wasm"));
  let shows = null;
  const grower = new Grower(module, (fraction, step) => {
    at("progress").value = fraction;
    at("step").textContent = step;
  });
  const busy = () => {
    clearTimeout(shows);
    // Short work shows no bar that flashes.
    if (grower.isBusy) shows = setTimeout(() => (at("work").hidden = false), 250);
    else at("work").hidden = true;
  };

  let framed = "";
  // Grows what the controls say, and shows it.
  const grow = async (isPreview) => {
    const ask = controls.ask();
    // While a slider moves: coarse, and soon there. A graph of more nodes would take longer than a hand moves.
    const coarse = { preview: true, wind: false, ...(ask.nodes && { nodes: Math.min(ask.nodes, 20_000) }) };
    const wanted = isPreview ? { ...ask, ...coarse } : ask;
    const begin = performance.now();
    try {
      const asked = grower.grow(wanted);
      busy();
      const answer = await asked;
      if (!answer) return;
      const frame = `${ask.tree} ${Math.ceil(Math.log2(answer.report.height) * 2)}`;
      await view.show(answer.file, frame !== framed);
      framed = frame;
      const { name, height, width, dbh, leaves, triangles } = answer.report;
      const trunk = dbh ? `, trunk ${(dbh * 100).toFixed(0)} cm` : "";
      const waited = Math.round(performance.now() - begin);
      status(
        `${name}: ${height.toFixed(1)} m tall, ${width.toFixed(1)} m wide${trunk}, ${leaves.toLocaleString("en")} leaves, `
        + `${triangles.toLocaleString("en")} triangles, ${waited} ms`,
      );
      Object.assign(document.body.dataset, {
        state: isPreview ? "preview" : "whole",
        milliseconds: waited,
        grown: Math.round(answer.milliseconds),
        tree: JSON.stringify(wanted),
      });
    } catch (error) {
      status(error.message, true);
      document.body.dataset.state = "error";
    } finally {
      busy();
    }
  };

  let rest = null;
  const changed = (isMoving) => {
    view.wind = controls.wind;
    history.replaceState(null, "", `#${controls.address()}`);
    document.body.dataset.state = "growing";
    clearTimeout(rest);
    if (isMoving) grow(true);
    // What a preview shows is made whole once the slider rests.
    rest = setTimeout(() => grow(false), isMoving ? 400 : 0);
  };
  const controls = new Controls(await grower.list, changed);
  controls.read(location.hash.slice(1));
  addEventListener("hashchange", () => {
    if (location.hash.slice(1) !== controls.address()) {
      controls.read(location.hash.slice(1));
      changed(false);
    }
  });
  at("cancel").addEventListener("click", () => {
    clearTimeout(rest);
    grower.cancel();
    at("work").hidden = true;
    status("Cancelled");
    document.body.dataset.state = "cancelled";
  });

  const save = (blob, name) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  };
  at("export").addEventListener("click", async ({ target }) => {
    if (target.id === "link") {
      await navigator.clipboard?.writeText(location.href).catch(() => {});
      status("The address of this page has the tree; it is copied");
      return;
    }
    const { format } = target.dataset;
    if (!format) return;
    const ask = controls.ask();
    const name = `${ask.tree.replaceAll(" ", "-").toLowerCase()}-${ask.seed}.${format}`;
    if (format === "png") {
      save(await view.picture(), name);
      return;
    }
    try {
      const asked = grower.grow({ ...ask, format });
      busy();
      const answer = await asked;
      if (answer) save(new Blob([answer.file]), name);
    } catch (error) {
      status(error.message, true);
    } finally {
      busy();
    }
  });
  changed(false);
}

start().catch((error) => status(error.message, true));
