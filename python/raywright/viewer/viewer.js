// A viewer on its elements: pictures by the core or drawn here, and the user's actions.

import { START, ZOOM, clamp } from "./orbit.js";
import { Drawing } from "./drawing.js";
import { Stream } from "./stream.js";
import { Figures } from "./figures.js";
import { listen, listenToKeys } from "./controls.js";

// Milliseconds after a move of our own in which pictures may still show an earlier view.
const SETTLED = 1000;
const CORE = "the core";

const rounded = (values) => values.map((value) => +value.toPrecision(6)).join(", ");
const same = (a, b) => Object.keys(START).every((name) => a[name] === b[name]);

// `root` has the page's elements, `host` carries the state, `keys` gets key events, and `wire` connects to the core. It
// has `send(what, given)`, `ask(what, given)`, `bytes(name)`, `text(name)`, `watch(isOn)` for the core's pictures,
// `close()`, and `hasFile`, true if pictures have a file. It calls the functions set in its `on`: `scene`, `view`,
// `again`, `frame`, `trouble`, `ended`.
export class Viewer {
  constructor(root, host, keys, wire) {
    [this.host, this.wire] = [host, wire];
    this.byId = (id) => root.getElementById(id);
    this.view = { ...START };
    this.elevations = [-90, 90];
    this.movedAt = -Infinity;
    this.fits = false;
    this.size = null;
    this.boxes = null;
    this.cameraLine = "";
    this.drawing = null;
    this.isDrawn = this.isHeat = false;
    this.why = "";
    this.figures = new Figures(this.byId);
    this.stream = new Stream(this.byId, (frame) => this.tellFrame(frame));
    this.exposure = this.byId("exposure");
    for (const canvas of [this.byId("picture"), this.byId("drawn")]) {
      listen(canvas, { view: () => this.view, move: (changes) => this.move(changes), pick: (at) => this.pick(at) });
    }
    this.listenToParts(keys);
    wire.on = {
      scene: (scene) => this.begin(scene),
      view: (view) => this.follow(view),
      again: () => this.askAgain(),
      frame: (frame, bytes) => this.take(frame, bytes),
      trouble: (line) => this.end("ended", line),
      ended: () => this.state === "ended" || this.end("waiting", "The viewer has ended; the picture is as it was."),
    };
    wire.watch(true);
    this.ready = this.tryDrawing();
  }

  get state() {
    return this.host.dataset.state;
  }

  set state(state) {
    this.host.dataset.state = state;
  }

  say(...lines) {
    this.byId("message").textContent = lines.filter(Boolean).join(" · ");
  }

  listenToParts(keys) {
    const { byId } = this;
    byId("reset").addEventListener("click", () => this.move(START));
    byId("copy").addEventListener("click", () => this.copyCamera());
    byId("way").addEventListener("click", () => this.toggle());
    byId("save").addEventListener("click", (event) => this.save(event));
    this.exposure.addEventListener("input", () => {
      this.expose(this.exposure.value);
      this.wire.send("exposure", { exposure: Number(this.exposure.value) });
    });
    const step = (way) => {
      this.exposure[way]();
      this.exposure.dispatchEvent(new Event("input"));
    };
    const deeper = (by) => this.box(this.boxes === null ? 0 : this.boxes + by);
    listenToKeys(keys, {
      "[": () => step("stepDown"),
      "]": () => step("stepUp"),
      c: () => this.copyCamera(),
      b: () => deeper(1),
      B: () => deeper(-1),
      g: () => this.toggle(),
      h: () => this.heat(),
    });
    // The window: as many pixels as it has room for, once its size is constant for a moment.
    let resizing = 0;
    this.observer = new ResizeObserver(() => {
      clearTimeout(resizing);
      resizing = setTimeout(() => this.refit(), 100);
    });
    this.observer.observe(byId("stage"));
  }

  // The scene and the camera.

  begin(scene) {
    this.elevations = scene.elevations;
    this.fits = scene.fits;
    this.size = [scene.width, scene.height];
    this.boxes = scene.boxes;
    this.view = scene.view;
    this.expose(scene.exposure);
    this.stream.resize(...this.size);
    this.fit();
  }

  move(changes) {
    this.view = { ...this.view, ...changes };
    this.view.elevation = clamp(this.view.elevation, this.elevations);
    this.view.zoom = clamp(this.view.zoom, ZOOM);
    this.movedAt = performance.now();
    this.wire.send("view", this.view);
    this.drawHere();
    this.drawing?.show({ view: this.view }, true);
  }

  // Another page may have moved the camera, or this one before a reload.
  follow(view) {
    if (performance.now() - this.movedAt > SETTLED && !same(view, this.view)) {
      this.view = view;
      this.drawHere();
      this.drawing?.show({ view }, true);
    }
  }

  // Text under the picture may take another line, and change the size of the picture. In a window of constant size that
  // happens once only, or each picture would cause the next.
  refit() {
    const room = `${this.host.clientWidth} ${this.host.clientHeight}`;
    this.fitted = room === this.room ? this.fitted + 1 : 0;
    this.room = room;
    if (this.fitted < 2) {
      this.fit();
    }
  }

  fit() {
    const stage = this.byId("stage");
    const [width, height] = [stage.clientWidth, stage.clientHeight].map((size) => clamp(Math.round(size), [16, 4096]));
    if (this.fits) {
      this.wire.send("window", { width, height });
    }
    if (this.size) {
      const [across, down] = this.size;
      const scale = this.fits ? Math.min(width / across, height / down) : 1;
      const [w, h] = [across, down].map((size) => Math.max(Math.round(size * scale), 1));
      this.drawing?.show({ width: w, height: h });
    }
  }

  expose(stops) {
    this.exposure.value = stops;
    this.byId("stops").textContent = this.exposure.value;
    this.drawing?.show({ exposure: Number(this.exposure.value) });
  }

  async box(depth) {
    const wanted = depth < 0 ? null : depth;
    this.boxes = wanted;
    this.wire.send("boxes", { depth: wanted });
    if (this.drawing) {
      const corners = wanted === null ? null : await this.wire.bytes(`boxes/${wanted}`);
      if (this.boxes !== wanted) {
        // A request for another level is pending.
        return;
      }
      // No boxes beyond the last level.
      this.boxes = corners?.byteLength ? wanted : null;
      this.drawing.box(corners);
      if (this.isDrawn) {
        this.say(this.toldBoxes());
      }
    }
  }

  toldBoxes() {
    return this.boxes === null ? "" : `boxes ${this.boxes} ${this.boxes === 1 ? "step" : "steps"} from the root`;
  }

  async pick(place) {
    const found = await this.wire.ask("pick", { view: this.view, ...place });
    this.host.dataset.picked = JSON.stringify(found);
    if (found.shape === null) {
      this.say("nothing is there");
      return;
    }
    const name = found.name === null ? "" : ` (${found.name})`;
    const where = `at (${rounded(found.position)}), t = ${rounded([found.t])}`;
    this.say(`shape ${found.shape}${name}, face ${found.face}, ${where}`);
  }

  async copyCamera() {
    const { line } = await this.wire.ask("camera", {});
    try {
      await navigator.clipboard.writeText(line);
      this.say(`copied: ${line}`);
    } catch {
      this.say(line);
    }
  }

  // The server has a file of the core's rendering; any other picture is saved as shown.
  async save(event) {
    if (this.shownHere || !this.wire.hasFile) {
      event.preventDefault();
      const canvas = this.byId("picture");
      const file = this.shownHere ? this.drawing.saved() : new Promise((done) => canvas.toBlob(done));
      const link = Object.assign(document.createElement("a"), { download: "raywright.png" });
      link.href = URL.createObjectURL(await file);
      link.click();
      // The browser fetches it after the click.
      setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
    }
  }

  // Choose between drawing here and the core.

  async tryDrawing() {
    const on = {
      stands: () => this.handOver(),
      tell: (told) => this.tellDrawn(told),
      lost: (why) => this.giveUp(`the device was lost: ${why}`),
    };
    try {
      const { drawing, why } = await Drawing.open(this.byId("drawn"), this.wire, on);
      [this.drawing, this.why] = [drawing ?? null, why ?? ""];
    } catch (error) {
      this.why = error.message;
    }
    if (this.drawing) {
      this.drawing.show({ view: this.view, exposure: Number(this.exposure.value), isHeat: false });
      this.fit();
      if (this.boxes !== null) {
        await this.box(this.boxes);
      }
      this.toggle();
    }
    this.tellWay();
  }

  // The core renders another picture now: check again whether it can be drawn here.
  async askAgain() {
    if (this.drawing) {
      this.drawing.told.traced = null;
      const { traced, left } = await this.wire.ask("drawing", {});
      Object.assign(this.drawing.told, { traced: traced ?? null, left });
      this.tellWay();
      this.drawHere();
      this.drawing.again();
    }
  }

  toggle() {
    if (!this.drawing) {
      this.say(this.why);
      return;
    }
    this.isDrawn = !this.isDrawn;
    this.drawHere();
    if (this.isDrawn) {
      this.drawing.again();
    } else {
      this.showHere(false);
      this.state = "waiting";
    }
    this.tellWay();
  }

  heat() {
    if (!this.drawing) {
      this.say(this.why);
      return;
    }
    this.isHeat = !this.isHeat;
    this.isDrawn = true;
    this.drawHere();
    this.drawing.show({ isHeat: this.isHeat });
    this.tellWay();
    this.say(this.isHeat ? "nodes of the tree that each ray reads: from 1, black, to 256 and more, white" : "");
  }

  giveUp(why) {
    this.drawing?.destroy();
    [this.drawing, this.why, this.isDrawn] = [null, why, false];
    this.showHere(false);
    this.wire.watch(true);
    this.tellWay();
    this.say(why);
  }

  // Show one of the two canvases.
  showHere(isHere) {
    this.shownHere = isHere;
    this.host.dataset.shown = isHere ? "drawn" : "picture";
    this.drawing?.activate(isHere);
  }

  drawHere() {
    this.isHandedOver = false;
    this.wire.watch(!this.isDrawn);
    if (this.isDrawn && !this.shownHere) {
      this.showHere(true);
      this.state = "drawn";
      this.say(this.toldBoxes());
      this.figures.forget();
    }
  }

  // The camera stands, and the core makes the better picture: its pictures take over as they arrive.
  handOver() {
    if (this.isDrawn) {
      this.isHandedOver = true;
      this.wire.watch(true);
    }
  }

  tellWay() {
    this.host.dataset.way = this.isDrawn ? "drawn" : "core";
    const way = this.byId("way");
    way.textContent = this.isDrawn ? `WebGPU${this.isHeat ? ", heat" : ""}` : CORE;
    if (this.isDrawn) {
      const { left } = this.drawing.told;
      const standing = left ? `; what stands is the core's: ${left}` : "";
      way.title = `drawn by this browser on ${this.drawing.name}; g for the core's pictures${standing}`;
    } else {
      way.title = `rendered by the core${this.why ? `: ${this.why}` : "; g to draw here, by WebGPU"}`;
    }
  }

  // Show the figures.

  tellDrawn({ isDone, ...told }) {
    if (this.shownHere) {
      this.state = isDone ? "done" : "drawn";
      this.figures.tell(told);
    }
  }

  take(frame, bytes) {
    if (performance.now() - this.movedAt > SETTLED) {
      this.follow(frame.view);
    }
    if (this.isWanted(frame)) {
      this.stream.show(frame, bytes);
    }
  }

  // Some pending pictures are obsolete, and a preview is no better than the drawing here.
  isWanted(frame) {
    return !this.isDrawn || (this.isHandedOver && frame.state !== "preview" && same(frame.view, this.view));
  }

  tellFrame(frame) {
    if (!this.isWanted(frame)) {
      return;
    }
    if (this.shownHere) {
      this.showHere(false);
    }
    this.state = frame.state;
    this.cameraLine = frame.camera;
    this.boxes = frame.boxes;
    this.say(this.toldBoxes(), ...frame.warnings);
    const isPreview = frame.state === "preview";
    const [value, low, high] = frame.error;
    this.figures.tell({
      samples: isPreview ? "preview" : frame.samples,
      seconds: frame.seconds,
      // The error of a smaller picture does not apply.
      error: isPreview || value === null ? null : { value, low, high, isTrusted: frame.trusted },
      of: [frame.view, frame.size],
    });
  }

  close() {
    this.observer.disconnect();
    this.drawing?.destroy();
    this.wire.close();
  }

  end(state, line) {
    this.state = state;
    this.say(line);
  }
}
