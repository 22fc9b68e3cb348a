// The figures of a picture: samples, seconds, error, and the curve of the error.

const short = (value) => (value === null ? "–" : value.toPrecision(3));

export class Figures {
  // Uses a page's elements, by name.
  constructor(byId) {
    this.byId = byId;
    this.forget();
  }

  // `error` has a value, `low`, `high`, and whether it `isTrusted`, or is null if unknown; `of` identifies the picture.
  tell({ samples, seconds, error, of }) {
    this.byId("samples").textContent = samples;
    this.byId("seconds").textContent = seconds.toFixed(seconds < 0.1 ? 3 : 1);
    this.byId("error").textContent = short(error?.value ?? null) + (!error || error.isTrusted ? "" : " ?");
    this.byId("interval").textContent = error ? `${short(error.low)} to ${short(error.high)}` : "";
    this.remember(seconds, error, JSON.stringify(of));
  }

  // The curve belongs to a picture no longer shown.
  forget() {
    [this.history, this.historyOf] = [[], ""];
    this.byId("error").textContent = "–";
    this.byId("interval").textContent = "";
    this.plot();
  }

  // Error against time, both as logarithms: it falls along a straight line.
  remember(seconds, error, of) {
    const last = this.history[this.history.length - 1];
    if (of !== this.historyOf || (last && seconds < last[0])) {
      [this.history, this.historyOf] = [[], of];
    }
    // Estimates come less often than pictures.
    const isNew = this.history[this.history.length - 1]?.[1] !== error?.value;
    if (error?.value > 0 && isNew) {
      this.history.push([seconds, error.value]);
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
