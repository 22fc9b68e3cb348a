// The error of a picture, from sums of its paths: after error.wgsl, the rest of rust/render/src/error.rs, whose
// comments have the reasons.

const GROUPS = 256;
const SUMS = 10;
// Bins of the counts: sightings, jumps and finds, as in error.wgsl.
const JUMPS = 2 * 98;
const FINDS = JUMPS + 128;
const COUNTS = FINDS + 2048;
const LEAST_JUMP = -24;
const LEAST_FIND = (127 - 40) << 5;
const SMALL = 1e-6;
const ONE = 65536;
// Number of samples that may carry more than half of an estimate, and the widest useful interval.
const FEW = 8;
const WIDEST = 30;
const ROUNDING = 1e-12;

// The quantile of a sum of squares of mean 1, with these second and third cumulants, for a normal deviate (Pearson,
// 1959; Wilson and Hilferty, 1931).
function quantile(normal, variance, skewed) {
  const degrees = Math.max((8 * variance ** 3) / skewed ** 2, 1);
  const part = 2 / (9 * degrees);
  const cube = (1 - part + normal * Math.sqrt(part)) ** 3;
  return Math.max(1 + Math.sqrt((variance * degrees) / 2) * (cube - 1), 0.001);
}

// Largest excess of one pixel's error over its estimate, among many, with a probability.
function jump(counts, probability) {
  let expected = 0;
  for (let bin = FINDS - JUMPS - 1; bin >= 0; bin--) {
    expected += counts[JUMPS + bin] / ONE;
    if (expected >= probability) {
      return 2 ** (bin / 2 + 0.25 + LEAST_JUMP);
    }
  }
  return 0;
}

// True if a few finds make more than half of a sum.
function isCarried(counts, sum) {
  const value = new Float32Array(1);
  const bits = new Uint32Array(value.buffer);
  let [left, share] = [FEW, 0];
  for (let bin = COUNTS - FINDS - 1; bin >= 0 && left > 0; bin--) {
    const finds = Math.min(counts[FINDS + bin], left);
    bits[0] = ((LEAST_FIND + bin) << 18) | (1 << 17);
    share += (finds * value[0]) / sum;
    left -= finds;
  }
  return share > 0.5;
}

// The estimate of relMSE from sums and counts, for a number of pixels; null if a pixel has fewer than two paths.
export function estimated(sums, counts, pixels) {
  const all = Array.from({ length: SUMS }, (_, k) => sums.filter((_, i) => i % SUMS === k));
  if (all.pop().reduce((a, b) => Math.min(a, b)) < 2) {
    return null;
  }
  const added = all.map((some) => some.reduce((a, b) => a + b, 0));
  const [error, least, most, alike, own] = added;
  const value = error / (3 * pixels);
  if (value === 0) {
    return { value, low: 0, high: 0, isTrusted: true };
  }
  const [square, cube] = [(most * SMALL) ** 2, (most * SMALL) ** 3];
  const [squares, cubes, rare, rareCubes] = added.slice(5);
  const low = quantile(-1.96, (2 * squares) / square, (8 * cubes) / cube);
  const variance = (2 * squares + rare) / square;
  const high = quantile(1.96, variance, (8 * cubes + rareCubes) / cube);
  const greatest = Math.max(high, Math.exp(1.96 * Math.sqrt(variance)));
  const doubt = 1.96 * Math.sqrt(rare / square);
  const factor = (of, other) => Math.exp(Math.hypot(Math.log(of), doubt, Math.log(other)));
  const upper = factor(greatest, own / alike);
  const beyond = Math.hypot(most * (upper - 1), jump(counts, 0.025));
  const told = { value, low: value / factor(low, least / error), high: (most + beyond) / (3 * pixels) };
  if (!Object.values(told).every(Number.isFinite)) {
    return null;
  }
  const isNarrow = told.high <= WIDEST * told.low;
  return { ...told, isTrusted: value <= ROUNDING || (isNarrow && !isCarried(counts, error)) };
}

export class Errors {
  constructor(device, { brought, error }) {
    this.device = device;
    const { STORAGE, UNIFORM, COPY_SRC, COPY_DST, MAP_READ } = GPUBufferUsage;
    const room = (size, usage) => device.createBuffer({ size, usage });
    this.size = room(16, UNIFORM | COPY_DST);
    this.counts = room(4 * COUNTS, STORAGE | COPY_SRC | COPY_DST);
    this.sums = room(4 * SUMS * GROUPS, STORAGE | COPY_SRC);
    this.told = room(this.counts.size + this.sums.size, MAP_READ | COPY_DST);
    this.code = brought + error;
    const types = ["read-only-storage", "uniform", "storage", "storage"];
    this.layout = device.createBindGroupLayout({
      entries: types.map((type, binding) => ({ binding, visibility: GPUShaderStage.COMPUTE, buffer: { type } })),
    });
  }

  async prepare() {
    const { device } = this;
    const module = device.createShaderModule({ code: this.code });
    const layout = device.createPipelineLayout({ bindGroupLayouts: [this.layout] });
    const pipelines = ["count_sightings", "add_up"].map((entryPoint) =>
      device.createComputePipelineAsync({ layout, compute: { module, entryPoint } }),
    );
    this.pipelines = await Promise.all(pipelines);
  }

  // From now on use these sums of paths, for a picture of this size.
  of(brought, width, height) {
    this.device.queue.writeBuffer(this.size, 0, new Uint32Array([width, height]));
    this.pixels = width * height;
    this.group = this.device.createBindGroup({
      layout: this.layout,
      entries: [brought, this.size, this.counts, this.sums].map((buffer, binding) => ({
        binding,
        resource: { buffer },
      })),
    });
  }

  // The estimate: its value, the ends of its 95 % interval, and whether it is trusted; null if there is none.
  async estimate() {
    const { counts, sums, told } = this;
    const encoder = this.device.createCommandEncoder();
    encoder.clearBuffer(counts);
    const pass = encoder.beginComputePass();
    pass.setBindGroup(0, this.group);
    for (const pipeline of this.pipelines) {
      pass.setPipeline(pipeline);
      pass.dispatchWorkgroups(GROUPS);
    }
    pass.end();
    encoder.copyBufferToBuffer(counts, 0, told, 0, counts.size);
    encoder.copyBufferToBuffer(sums, 0, told, counts.size, sums.size);
    this.device.queue.submit([encoder.finish()]);
    await told.mapAsync(GPUMapMode.READ);
    const bytes = told.getMappedRange().slice(0);
    told.unmap();
    return estimated(new Float32Array(bytes, counts.size), new Uint32Array(bytes, 0, COUNTS), this.pixels);
  }

  destroy() {
    [this.size, this.counts, this.sums, this.told].forEach((buffer) => buffer.destroy());
  }
}
