// Render passes for a scene's pictures, and the assembly of their kernels.

import { bufferOf } from "./device.js";
import { Paths } from "./paths.js";

const FLOATS = 52;

// The common start of all kernels, for a tree of some depth: the stack holds one child per level.
const beginning = ({ walk, sight }, depth) =>
  walk.replaceAll("STACK", `${Math.floor(depth / 32) * 32 + 32}u`) + sight;

export class Passes {
  // For a device, a canvas of some format, a scene from the core, its buffers, and the kernels' texts.
  constructor(device, format, told, buffers, texts) {
    this.device = device;
    this.format = format;
    this.told = told;
    this.buffers = buffers;
    this.beginning = beginning(texts, told.depth);
    const uniform = GPUBufferUsage.UNIFORM;
    this.look = bufferOf(device, new Float32Array(FLOATS), uniform);
    const both = GPUShaderStage.FRAGMENT | GPUShaderStage.COMPUTE;
    const read = { visibility: both, buffer: { type: "read-only-storage" } };
    const aimed = { visibility: both | GPUShaderStage.VERTEX, buffer: { type: "uniform" } };
    this.layout = device.createBindGroupLayout({
      entries: [read, read, read, aimed].map((kind, binding) => ({ binding, ...kind })),
    });
    const bound = [buffers.nodes, buffers.triangles, buffers.paints, this.look];
    this.scene = device.createBindGroup({
      layout: this.layout,
      entries: bound.map((buffer, binding) => ({ binding, resource: { buffer } })),
    });
    this.sampler = device.createSampler({ magFilter: "linear", minFilter: "linear" });
    this.texts = texts;
    this.boxes = null;
  }

  // Compile the kernels needed at once.
  async prepare() {
    const { device } = this;
    const screen = device.createShaderModule({ code: this.beginning + this.texts.brought + this.texts.screen });
    const lines = device.createShaderModule({ code: this.beginning + this.texts.lines });
    const read = GPUShaderStage.FRAGMENT;
    this.pictures = device.createBindGroupLayout({
      entries: [
        { binding: 0, visibility: read, texture: {} },
        { binding: 1, visibility: read, sampler: {} },
      ],
    });
    this.corners = device.createBindGroupLayout({
      entries: [{ binding: 0, visibility: GPUShaderStage.VERTEX, buffer: { type: "read-only-storage" } }],
    });
    const drawing = (module, vertex, fragment, more, format, topology = "triangle-list") =>
      device.createRenderPipelineAsync({
        layout: device.createPipelineLayout({ bindGroupLayouts: [this.layout, ...more] }),
        vertex: { module, entryPoint: vertex },
        fragment: { module, entryPoint: fragment, targets: [{ format }] },
        primitive: { topology },
      });
    this.brought = device.createBindGroupLayout({
      entries: [{ binding: 2, visibility: read, buffer: { type: "read-only-storage" } }],
    });
    this.paths = this.buffers.faces ? new Paths(this) : null;
    [this.sight, this.shown, this.line, this.developed] = await Promise.all([
      drawing(screen, "whole", "sight", [], "rgba8unorm"),
      drawing(screen, "whole", "shown", [this.pictures], this.format),
      drawing(lines, "edge", "line", [this.corners], this.format, "line-list"),
      drawing(screen, "whole", "developed", [this.brought], this.format),
    ]);
  }

  // View and display settings: numbers for the kernels, in box units.
  aim({ origins, ways, inverse, parallel, lamp, width, height, gain, brightest, mode, tone, row, behind }) {
    const numbers = new Float32Array(FLOATS);
    [...origins, ...ways, ...inverse].forEach((vector, i) => numbers.set(vector, 4 * i));
    numbers[3] = parallel ? 1 : 0;
    numbers.set(lamp, 36);
    numbers.set([width, height, gain, brightest], 40);
    numbers.set(behind, 48);
    new Uint32Array(numbers.buffer).set([mode, tone, row, this.told.nodes], 44);
    this.device.queue.writeBuffer(this.look, 0, numbers);
  }

  // A texture for a picture of this size, kept as long as the size is.
  target(width, height) {
    if (this.texture?.width !== width || this.texture.height !== height) {
      this.texture?.destroy();
      const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING;
      this.texture = this.device.createTexture({ size: [width, height], format: "rgba8unorm", usage });
      this.picture = this.device.createBindGroup({
        layout: this.pictures,
        entries: [
          { binding: 0, resource: this.texture.createView() },
          { binding: 1, resource: this.sampler },
        ],
      });
    }
    return this.texture.createView();
  }

  pass(encoder, view, loadOp, draw) {
    const attachment = { view, loadOp, storeOp: "store", clearValue: [0, 0, 0, 1] };
    const pass = encoder.beginRenderPass({ colorAttachments: [attachment] });
    pass.setBindGroup(0, this.scene);
    draw(pass);
    pass.end();
  }

  // One ray per pixel into a texture of this size.
  drawSight(width, height) {
    const encoder = this.device.createCommandEncoder();
    this.pass(encoder, this.target(width, height), "clear", (pass) => {
      pass.setPipeline(this.sight);
      pass.draw(3);
    });
    this.device.queue.submit([encoder.finish()]);
  }

  // That texture, or the sums of paths, on a canvas, and boxes over it.
  present(view, isTraced) {
    const encoder = this.device.createCommandEncoder();
    this.pass(encoder, view, "clear", (pass) => {
      pass.setPipeline(isTraced ? this.developed : this.shown);
      pass.setBindGroup(1, isTraced ? this.paths.picture : this.picture);
      pass.draw(3);
      if (this.boxes) {
        pass.setPipeline(this.line);
        pass.setBindGroup(1, this.boxes.group);
        pass.draw(24, this.boxes.count);
      }
    });
    this.device.queue.submit([encoder.finish()]);
  }

  // Set the boxes drawn over pictures: their corners, or null.
  box(corners) {
    this.boxes?.buffer.destroy();
    this.boxes = null;
    if (corners?.byteLength) {
      const buffer = bufferOf(this.device, corners, GPUBufferUsage.STORAGE);
      const group = this.device.createBindGroup({
        layout: this.corners,
        entries: [{ binding: 0, resource: { buffer } }],
      });
      this.boxes = { buffer, group, count: corners.byteLength / 96 };
    }
  }

  destroy() {
    this.texture?.destroy();
    this.paths?.destroy();
    [this.look, this.boxes?.buffer, ...Object.values(this.buffers)].forEach((buffer) => buffer?.destroy());
  }
}
