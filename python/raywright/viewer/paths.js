// Paths through a scene, one pass over the picture at a time, in bands of rows: no device is kept busy for long.

import { bufferOf, mostOf } from "./device.js";
import { Errors } from "./error.js";

const NAMES = ["faces", "materials", "lights", "numbers"];
// Bytes of a pixel's sums.
const PIXEL = 48;

export class Paths {
  // Uses the scene of other passes.
  constructor(passes) {
    this.passes = passes;
    const { device, buffers, told } = passes;
    const { depth, roulette, seed } = told.traced ?? { depth: 0, roulette: 0, seed: 0 };
    this.given = [depth, roulette, seed];
    this.limits = bufferOf(device, new Uint32Array(8), GPUBufferUsage.UNIFORM);
    this.buffers = [...NAMES.map((name) => buffers[name]), buffers.lit, this.limits];
    const visibility = GPUShaderStage.COMPUTE;
    const types = ["storage", ...NAMES.map(() => "read-only-storage"), "uniform", "uniform"];
    this.layout = device.createBindGroupLayout({
      entries: types.map((type, binding) => ({ binding, visibility, buffer: { type } })),
    });
    this.size = [0, 0];
    this.errors = new Errors(device, passes.texts);
  }

  async prepare() {
    const { device, beginning, texts, layout, told } = this.passes;
    const parts = [beginning, told.known, texts.shading, texts.brought, texts.path];
    const module = device.createShaderModule({ code: parts.join("\n") });
    this.pipeline = await device.createComputePipelineAsync({
      layout: device.createPipelineLayout({ bindGroupLayouts: [layout, this.layout] }),
      compute: { module, entryPoint: "accumulate" },
    });
    await this.errors.prepare();
    this.isReady = true;
  }

  // True if the device can hold the sums of this many pixels.
  fits(width, height) {
    return PIXEL * width * height <= mostOf(this.passes.device);
  }

  // Allocates the sums of a picture of this size, kept as long as the size is.
  room(width, height) {
    if (this.size[0] === width && this.size[1] === height) {
      return;
    }
    const { device, brought } = this.passes;
    this.sums?.destroy();
    this.size = [width, height];
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
    this.sums = device.createBuffer({ size: PIXEL * width * height, usage });
    this.group = device.createBindGroup({
      layout: this.layout,
      entries: [this.sums, ...this.buffers].map((buffer, binding) => ({ binding, resource: { buffer } })),
    });
    this.picture = device.createBindGroup({
      layout: brought,
      entries: [{ binding: 2, resource: { buffer: this.sums } }],
    });
    this.errors.of(this.sums, width, height);
  }

  // Trace one more path of each pixel in some rows, with its number; `aim` has set the first row.
  trace(rows, sample) {
    const { device, scene } = this.passes;
    device.queue.writeBuffer(this.limits, 0, new Uint32Array([...this.given, this.size[0], sample]));
    const encoder = device.createCommandEncoder();
    const pass = encoder.beginComputePass();
    pass.setPipeline(this.pipeline);
    pass.setBindGroup(0, scene);
    pass.setBindGroup(1, this.group);
    pass.dispatchWorkgroups(Math.ceil(this.size[0] / 8), Math.ceil(rows / 8));
    pass.end();
    device.queue.submit([encoder.finish()]);
  }

  destroy() {
    this.sums?.destroy();
    this.limits.destroy();
    this.errors.destroy();
  }
}
