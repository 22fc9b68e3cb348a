// The page of the viewer's server: asks it by HTTP, and hears of it by server-sent events.

import { Viewer } from "./viewer.js";

class Wire {
  constructor() {
    this.on = {};
    // The newest of what is to be told, by where to; what was not sent yet is not worth it any more.
    this.unsent = new Map();
    this.isSending = false;
    this.events = null;
    this.isWatching = null;
  }

  post(path, given) {
    const headers = { "Content-Type": "application/json" };
    return fetch(path, { method: "POST", headers, body: JSON.stringify(given) });
  }

  async send(path, given) {
    this.unsent.set(path, given);
    if (this.isSending) {
      return;
    }
    this.isSending = true;
    while (this.unsent.size) {
      const [[where, what]] = this.unsent;
      this.unsent.delete(where);
      try {
        await this.post(where, what);
      } catch {
        // The stream of pictures tells when the server is gone.
      }
    }
    this.isSending = false;
  }

  async ask(path, given) {
    const answer = await this.post(path, given);
    if (!answer.ok) {
      throw new Error((await answer.text()).trim());
    }
    return answer.json();
  }

  bytes = async (name) => this.answered(await fetch(name)).arrayBuffer();

  text = async (name) => this.answered(await fetch(name)).text();

  answered(answer) {
    if (!answer.ok) {
      throw new Error(`${answer.url} is not there`);
    }
    return answer;
  }

  // Hear of pictures, for which the core has to render, or only of where they are from.
  watch(isOn) {
    if (this.isWatching === isOn) {
      return;
    }
    this.isWatching = isOn;
    this.events?.close();
    const events = new EventSource(isOn ? "events" : "news");
    this.events = events;
    const hear = (name, tell) => events.addEventListener(name, (event) => tell(JSON.parse(event.data)));
    let isFirst = true;
    hear("scene", (scene) => {
      // Of a stream that was left and is heard again it is known.
      if (!this.isKnown || !isFirst) {
        this.isKnown = true;
        this.on.scene(scene);
      }
      isFirst = false;
    });
    hear("view", (view) => this.on.view(view));
    hear("frame", ({ picture, ...frame }) => {
      const bytes = Uint8Array.from(atob(picture.data), (letter) => letter.charCodeAt(0));
      this.on.frame({ ...frame, type: picture.type }, bytes);
    });
    hear("trouble", ({ line }) => {
      events.close();
      this.on.trouble(line);
    });
    events.addEventListener("error", () => this.events === events && this.on.ended());
  }
}

window.viewer = new Viewer(document, document.body, document, new Wire());
