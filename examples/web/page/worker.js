// One synthesis at a time, off the page's thread. Cancelling ends the worker; the page starts another with the same module.

import { zipSync } from "three/examples/jsm/libs/fflate.module.js";

let tree = null;

const text = (pointer, length) =>
  new TextDecoder().decode(new Uint8Array(tree.exports.memory.buffer, pointer, length));

// Milliseconds of each step of the work, by its name.
let times = {};
let step = null;
const lap = (name) => {
  const now = performance.now();
  if (step) times[step.name] = (times[step.name] ?? 0) + now - step.since;
  step = name && { name, since: now };
};

const imports = {
  page: {
    progress: (fraction, pointer, length) => {
      const name = text(pointer, length);
      lap(name);
      postMessage({ progress: fraction, step: name });
    },
  },
};

// Files that follow one another, as one.
function zipped(bytes, files) {
  let at = 0;
  return zipSync(Object.fromEntries(files.map(([name, length]) => [name, bytes.subarray(at, at += length)])));
}

onmessage = async ({ data }) => {
  if (data.module) {
    tree = await WebAssembly.instantiate(data.module, imports);
    tree.exports.list();
    postMessage({ list: JSON.parse(text(tree.exports.output(0), tree.exports.output_length(0))) });
    return;
  }
  const start = performance.now();
  const ask = new TextEncoder().encode(JSON.stringify(data.ask));
  new Uint8Array(tree.exports.memory.buffer, tree.exports.input(ask.length), ask.length).set(ask);
  times = {};
  step = null;
  try {
    const done = tree.exports.run();
    lap(null);
    const said = text(tree.exports.output(0), tree.exports.output_length(0));
    if (!done) {
      postMessage({ number: data.number, error: said });
      return;
    }
    const report = JSON.parse(said);
    let file = new Uint8Array(tree.exports.memory.buffer, tree.exports.output(1), tree.exports.output_length(1)).slice();
    if (report.files.length) file = zipped(file, report.files);
    const milliseconds = performance.now() - start;
    postMessage({ number: data.number, report, file, milliseconds, times }, [file.buffer]);
  } catch (error) {
    // The module is of no more use: the page ends this worker.
    postMessage({ number: data.number, error: `the synthesis stopped: ${error.message}`, broken: true });
  }
};
