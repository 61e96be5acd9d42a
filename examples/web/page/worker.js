// One synthesis at a time, off the page's thread. Cancelling ends the worker; the page starts another with the same module.

let tree = null;

const text = (pointer, length) =>
  new TextDecoder().decode(new Uint8Array(tree.exports.memory.buffer, pointer, length));

const imports = {
  page: { progress: (fraction, pointer, length) => postMessage({ progress: fraction, step: text(pointer, length) }) },
};

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
  try {
    const done = tree.exports.run();
    const said = text(tree.exports.output(0), tree.exports.output_length(0));
    if (!done) {
      postMessage({ number: data.number, error: said });
      return;
    }
    const file = new Uint8Array(tree.exports.memory.buffer, tree.exports.output(1), tree.exports.output_length(1)).slice();
    const milliseconds = performance.now() - start;
    postMessage({ number: data.number, report: JSON.parse(said), file, milliseconds }, [file.buffer]);
  } catch (error) {
    // The module is of no more use: the page ends this worker.
    postMessage({ number: data.number, error: `the synthesis stopped: ${error.message}`, broken: true });
  }
};
