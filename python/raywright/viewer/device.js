// The browser's graphics processor, and a scene on it.

// Limits requested beyond the defaults, as far as the adapter supports them.
const WANTED = ["maxStorageBufferBindingSize", "maxBufferSize"];

// A device and its name; null if the browser has none.
export async function openDevice() {
  const adapter = await navigator.gpu?.requestAdapter({ powerPreference: "high-performance" });
  if (!adapter) {
    return null;
  }
  const requiredLimits = Object.fromEntries(WANTED.map((name) => [name, adapter.limits[name]]));
  const device = await adapter.requestDevice({ requiredLimits });
  const { vendor, architecture, description, device: model } = adapter.info ?? {};
  const name = description || model || [vendor, architecture].filter(Boolean).join(" ") || "a device without a name";
  return { device, name };
}

// Bytes of the largest array that a device holds.
export const mostOf = ({ limits }) => Math.min(limits.maxStorageBufferBindingSize, limits.maxBufferSize);

// Reason why a device cannot hold arrays of these sizes, by name; null if it can.
export function noRoom(device, arrays) {
  const most = mostOf(device);
  const [name, bytes] = Object.entries(arrays).reduce((a, b) => (a[1] >= b[1] ? a : b));
  const [needs, has] = [bytes, most].map((size) => Math.ceil(size / 2 ** 20));
  return bytes > most ? `${name} of the scene take ${needs} MiB, and this device holds ${has} MiB at once` : null;
}

export function bufferOf(device, data, usage) {
  const size = Math.max(Math.ceil(data.byteLength / 4) * 4, 64);
  const buffer = device.createBuffer({ size, usage: usage | GPUBufferUsage.COPY_DST });
  device.queue.writeBuffer(buffer, 0, data);
  return buffer;
}

// A scene's arrays as buffers, each fetched by name.
export async function upload(device, told, bytesOf) {
  const names = Object.keys(told.arrays);
  const all = await Promise.all(names.map((name) => bytesOf(`arrays/${told.version}/${name}`)));
  const buffers = names.map((name, i) => {
    if (all[i].byteLength !== told.arrays[name]) {
      throw new Error(`${name} did not arrive as they are`);
    }
    // The uniform is small.
    return [name, bufferOf(device, all[i], name === "lit" ? GPUBufferUsage.UNIFORM : GPUBufferUsage.STORAGE)];
  });
  return Object.fromEntries(buffers);
}
