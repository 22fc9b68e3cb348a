// The scene drawn here: one ray per pixel and its shadow while the camera moves, and paths while it stands.

import { inverse, minus, spread, times } from "./orbit.js";
import { noRoom, openDevice, upload } from "./device.js";
import { Passes } from "./passes.js";

// Milliseconds without a move after which the camera stands.
const STANDS = 150;
// Milliseconds for a picture in movement, and the greatest factor by which it is smaller in each direction.
const SMOOTH = 40;
const MOST_DIVISOR = 8;
// Nodes per ray that the heat map shows as white.
const VISITS = 256;
// Milliseconds for a band of paths, and between two pictures of their sums.
const BAND = 30;
const MOST_ROWS = 1 << 16;
const BETWEEN = 60;
// Factor of paths between two error estimates; least paths for an estimate to end the render; and factor of paths for
// which an untrusted estimate must stay below the wanted error (render/schedule.rs).
const LATER = 1.25;
const LEAST = 16;
const PATIENCE = 64;
const SHADERS = ["walk", "shading", "sight", "screen", "lines", "path", "brought", "error"];

const nextFrame = () => new Promise(requestAnimationFrame);
const sameTexts = new Map();

// Texts of the kernels, fetched once.
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
  // Draws on a canvas a scene from the core; `on` has callbacks: `stands` when the camera stands, `tell` with the
  // figures of a picture, and `lost` if the device is.
  constructor(canvas, told, name, passes, on) {
    [this.canvas, this.told, this.name, this.passes, this.on] = [canvas, told, name, passes, on];
    this.context = canvas.getContext("webgpu");
    this.context.configure({ device: passes.device, format: passes.format, alphaMode: "opaque" });
    this.view = null;
    this.exposure = 0;
    this.isHeat = false;
    this.divisor = 2;
    this.isActive = this.isWorking = this.isDirty = this.isStale = this.isDestroyed = false;
    // Paths of each pixel so far, the first row without the next path, and rows per band.
    this.sample = this.row = 0;
    this.rows = 32;
    this.pictures = 0;
    this.movedAt = -Infinity;
  }

  // Open a drawing, or report why there is none.
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
    // The kernel of paths is large and slow to compile.
    passes.paths?.prepare().then(
      () => drawing.work(),
      (error) => drawing.isDestroyed || on.lost(error.message),
    );
    device.lost.then(({ message }) => drawing.isDestroyed || on.lost(message));
    device.addEventListener("uncapturederror", ({ error }) => drawing.isDestroyed || on.lost(error.message));
    return { drawing };
  }

  // Start or stop drawing.
  activate(isActive) {
    this.isActive = isActive;
    if (isActive) {
      this.again();
    }
  }

  // Show another view, a size in pixels, or the heat map; or the same with another exposure.
  show({ width, height, exposure, ...others }, isMove = false) {
    const resized = width && (this.canvas.width !== width || this.canvas.height !== height);
    if (resized) {
      [this.canvas.width, this.canvas.height] = [width, height];
    }
    Object.assign(this, others);
    this.exposure = exposure ?? this.exposure;
    // A sketch has its exposure; sums of paths get it when shown.
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

  // Start again.
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
      // Errors of a device given up in the meantime are ignored.
      if (!this.isDestroyed) {
        throw error;
      }
    } finally {
      this.isWorking = false;
    }
  }

  // Do one pending step; true if there may be more.
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

  // Trace one more band of paths, and sometimes show the picture; true if there are more.
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
      // The view may have changed by now.
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

  // Report the error estimate, each time that paths have become some more.
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

  // One ray per pixel at reduced resolution; the next picture in movement has as many pixels as the device can draw.
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
    const { center, scale, orbit, lamp, behind, tone } = this.told;
    const local = (point) => times(minus(point, center), scale);
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

  // A file of the picture: a canvas keeps it only until shown, so it is drawn again.
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
