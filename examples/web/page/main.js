// The page: controls from the module's list, the address, what is grown and shown.

import { Controls } from "./controls.js";
import { Grower } from "./grower.js";
import { Pace } from "./pace.js";
import { View } from "./view.js";

// Milliseconds without a move after which a slider rests.
const REST = 400;

const at = (id) => document.getElementById(id);

// A preview's words are seen but not read aloud: many may come in a second.
const status = (text, isError = false, isQuiet = false) => {
  at("status").ariaLive = isQuiet ? "off" : "polite";
  at("status").textContent = text;
  at("status").classList.toggle("error", isError);
};

const theme = () => {
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  return document.documentElement.dataset.theme ?? (dark ? "dark" : "light");
};

// A question for a preview of a tree.
function sketched({ budget, textures, level, ...ask }, nodes) {
  // A graph of more nodes would take longer than a hand moves.
  return { ...ask, wind: false, preview: nodes, ...(ask.nodes && { nodes: Math.min(ask.nodes, 20_000) }) };
}

async function start() {
  const view = new View(at("canvas"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => view.paint());
  at("theme").addEventListener("click", () => {
    document.documentElement.dataset.theme = theme() === "dark" ? "light" : "dark";
    view.paint();
    view.onTurn?.();
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
  // The questions that the shown tree and preview answer: what does not change them is not grown again.
  const shown = { whole: "", preview: "" };
  // Nodes of previews: as many as are there in time.
  const pace = new Pace();
  // Grows what the controls say, and shows it; true if it is on the screen.
  const grow = async (isPreview) => {
    const ask = controls.ask();
    const wanted = isPreview ? sketched(ask, pace.nodes) : ask;
    const kind = isPreview ? "preview" : "whole";
    const question = JSON.stringify(wanted);
    if (question === shown[kind] && (isPreview || view.isWhole)) {
      grower.forget();
      document.body.dataset.state = kind;
      return true;
    }
    const begin = performance.now();
    try {
      const asked = grower.grow(wanted);
      busy();
      const answer = await asked;
      if (!answer) return false;
      const grown = performance.now();
      const frame = `${ask.tree} ${Math.ceil(Math.log2(answer.report.height) * 2)}`;
      const read = await view[isPreview ? "sketch" : "show"](answer.file, frame !== framed);
      framed = frame;
      shown[kind] = question;
      const waited = performance.now() - begin;
      if (isPreview) pace.took(waited, answer.report.nodes);
      const { name, height, width, dbh, leaves, triangles } = answer.report;
      const trunk = dbh ? `, trunk ${(dbh * 100).toFixed(0)} cm` : "";
      const text = `${name}: ${height.toFixed(1)} m tall, ${width.toFixed(1)} m wide${trunk}, ${leaves.toLocaleString("en")} leaves, `
        + `${triangles.toLocaleString("en")} triangles, ${Math.round(waited)} ms`;
      status(text, false, isPreview);
      at("canvas").ariaLabel = `${text.replace(/, [^,]* ms$/, "")}. Arrow keys turn it, plus and minus zoom.`;
      Object.assign(document.body.dataset, {
        milliseconds: Math.round(waited),
        grown: Math.round(answer.milliseconds),
        times: JSON.stringify({
          all: waited,
          ...answer.times,
          grown: answer.milliseconds,
          message: grown - begin - answer.milliseconds,
          read,
          drawn: performance.now() - grown - read,
          nodes: answer.report.nodes,
          triangles,
          kB: answer.report.bytes / 1000,
        }),
        tree: question,
        state: kind,
      });
      return true;
    } catch (error) {
      status(error.message, true);
      document.body.dataset.state = "error";
      return false;
    } finally {
      busy();
    }
  };

  let rest = null;
  let moved = 0;
  const address = () => history.replaceState(null, "", `#${controls.address(view.camera)}`);
  const changed = (isMoving) => {
    view.wind = controls.wind;
    address();
    document.body.dataset.state = "growing";
    clearTimeout(rest);
    moved += 1;
    if (!isMoving) {
      rest = setTimeout(() => grow(false));
      return null;
    }
    // What a preview shows is made whole once the slider rests: not before it is there, or both would take longer.
    const move = moved;
    return grow(true).finally(() => {
      if (move === moved) rest = setTimeout(() => grow(false), REST);
    });
  };
  const controls = new Controls(await grower.list, changed);
  view.onTurn = address;
  const read = () => {
    const camera = controls.read(location.hash.slice(1));
    if (camera) view.camera = camera;
    view.paint();
  };
  read();
  addEventListener("hashchange", () => {
    if (location.hash.slice(1) !== controls.address(view.camera)) {
      read();
      changed(false);
    }
  });
  at("cancel").addEventListener("click", () => {
    clearTimeout(rest);
    moved += 1;
    controls.stop();
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
    const ends = { levels: "levels.glb", obj: "zip", json: "skeleton.json", recipe: "recipe.json" };
    const name = `${ask.tree.replaceAll(" ", "-").toLowerCase()}-${ask.seed}.${ends[format] ?? format}`;
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
