// Nodes of previews: as many as this machine has ready in time.

const LEAST = 2_000;
const MOST = 20_000;
// Milliseconds from slider to picture: more are too slow; with fewer a preview can have more nodes.
const SLOW = 140;
const FAST = 70;

export class Pace {
  nodes = 8_000;

  // A preview took this long.
  took(milliseconds, nodes) {
    // Trees that are smaller anyway say nothing about more nodes.
    const isFull = nodes > 0.6 * this.nodes;
    const to = milliseconds > SLOW ? this.nodes * 0.7 : milliseconds < FAST && isFull ? this.nodes * 1.25 : this.nodes;
    this.nodes = Math.round(Math.min(Math.max(to, LEAST), MOST) / 100) * 100;
  }
}
