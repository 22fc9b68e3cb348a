// Paths through a scene, a pass over the picture at a time, in bands of rows: no device is kept busy for long.

import { bufferOf } from "./device.js";

const NAMES = ["faces", "materials", "lights", "numbers"];

export class Paths {
  // Beside other passes, whose scene they see.
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
  }

  async prepare() {
    const { device, beginning, texts, layout } = this.passes;
    const module = device.createShaderModule({ code: beginning + texts.shading + texts.path });
    this.pipeline = await device.createComputePipelineAsync({
      layout: device.createPipelineLayout({ bindGroupLayouts: [layout, this.layout] }),
      compute: { module, entryPoint: "accumulate" },
    });
  }

  // Room for the sums of a picture of so many pixels, kept as long as it has these.
  room(width, height) {
    if (this.size[0] === width && this.size[1] === height) {
      return;
    }
    const { device, brought } = this.passes;
    this.sums?.destroy();
    this.size = [width, height];
    this.sums = device.createBuffer({ size: 16 * width * height, usage: GPUBufferUsage.STORAGE });
    this.group = device.createBindGroup({
      layout: this.layout,
      entries: [this.sums, ...this.buffers].map((buffer, binding) => ({ binding, resource: { buffer } })),
    });
    this.picture = device.createBindGroup({
      layout: brought,
      entries: [{ binding: 2, resource: { buffer: this.sums } }],
    });
  }

  // One path more of each pixel in so many rows, the how manieth; from which row on was told by `aim`.
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
  }
}
