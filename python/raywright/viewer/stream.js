// Pictures rendered by the core, as they arrive.

export class Stream {
  // Uses a page's elements, by name; `shown` is called with each picture shown.
  constructor(byId, shown) {
    this.byId = byId;
    this.canvas = byId("picture");
    this.drawing = this.canvas.getContext("2d");
    this.shown = shown;
    // The latest picture; earlier ones not shown yet are obsolete.
    this.pending = null;
    this.isShowing = false;
  }

  resize(width, height) {
    if (this.canvas.width !== width || this.canvas.height !== height) {
      [this.canvas.width, this.canvas.height] = [width, height];
    }
  }

  // Show a picture: the core's figures of it, and the bytes of its file.
  async show(frame, bytes) {
    this.pending = [frame, bytes];
    if (this.isShowing) {
      return;
    }
    this.isShowing = true;
    while (this.pending) {
      const [frame, bytes] = this.pending;
      this.pending = null;
      const bitmap = await createImageBitmap(new Blob([bytes], { type: frame.type }));
      this.resize(...frame.size);
      this.drawing.imageSmoothingQuality = "high";
      this.drawing.drawImage(bitmap, 0, 0, this.canvas.width, this.canvas.height);
      bitmap.close();
      this.shown(frame);
      Object.assign(this.canvas.dataset, { number: frame.number, exposure: frame.exposure, boxes: frame.boxes });
    }
    this.isShowing = false;
  }
}
