// The common part of both connections to the core.

export class Wire {
  constructor() {
    this.on = {};
    // The latest message of each kind; older unsent ones are obsolete.
    this.unsent = new Map();
    this.isSending = false;
  }

  // Send a message, once all earlier ones have arrived.
  async send(what, given) {
    this.unsent.set(what, given);
    if (this.isSending) {
      return;
    }
    this.isSending = true;
    while (this.unsent.size) {
      const [[name, newest]] = this.unsent;
      this.unsent.delete(name);
      try {
        await this.ask(name, newest);
      } catch {
        // Pictures show whether the core still exists.
      }
    }
    this.isSending = false;
  }
}
