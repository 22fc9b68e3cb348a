// The viewer in a notebook: requests by the widget's messages, which reach remote kernels too.

import { Viewer } from "./viewer.js";
import { Wire } from "./wire.js";

// Milliseconds in which a live kernel answers.
const SILENCE = 5000;

class Comm extends Wire {
  constructor(model) {
    super();
    this.model = model;
    // A widget may be shown several times, and each view receives all messages.
    this.page = crypto.getRandomValues(new Uint32Array(1))[0];
    this.asked = new Map();
    this.count = 0;
    this.isWatching = false;
    this.hear = this.hear.bind(this);
    model.on("msg:custom", this.hear);
    model.on("comm_live_update", this.seek);
  }

  say(content) {
    this.model.send({ page: this.page, ...content });
  }

  // Send a message, and wait for the kernel's answer and its bytes.
  async exchange(content) {
    const id = (this.count += 1);
    const answer = new Promise((done) => this.asked.set(id, done));
    this.say({ ...content, id });
    const [{ told, error, total }, buffers] = await answer;
    if (error !== undefined) {
      throw new Error(error);
    }
    // A view of some bytes, or all of them, depending on the notebook.
    const [data] = buffers;
    const bytes = data && new Uint8Array(data.buffer ?? data, data.byteOffset ?? 0, data.byteLength);
    return { told, total, bytes };
  }

  ask = async (what, given) => (await this.exchange({ do: "ask", what, given })).told;

  // In parts, since messages should not be large.
  bytes = async (name) => {
    let all = null;
    let start = 0;
    do {
      const { total, bytes } = await this.exchange({ do: "bytes", name, start });
      all ??= new Uint8Array(total);
      all.set(bytes, start);
      start += bytes.byteLength;
    } while (start < all.byteLength);
    return all.buffer;
  };

  text = async (name) => new TextDecoder().decode(await this.bytes(name));

  // A notebook reports that it has lost the kernel, or found it again, but not which. A restarted kernel does not know
  // earlier widgets.
  seek = async () => {
    const answered = this.ask("scene", {}).then(
      () => true,
      () => false,
    );
    const late = new Promise((done) => setTimeout(done, SILENCE, false));
    if (!(await Promise.race([answered, late]))) {
      this.on.ended();
    }
  };

  watch(isOn) {
    if (this.isWatching !== isOn) {
      this.isWatching = isOn;
      this.say({ do: "watch", on: isOn });
    }
  }

  hear(content, buffers) {
    if (content.page !== undefined && content.page !== this.page) {
      return;
    }
    if (content.answer !== undefined) {
      this.asked.get(content.answer)?.([content, buffers]);
      this.asked.delete(content.answer);
    } else if (content.frame) {
      // The next picture comes after this confirmation.
      this.say({ do: "seen" });
      this.on.frame(content.frame, buffers[0]);
    } else if (content.again) {
      this.on.again();
    } else if (content.view && content.from !== this.page) {
      this.on.view(content.view);
    } else if (content.trouble) {
      this.on.trouble(content.trouble);
    } else if (content.ended) {
      this.on.ended();
    }
  }

  async open() {
    this.on.scene(await this.ask("scene", {}));
  }

  close() {
    this.watch(false);
    this.model.off("msg:custom", this.hear);
    this.model.off("comm_live_update", this.seek);
  }
}

function render({ model, el }) {
  const root = el.attachShadow({ mode: "open" });
  const style = document.createElement("style");
  style.textContent = model.get("_style");
  const host = document.createElement("div");
  host.className = "viewer";
  host.style.height = `${model.get("height")}px`;
  host.innerHTML = model.get("_parts");
  root.append(style, host);
  // Keys belong to the viewer, not to the notebook.
  el.dataset.lmSuppressShortcuts = "true";
  // A notebook may keep keyboard focus in place after a click elsewhere.
  const leave = (event) => event.composedPath().includes(el) || root.activeElement?.blur();
  document.addEventListener("pointerdown", leave, true);
  const wire = new Comm(model);
  const viewer = new Viewer(root, host, host, wire);
  host.viewer = viewer;
  wire.open();
  return () => {
    document.removeEventListener("pointerdown", leave, true);
    viewer.close();
  };
}

export default { render };
