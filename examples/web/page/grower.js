// Trees from a worker: the newest question only, cancelled when a newer one comes while it takes long.

export class Grower {
  #module;
  #worker = null;
  #ready = null;
  #number = 0;
  #waiting = null;
  #busy = null;

  constructor(module, onProgress) {
    this.#module = module;
    this.onProgress = onProgress;
    this.#start();
  }

  // What can be asked for.
  get list() {
    return this.#ready;
  }

  #start() {
    const worker = new Worker("worker.js");
    this.#worker = worker;
    this.#ready = new Promise((resolve) => {
      worker.onmessage = ({ data }) => {
        if (data.list) resolve(data.list);
        else if (data.progress !== undefined) this.onProgress(data.progress, data.step);
        else this.#done(data);
      };
    });
    worker.postMessage({ module: this.#module });
  }

  // Resolves to the answer, or to null if a newer question came first.
  grow(ask) {
    this.#waiting?.resolve(null);
    return new Promise((resolve, reject) => {
      this.#waiting = { ask, resolve, reject };
      this.#next();
    });
  }

  get isBusy() {
    return this.#busy !== null;
  }

  // What waits is not wanted any more.
  forget() {
    this.#waiting?.resolve(null);
    this.#waiting = null;
  }

  // Ends what is being done.
  cancel() {
    this.forget();
    if (!this.#busy) return;
    this.#busy.resolve(null);
    this.#busy = null;
    this.#worker.terminate();
    this.#start();
  }

  #next() {
    if (this.#busy || !this.#waiting) return;
    this.#busy = this.#waiting;
    this.#waiting = null;
    this.#number += 1;
    const question = { ask: this.#busy.ask, number: this.#number };
    this.#ready.then(() => this.#worker.postMessage(question));
  }

  #done(data) {
    if (data.number !== this.#number || !this.#busy) return;
    const { resolve, reject } = this.#busy;
    this.#busy = null;
    if (data.broken) {
      this.#worker.terminate();
      this.#start();
    }
    if (data.error) reject(new Error(data.error));
    else resolve(data);
    this.#next();
  }
}
