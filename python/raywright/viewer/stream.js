// The pictures that the core renders, as they come, and what there is to say of them.

const short = (value) => (value === null ? "–" : value.toPrecision(3));

export class Stream {
  // On a page's parts, by their names; `shown` is called with each picture that was.
  constructor(byId, shown) {
    this.byId = byId;
    this.canvas = byId("picture");
    this.drawing = this.canvas.getContext("2d");
    this.shown = shown;
    // The last picture that came; earlier ones that are not shown yet are not worth it any more.
    this.pending = null;
    this.isShowing = false;
    this.history = [];
    this.historyOf = "";
  }

  resize(width, height) {
    if (this.canvas.width !== width || this.canvas.height !== height) {
      [this.canvas.width, this.canvas.height] = [width, height];
    }
  }

  // Show a picture: what the core tells of it, and the bytes of its file.
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

  tell(frame) {
    const isPreview = frame.state === "preview";
    this.byId("samples").textContent = isPreview ? "preview" : frame.samples;
    this.byId("seconds").textContent = frame.seconds.toFixed(1);
    // That of a smaller picture says nothing of this one.
    const [error, low, high] = isPreview ? [null, null, null] : frame.error;
    this.byId("error").textContent = short(error) + (frame.trusted ? "" : " ?");
    this.byId("interval").textContent = low === null ? "" : `${short(low)} to ${short(high)}`;
    this.remember(frame);
  }

  // The curve is that of a picture that is shown no more.
  forget() {
    this.history = [];
    this.plot();
  }

  // Error against time, both by their logarithms: it falls along a straight line.
  remember(frame) {
    const key = JSON.stringify([frame.view, frame.size]);
    const last = this.history[this.history.length - 1];
    if (key !== this.historyOf || (last && frame.seconds < last[0])) {
      [this.history, this.historyOf] = [[], key];
    }
    // It is estimated once a pass, and pictures come more often.
    const isNew = !this.history.length || this.history[this.history.length - 1][1] !== frame.error[0];
    if (frame.state !== "preview" && frame.error[0] > 0 && isNew) {
      this.history.push([frame.seconds, frame.error[0]]);
    }
    this.plot();
  }

  plot() {
    const curve = this.byId("history");
    const [width, height, margin] = [curve.width, curve.height, 6];
    const lines = curve.getContext("2d");
    lines.clearRect(0, 0, width, height);
    if (this.history.length < 2) {
      return;
    }
    const logs = this.history.map((row) => row.map(Math.log));
    const place = (axis, size) => {
      const values = logs.map((row) => row[axis]);
      const [least, most] = [Math.min(...values), Math.max(...values)];
      return (value) => margin + ((value - least) / (most - least || 1)) * (size - 2 * margin);
    };
    const [x, y] = [place(0, width), place(1, height)];
    lines.strokeStyle = getComputedStyle(curve).getPropertyValue("--mark");
    lines.lineWidth = 3;
    lines.lineJoin = "round";
    lines.beginPath();
    logs.forEach(([seconds, error]) => lines.lineTo(x(seconds), height - y(error)));
    lines.stroke();
  }
}
