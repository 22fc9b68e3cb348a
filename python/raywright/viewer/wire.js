// The way to the core, of which there are two kinds: what both have.

export class Wire {
  constructor() {
    this.on = {};
    // The newest of what is to be told, by what it is of; what was not sent yet is not worth it any more.
    this.unsent = new Map();
    this.isSending = false;
  }

  // Tell something, once all that was told before has arrived.
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
        // Whether the core is still there is told by its pictures.
      }
    }
    this.isSending = false;
  }
}
