// The scene drawn here: a ray and its shadow a pixel while the camera moves, and what stands still as well as it can be.

import { inverse, minus, spread, times } from "./orbit.js";
import { noRoom, openDevice, upload } from "./device.js";
import { Passes } from "./passes.js";

// Milliseconds without a move after which the camera stands.
const STANDS = 150;
// Milliseconds that a picture in movement may take, and how many times smaller it may be in each direction.
const SMOOTH = 40;
const MOST_DIVISOR = 8;
// Visits of boxes that the heat map shows as white.
const VISITS = 256;
const SHADERS = ["trace", "sight", "screen", "lines"];

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
    this.isActive = this.isWorking = this.isDirty = this.isDestroyed = false;
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
    device.lost.then(({ message }) => drawing.isDestroyed || on.lost(message));
    return { drawing };
  }

  // Draw from now on, or not.
  activate(isActive) {
    this.isActive = isActive;
    if (isActive) {
      this.again();
    }
  }

  // Show something else: a view, an exposure, a size in pixels, or the heat map.
  show(changes, isMove = false) {
    const { width, height, ...others } = changes;
    if (width && (this.canvas.width !== width || this.canvas.height !== height)) {
      [this.canvas.width, this.canvas.height] = [width, height];
    }
    Object.assign(this, others);
    this.again(isMove);
  }

  async box(corners) {
    this.passes.box(corners);
    this.again();
  }

  again(isMove = false) {
    this.isDirty = true;
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
    } finally {
      this.isWorking = false;
    }
  }

  // Do one thing that is to be done; whether there may be more.
  async step() {
    const left = this.movedAt + STANDS - performance.now();
    if (this.isDirty) {
      this.isDirty = false;
      this.isWhole = left <= 0 && this.divisor === 1;
      await nextFrame();
      await this.sketch(this.divisor);
      return true;
    }
    if (left > 0) {
      await new Promise((done) => setTimeout(done, Math.min(left, 20)));
      return true;
    }
    if (!this.isWhole) {
      this.isWhole = true;
      await this.sketch(1);
      return true;
    }
    if (!this.isHeat) {
      this.on.stands();
    }
    return false;
  }

  // One ray a pixel, of as many times fewer pixels; the next picture in movement has as many as the device can do.
  async sketch(divisor) {
    const { canvas, passes } = this;
    const [width, height] = [canvas.width, canvas.height].map((size) => Math.max(Math.ceil(size / divisor), 1));
    const began = performance.now();
    this.aim(width, height);
    passes.drawSight(width, height);
    this.aim(canvas.width, canvas.height);
    this.present();
    await passes.device.queue.onSubmittedWorkDone();
    const took = performance.now() - began;
    const fit = Math.ceil(divisor * Math.sqrt(took / SMOOTH));
    this.divisor = Math.min(Math.max(fit, 1), MOST_DIVISOR);
    this.pictures += 1;
    canvas.dataset.pictures = this.pictures;
    this.on.tell({ samples: this.isHeat ? `1 to ${VISITS} visits` : "sketch", seconds: took / 1000 });
  }

  aim(width, height, more = {}) {
    const { centre, scale, orbit, lamp, tone } = this.told;
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
      sample: 0,
      ...more,
    });
  }

  // A file of what is seen: a canvas keeps it no longer than until it was shown, so it is drawn again.
  saved() {
    this.present();
    return new Promise((done) => this.canvas.toBlob(done));
  }

  present() {
    this.passes.present(this.context.getCurrentTexture().createView());
  }

  destroy() {
    this.isActive = false;
    this.isDestroyed = true;
    this.passes.destroy();
    this.passes.device.destroy();
  }
}
