// Controls made from the module's list, and the address that says what they are set to.

// Sliders that can be played, in how many steps at most, with at least how many milliseconds from one to the next.
const PLAYED = new Set(["age", "day"]);
const STEPS = 90;
const PAUSE = 60;

const at = (id) => document.getElementById(id);

function element(name, properties = {}, children = []) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

// What an entry of the list is called on the page.
function title({ name, kind, about }) {
  if (kind === "years") return name.replace(/^growth-(\d+-)?/, "").replaceAll("-", " ");
  return kind === "preset" ? `${name}: ${about}` : name;
}

export class Controls {
  #list;
  #changed;
  // The button of the slider that plays.
  #playing = null;
  // By key: the entry of the list, its input, and its switch if it has one.
  #made = new Map();

  constructor(list, changed) {
    this.#list = list;
    this.#changed = changed;
    const group = (kind, label) => element("optgroup", { label }, list.filter((entry) => entry.kind === kind)
      .map((entry) => element("option", { value: entry.name, textContent: title(entry) })));
    at("tree").append(group("species", "Species"), group("years", "Over the years"), group("preset", "Least-cost paths"));
    at("tree").addEventListener("change", () => {
      this.#make();
      changed(false);
    });
    at("seed").addEventListener("change", () => changed(false));
    at("dice").addEventListener("click", () => {
      at("seed").value = Math.floor(Math.random() * 1e6);
      changed(false);
    });
    at("budget").addEventListener("input", () => this.#tell());
    at("wind").addEventListener("input", () => {
      this.#tell();
      // Only the first breath needs another file.
      changed(false);
    });
    for (const id of ["budget", "level", "textures"]) at(id).addEventListener("change", () => changed(false));
    this.#make();
  }

  get #tree() {
    return this.#list.find((entry) => entry.name === at("tree").value) ?? this.#list[0];
  }

  get wind() {
    return Number(at("wind").value);
  }

  #make() {
    this.stop();
    const { about, latin, controls } = this.#tree;
    at("about").textContent = latin ? `${latin}. ${about}` : about;
    this.#made.clear();
    at("sliders").replaceChildren(...controls.map((control) => this.#control(control)));
    this.#tell();
  }

  #control(control) {
    const { key, label, about } = control;
    if (control.kind === "choice") {
      const input = element("select", { id: key }, control.options.map((value) => element("option", { value, textContent: value })));
      input.value = control.value;
      input.addEventListener("change", () => this.#changed(false));
      this.#made.set(key, { control, input });
      return element("div", { className: "slider" }, [element("label", { htmlFor: key, textContent: label }), input]);
    }
    const { min, max, step, value } = control;
    const input = element("input", { id: key, type: "range", min, max, step: "any", value });
    input.step = step;
    input.value = value;
    input.setAttribute("aria-describedby", `${key}-about`);
    const output = element("output", { id: `${key}-value` });
    output.htmlFor = key;
    const name = element("label", { htmlFor: key, textContent: label });
    const made = { control, input };
    const row = element("div", { className: "slider" });
    if (control.optional) {
      made.toggle = element("input", { type: "checkbox", id: `${key}-on` });
      made.toggle.setAttribute("aria-label", `Set ${label.toLowerCase()}`);
      made.toggle.addEventListener("change", () => {
        this.#tell();
        this.#changed(false);
      });
      name.prepend(made.toggle);
    }
    input.addEventListener("input", () => {
      if (made.toggle) made.toggle.checked = true;
      this.#tell();
      this.#changed(true);
    });
    const told = element("span", { className: "value" }, [output]);
    if (PLAYED.has(key)) {
      const play = element("button", { type: "button", className: "play", textContent: "▶" });
      play.ariaLabel = `Play ${label.toLowerCase()}`;
      play.ariaPressed = "false";
      play.addEventListener("click", () => this.#play(made, play));
      told.append(play);
    }
    row.append(name, told, input, element("small", { id: `${key}-about`, textContent: about }));
    made.row = row;
    this.#made.set(key, made);
    return row;
  }

  // Moves a slider to its end, a step with each preview; again from the beginning if it is there.
  async #play({ input, toggle }, button) {
    if (this.#playing === button) {
      this.stop();
      return;
    }
    this.stop();
    this.#playing = button;
    button.ariaPressed = "true";
    button.textContent = "■";
    const { min, max, step } = Object.fromEntries(["min", "max", "step"].map((key) => [key, Number(input[key])]));
    const pace = Math.max(step, Math.round((max - min) / STEPS / step) * step);
    if (toggle) toggle.checked = true;
    if (Number(input.value) > max - pace) input.value = min;
    while (this.#playing === button && Number(input.value) + pace <= max) {
      input.value = Number(input.value) + pace;
      this.#tell();
      const rested = new Promise((resolve) => setTimeout(resolve, PAUSE));
      await Promise.all([this.#changed(true), rested]);
    }
    if (this.#playing === button) this.stop();
  }

  // Ends what plays.
  stop() {
    if (!this.#playing) return;
    this.#playing.ariaPressed = "false";
    this.#playing.textContent = "▶";
    this.#playing = null;
  }

  // Writes the values beside the sliders.
  #tell() {
    for (const [key, { control, input, toggle, row }] of this.#made) {
      if (control.kind !== "slider") continue;
      const off = toggle && !toggle.checked;
      const value = control.step < 1 ? Number(input.value).toFixed(control.step < 0.1 ? 2 : 1) : input.value;
      at(`${key}-value`).textContent = off ? "not set" : `${value} ${control.unit}`;
      row.toggleAttribute("data-off", Boolean(off));
    }
    at("budget-value").textContent = this.#budget().toLocaleString("en");
    at("wind-value").textContent = this.wind.toFixed(2);
  }

  #budget() {
    const exact = 10 ** Number(at("budget").value);
    return Math.round(exact / 100) * 100;
  }

  // What the module is asked for.
  ask() {
    const ask = {
      tree: at("tree").value,
      seed: Math.max(0, Math.floor(Number(at("seed").value)) || 0),
      budget: this.#budget(),
      textures: Number(at("textures").value),
      wind: this.wind > 0,
      level: Number(at("level").value),
    };
    for (const [key, { control, input, toggle }] of this.#made) {
      if (toggle && !toggle.checked) continue;
      ask[key] = control.kind === "slider" ? Number(input.value) : input.value;
    }
    // Both would have to fit each other.
    if (ask.height !== undefined || ask.dbh !== undefined) delete ask.age;
    return ask;
  }

  // All that is set, and from where the tree is seen, as the address has it.
  address(camera) {
    const state = new URLSearchParams({ tree: at("tree").value, seed: at("seed").value });
    for (const [key, { control, input, toggle }] of this.#made) {
      const isDefault = !toggle && Number(input.value) === Number(control.value) && control.kind === "slider";
      const isChoice = control.kind === "choice" && input.value === control.value;
      if (isDefault || isChoice || (toggle && !toggle.checked)) continue;
      state.set(key, input.value);
    }
    state.set("budget", at("budget").value);
    state.set("textures", at("textures").value);
    state.set("wind", at("wind").value);
    state.set("level", at("level").value);
    if (document.documentElement.dataset.theme) state.set("theme", document.documentElement.dataset.theme);
    if (camera) state.set("view", camera.join(","));
    return state.toString();
  }

  // Sets all that an address says; what it says wrongly stays as it is. Returns from where the tree is seen, if it says so.
  read(address) {
    const state = new URLSearchParams(address);
    const has = (select, value) => [...select.options].some((option) => option.value === value);
    if (has(at("tree"), state.get("tree"))) at("tree").value = state.get("tree");
    this.#make();
    const number = (input, value) => {
      if (value !== null && value !== "" && Number.isFinite(Number(value))) input.value = value;
    };
    for (const id of ["seed", "budget", "wind"]) number(at(id), state.get(id));
    for (const id of ["textures", "level"]) if (has(at(id), state.get(id))) at(id).value = state.get(id);
    if (["dark", "light"].includes(state.get("theme"))) document.documentElement.dataset.theme = state.get("theme");
    for (const [key, { control, input, toggle }] of this.#made) {
      const value = state.get(key);
      if (control.kind === "slider") number(input, value);
      else if (has(input, value)) input.value = value;
      if (toggle) toggle.checked = value !== null;
    }
    this.#tell();
    const camera = (state.get("view") ?? "").split(",").map(Number);
    return camera.length === 3 && camera.every(Number.isFinite) ? camera : null;
  }
}
