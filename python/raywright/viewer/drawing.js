// The scene drawn here: a ray and its shadow a pixel while the camera moves, and paths while it stands.

import { inverse, minus, spread, times } from "./orbit.js";
import { noRoom, openDevice, upload } from "./device.js";
import { Passes } from "./passes.js";

// Milliseconds without a move after which the camera stands.
const STANDS = 150;
// Milliseconds that a picture in movement may take, and how many times smaller it may be in each direction.
const SMOOTH = 40;
const MOST_DIVISOR = 8;
// Nodes read by a ray that the heat map shows as white.
const VISITS = 256;
// Milliseconds that a band of paths may take, and between two pictures of what they have brought.
const BAND = 30;
const MOST_ROWS = 1 << 16;
const BETWEEN = 60;
// How many times as many paths there are when the next error is told, below how many of them one ends nothing, and how
// many times the paths may become while one stays below what is wanted that is not trusted (render/schedule.rs).
const LATER = 1.25;
const LEAST = 16;
const PATIENCE = 64;
const SHADERS = ["walk", "shading", "sight", "screen", "lines", "path", "brought", "error"];

const nextFrame = () => new Promise(requestAnimationFrame);
const sameTexts = new Map();

// The kernels' texts, asked for once.
function textsOf(textOf) {
  const texts = SHADERS.map(async (name) => {
    if (!sameTexts.has(name)) {
      sameTexts.set(name, await textOf(`${name}.wgsl`));
    }
    return [name, sameTexts.get(name)];
  });
  return Promise.all(texts).then(Object.fromEntries);
}

export class Drawing {
  // On a canvas, of a scene as the core told it; `on` has what to call: `stands` once the camera does, `tell` with
  // what there is to say of a picture, and `lost` if the device is.
  constructor(canvas, told, name, passes, on) {
    [this.canvas, this.told, this.name, this.passes, this.on] = [canvas, told, name, passes, on];
    this.context = canvas.getContext("webgpu");
    this.context.configure({ device: passes.device, format: passes.format, alphaMode: "opaque" });
    this.view = null;
    this.exposure = 0;
    this.isHeat = false;
    this.divisor = 2;
    this.isActive = this.isWorking = this.isDirty = this.isStale = this.isDestroyed = false;
    // Paths of each pixel that there are, the row from which on the next are traced, and how many rows at once.
    this.sample = this.row = 0;
    this.rows = 32;
    this.pictures = 0;
    this.movedAt = -Infinity;
  }

  // Open one, or tell why there is none.
  static async open(canvas, wire, on) {
    const opened = await openDevice();
    if (!opened) {
      return { why: "this browser has no WebGPU" };
    }
    const { device, name } = opened;
    const told = await wire.ask("drawing", {});
    const why = told.why ?? noRoom(device, told.arrays);
    if (why) {
      device.destroy();
      return { why };
    }
    const [buffers, texts] = await Promise.all([upload(device, told, wire.bytes), textsOf(wire.text)]);
    const passes = new Passes(device, navigator.gpu.getPreferredCanvasFormat(), told, buffers, texts);
    await passes.prepare();
    const drawing = new Drawing(canvas, told, name, passes, on);
    // The kernel of paths is large, and takes its time to compile.
    passes.paths?.prepare().then(
      () => drawing.work(),
      (error) => drawing.isDestroyed || on.lost(error.message),
    );
    device.lost.then(({ message }) => drawing.isDestroyed || on.lost(message));
    device.addEventListener("uncapturederror", ({ error }) => drawing.isDestroyed || on.lost(error.message));
    return { drawing };
  }

  // Draw from now on, or not.
  activate(isActive) {
    this.isActive = isActive;
    if (isActive) {
      this.again();
    }
  }

  // Show something else: a view, a size in pixels, or the heat map; or the same in another way.
  show({ width, height, exposure, ...others }, isMove = false) {
    const resized = width && (this.canvas.width !== width || this.canvas.height !== height);
    if (resized) {
      [this.canvas.width, this.canvas.height] = [width, height];
    }
    Object.assign(this, others);
    this.exposure = exposure ?? this.exposure;
    // A sketch has its exposure; what paths have brought gets it when it is shown.
    if (resized || Object.keys(others).length || (exposure !== undefined && !this.sample)) {
      this.again(isMove);
    } else {
      this.isStale = true;
      this.work();
    }
  }

  box(corners) {
    this.passes.box(corners);
    this.isStale = true;
    this.work();
  }

  // Begin anew.
  again(isMove = false) {
    this.isDirty = true;
    this.sample = this.row = 0;
    if (isMove) {
      this.movedAt = performance.now();
    }
    this.work();
  }

  async work() {
    if (this.isWorking || !this.isActive || !this.view) {
      return;
    }
    this.isWorking = true;
    try {
      while (this.isActive && (await this.step())) {}
    } catch (error) {
      // What a device was still to tell when it was given up is not heard.
      if (!this.isDestroyed) {
        throw error;
      }
    } finally {
      this.isWorking = false;
    }
  }

  // Do one thing that is to be done; whether there may be more.
  async step() {
    const left = this.movedAt + STANDS - performance.now();
    const { canvas, passes } = this;
    const traced = !this.isHeat && passes.paths?.fits(canvas.width, canvas.height) ? this.told.traced : null;
    if (this.isDirty) {
      this.isDirty = this.isStale = false;
      this.isWhole = left <= 0 && this.divisor === 1;
      await nextFrame();
      await this.sketch(this.divisor);
    } else if (left > 0) {
      await new Promise((done) => setTimeout(done, Math.min(left, 20)));
    } else if (this.isStale) {
      this.isStale = false;
      this.present();
    } else if (traced && passes.paths.isReady) {
      return this.trace(traced);
    } else if (!this.isWhole) {
      this.isWhole = true;
      await this.sketch(1);
    } else {
      if (!this.isHeat && !traced) {
        this.on.stands();
      }
      return false;
    }
    return true;
  }

  // A band of paths more, and at times the picture of all; whether there are more.
  async trace(limits) {
    const { canvas, passes } = this;
    const { samples } = limits;
    if (this.sample === 0 && this.row === 0) {
      passes.paths.room(canvas.width, canvas.height);
      this.spent = this.above = 0;
      this.presentedAt = -Infinity;
      [this.error, this.errorAt, this.nextErrorAt] = [null, 0, 2];
    }
    if (this.isEnough(limits)) {
      await this.showPaths(limits, true);
      // It may have been moved by now.
      return this.isDirty;
    }
    const began = performance.now();
    const before = this.sample;
    let left = this.rows;
    while (left > 0 && this.sample < samples) {
      const rows = Math.min(left, canvas.height - this.row);
      this.aim(canvas.width, canvas.height, { row: this.row });
      passes.paths.trace(rows, this.sample);
      left -= rows;
      this.row += rows;
      if (this.row >= canvas.height) {
        this.row = 0;
        this.sample += 1;
      }
    }
    await passes.device.queue.onSubmittedWorkDone();
    if (this.isDirty) {
      return true;
    }
    const took = performance.now() - began;
    this.spent += took / 1000;
    const most = Math.min(2 * this.rows, MOST_ROWS);
    this.rows = Math.max(8 * Math.round(Math.min((this.rows * BAND) / took, most) / 8), 8);
    if (this.sample === before) {
      return true;
    }
    if (performance.now() - this.presentedAt > BETWEEN) {
      await this.showPaths(limits, false);
    }
    return true;
  }

  isEnough({ samples, seconds, error }) {
    if (this.sample >= samples || (seconds !== null && this.spent >= seconds && this.sample > 0)) {
      return true;
    }
    if (error === null || !this.error || this.errorAt < LEAST) {
      return false;
    }
    const { value, high, isTrusted } = this.error;
    return isTrusted ? high <= error : value <= error && this.errorAt >= PATIENCE * Math.max(this.above, LEAST);
  }

  // How wrong the picture still is, told as often as paths have become some more.
  async tellError({ error }) {
    const [began, sample] = [performance.now(), this.sample];
    const told = await this.passes.paths.errors.estimate();
    if (this.isDirty) {
      return;
    }
    this.spent += (performance.now() - began) / 1000;
    [this.error, this.errorAt, this.nextErrorAt] = [told, sample, Math.ceil(LATER * sample)];
    if (error !== null && !(told?.value <= error)) {
      this.above = sample;
    }
  }

  async showPaths(limits, isDone) {
    if (this.sample >= this.nextErrorAt || (isDone && this.sample > this.errorAt)) {
      await this.tellError(limits);
    }
    await nextFrame();
    if (this.isDirty) {
      return;
    }
    this.present();
    this.presentedAt = performance.now();
    this.canvas.dataset.samples = this.sample;
    const { view, spent, error, sample, canvas } = this;
    this.on.tell({ samples: sample, seconds: spent, error, isDone, of: [view, canvas.width, canvas.height] });
  }

  // One ray a pixel, of as many times fewer pixels; the next picture in movement has as many as the device can do.
  async sketch(divisor) {
    const { canvas, passes } = this;
    const [width, height] = [canvas.width, canvas.height].map((size) => Math.max(Math.ceil(size / divisor), 1));
    const began = performance.now();
    this.aim(width, height, { gain: 1 });
    passes.drawSight(width, height);
    this.present();
    await passes.device.queue.onSubmittedWorkDone();
    const took = performance.now() - began;
    const fit = Math.ceil(divisor * Math.sqrt(took / SMOOTH));
    this.divisor = Math.min(Math.max(fit, 1), MOST_DIVISOR);
    this.pictures += 1;
    canvas.dataset.pictures = this.pictures;
    canvas.dataset.samples = 0;
    this.on.tell({ samples: this.isHeat ? `1 to ${VISITS} nodes` : "sketch", seconds: took / 1000, error: null });
  }

  aim(width, height, more = {}) {
    const { centre, scale, orbit, lamp, behind, tone } = this.told;
    const local = (point) => times(minus(point, centre), scale);
    const { origins, ways } = spread(orbit, this.view);
    const [corner, ...sides] = origins;
    const inBox = [local(corner), ...sides.map((side) => times(side, scale))];
    const length = Math.hypot(...lamp.place);
    this.passes.aim({
      origins: inBox,
      ways,
      inverse: inverse([...(orbit.parallel ? inBox : ways).slice(1), ways[0]]),
      parallel: orbit.parallel,
      lamp: lamp.far ? [...times(lamp.place, 1 / length), 0] : [...local(lamp.place), 1],
      width,
      height,
      gain: 2 ** this.exposure,
      brightest: VISITS,
      mode: this.isHeat ? 1 : 0,
      tone,
      row: 0,
      behind: times(behind, 2 ** this.exposure),
      ...more,
    });
  }

  // A file of what is seen: a canvas keeps it no longer than until it was shown, so it is drawn again.
  saved() {
    this.present();
    return new Promise((done) => this.canvas.toBlob(done));
  }

  present() {
    this.aim(this.canvas.width, this.canvas.height);
    this.passes.present(this.context.getCurrentTexture().createView(), this.sample > 0);
  }

  destroy() {
    this.isActive = false;
    this.isDestroyed = true;
    this.passes.destroy();
    this.passes.device.destroy();
  }
}
