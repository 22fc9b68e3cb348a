// The page of the viewer's server: requests by HTTP, and server-sent events.

import { Viewer } from "./viewer.js";
import { Wire } from "./wire.js";

class Server extends Wire {
  constructor() {
    super();
    this.hasFile = true;
    this.events = null;
    this.isWatching = null;
    this.isKnown = false;
  }

  async ask(what, given) {
    const headers = { "Content-Type": "application/json" };
    const answer = await fetch(what, { method: "POST", headers, body: JSON.stringify(given) });
    if (!answer.ok) {
      throw new Error((await answer.text()).trim());
    }
    return answer.status === 204 ? null : answer.json();
  }

  async answered(name) {
    const answer = await fetch(name);
    if (!answer.ok) {
      throw new Error(`the server has no ${name}`);
    }
    return answer;
  }

  bytes = async (name) => (await this.answered(name)).arrayBuffer();

  text = async (name) => (await this.answered(name)).text();

  // Receive pictures, for which the core has to render, or only views.
  watch(isOn) {
    if (this.isWatching === isOn) {
      return;
    }
    this.isWatching = isOn;
    this.events?.close();
    const events = new EventSource(isOn ? "events" : "news");
    this.events = events;
    const hear = (name, tell) => events.addEventListener(name, (event) => tell(JSON.parse(event.data)));
    hear("scene", (scene) => {
      if (!this.isKnown) {
        this.isKnown = true;
        this.on.scene(scene);
      }
    });
    hear("again", () => this.on.again());
    hear("view", (view) => this.on.view(view));
    hear("frame", ({ picture, ...frame }) => {
      const bytes = Uint8Array.from(atob(picture.data), (letter) => letter.charCodeAt(0));
      this.on.frame({ ...frame, type: picture.type }, bytes);
    });
    hear("trouble", ({ line }) => {
      events.close();
      this.on.trouble(line);
    });
    events.addEventListener("error", () => {
      if (this.events === events) {
        // If the server returns, the page begins anew.
        this.isKnown = false;
        this.on.ended();
      }
    });
  }

  close() {
    this.events?.close();
  }
}

window.viewer = new Viewer(document, document.body, document, new Server());
