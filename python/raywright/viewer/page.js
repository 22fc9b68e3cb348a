"use strict";

// Shows what the server renders, and tells it where the camera is moved to.

const START = { azimuth: 0, elevation: 0, zoom: 1, right: 0, up: 0 };
// Degrees for the height of the window, and the factor for a notch of the wheel.
const TURN = 180;
const NOTCH = 1.1;
const ZOOM = [1 / 256, 256];
// Milliseconds after a move of our own in which pictures may still show an earlier view.
const SETTLED = 1000;

const byId = (id) => document.getElementById(id);
const canvas = byId("picture");
const drawing = canvas.getContext("2d");
const clamp = (value, [least, most]) => Math.min(Math.max(value, least), most);

let view = { ...START };
let elevations = [-90, 90];
let movedAt = -Infinity;

// The camera.

// The newest of what is to be told, by where to; what was not sent yet is not worth it any more.
const unsent = new Map();
let sending = false;

async function send(path, body) {
  unsent.set(path, body);
  if (sending) {
    return;
  }
  sending = true;
  while (unsent.size) {
    const [[where, what]] = unsent;
    unsent.delete(where);
    try {
      await fetch(where, {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify(what),
      });
    } catch {
      // The stream of pictures tells when the server is gone.
    }
  }
  sending = false;
}

function move(changes) {
  view = { ...view, ...changes };
  view.elevation = clamp(view.elevation, elevations);
  view.zoom = clamp(view.zoom, ZOOM);
  movedAt = performance.now();
  send("view", view);
}

const scale = () => Math.min(canvas.clientHeight, (canvas.clientWidth * canvas.height) / canvas.width) || 1;

function drag(event) {
  const [x, y] = [event.movementX / scale(), event.movementY / scale()];
  if (event.shiftKey || event.buttons !== 1) {
    move({ right: view.right + x / view.zoom, up: view.up - y / view.zoom });
  } else {
    move({ azimuth: view.azimuth - TURN * x, elevation: view.elevation + TURN * y });
  }
}

canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  canvas.classList.add("moving");
});
canvas.addEventListener("pointermove", (event) => {
  if (canvas.hasPointerCapture(event.pointerId) && (event.movementX || event.movementY)) {
    drag(event);
  }
});
canvas.addEventListener("lostpointercapture", () => canvas.classList.remove("moving"));
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("dblclick", () => move(START));
canvas.addEventListener(
  "wheel",
  (event) => {
    event.preventDefault();
    // In lines or pages, or in pixels, of which there are about a hundred to a notch.
    const notches = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY / 100 : event.deltaY / 3;
    move({ zoom: view.zoom * NOTCH ** -clamp(notches, [-5, 5]) });
  },
  { passive: false },
);
canvas.addEventListener("keydown", (event) => {
  const moves = {
    ArrowLeft: { azimuth: view.azimuth - 5 },
    ArrowRight: { azimuth: view.azimuth + 5 },
    ArrowUp: { elevation: view.elevation + 5 },
    ArrowDown: { elevation: view.elevation - 5 },
    "+": { zoom: view.zoom * NOTCH },
    "-": { zoom: view.zoom / NOTCH },
    0: START,
  };
  if (event.key in moves && !event.ctrlKey && !event.metaKey && !event.altKey) {
    event.preventDefault();
    move(moves[event.key]);
  }
});
byId("reset").addEventListener("click", () => move(START));

// The window: as many pixels as it has room for, once it keeps its size for a moment.

let fits = false;
let resizing = 0;

function fit() {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((size) => clamp(Math.round(size), [16, 4096]));
  if (fits) {
    send("window", { width, height });
  }
}

new ResizeObserver(() => {
  clearTimeout(resizing);
  resizing = setTimeout(fit, 100);
}).observe(canvas);

// How it is shown, and what it is seen by.

const exposure = byId("exposure");
let cameraLine = "";
let boxes = null;

function expose(stops) {
  exposure.value = stops;
  byId("stops").textContent = exposure.value;
}

exposure.addEventListener("input", () => {
  expose(exposure.value);
  send("exposure", { exposure: Number(exposure.value) });
});

async function copyCamera() {
  try {
    await navigator.clipboard.writeText(cameraLine);
    byId("message").textContent = `copied: ${cameraLine}`;
  } catch {
    byId("message").textContent = cameraLine;
  }
}

byId("copy").addEventListener("click", copyCamera);
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) {
    return;
  }
  if (event.key === "[" || event.key === "]") {
    exposure[event.key === "]" ? "stepUp" : "stepDown"]();
    exposure.dispatchEvent(new Event("input"));
  } else if (event.key === "c") {
    copyCamera();
  } else if (event.key === "b" || event.key === "B") {
    // One level deeper, or back; beyond the last the server shows none.
    const next = boxes === null ? 0 : boxes + (event.key === "b" ? 1 : -1);
    send("boxes", { depth: next < 0 ? null : next });
  }
});

// The picture.

async function draw({ picture: { type, data }, size }) {
  const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
  const bitmap = await createImageBitmap(new Blob([bytes], { type }));
  if (canvas.width !== size[0] || canvas.height !== size[1]) {
    [canvas.width, canvas.height] = size;
  }
  drawing.imageSmoothingQuality = "high";
  drawing.drawImage(bitmap, 0, 0, canvas.width, canvas.height);
  bitmap.close();
}

const short = (value) => (value === null ? "–" : value.toPrecision(3));

function tell(frame) {
  document.body.dataset.state = frame.state;
  cameraLine = frame.camera;
  boxes = frame.boxes;
  const told = boxes === null ? [] : [`boxes ${boxes} ${boxes === 1 ? "step" : "steps"} from the root`];
  byId("message").textContent = [...told, ...frame.warnings].join(" · ");
  const isPreview = frame.state === "preview";
  byId("samples").textContent = isPreview ? "preview" : frame.samples;
  byId("seconds").textContent = frame.seconds.toFixed(1);
  // That of a smaller picture says nothing of this one.
  const [error, low, high] = isPreview ? [null, null, null] : frame.error;
  byId("error").textContent = short(error) + (frame.trusted ? "" : " ?");
  byId("interval").textContent = low === null ? "" : `${short(low)} to ${short(high)}`;
}

// Error against time, both by their logarithms: it falls along a straight line.

const curve = byId("history");
let history = [];
let historyOf = "";

function remember(frame) {
  const key = JSON.stringify([frame.view, frame.size]);
  if (key !== historyOf || (history.length && frame.seconds < history[history.length - 1][0])) {
    [history, historyOf] = [[], key];
  }
  // It is estimated once a pass, and pictures come more often.
  const isNew = !history.length || history[history.length - 1][1] !== frame.error[0];
  if (frame.state !== "preview" && frame.error[0] > 0 && isNew) {
    history.push([frame.seconds, frame.error[0]]);
  }
  plot();
}

function plot() {
  const [width, height, margin] = [curve.width, curve.height, 6];
  const lines = curve.getContext("2d");
  lines.clearRect(0, 0, width, height);
  if (history.length < 2) {
    return;
  }
  const logs = history.map((row) => row.map(Math.log));
  const place = (axis, size) => {
    const values = logs.map((row) => row[axis]);
    const [least, most] = [Math.min(...values), Math.max(...values)];
    return (value) => margin + ((value - least) / (most - least || 1)) * (size - 2 * margin);
  };
  const [x, y] = [place(0, width), place(1, height)];
  const style = getComputedStyle(document.body);
  lines.strokeStyle = style.getPropertyValue("--mark");
  lines.lineWidth = 3;
  lines.lineJoin = "round";
  lines.beginPath();
  logs.forEach(([seconds, error]) => lines.lineTo(x(seconds), height - y(error)));
  lines.stroke();
}

// The server.

const events = new EventSource("events");

// The last picture that came; earlier ones that are not shown yet are not worth it any more.
let pending = null;
let showing = false;

async function show() {
  if (showing) {
    return;
  }
  showing = true;
  while (pending) {
    const frame = pending;
    pending = null;
    await draw(frame);
    tell(frame);
    remember(frame);
    canvas.dataset.number = frame.number;
    canvas.dataset.exposure = frame.exposure;
    canvas.dataset.boxes = frame.boxes;
  }
  showing = false;
}

events.addEventListener("scene", (event) => {
  const scene = JSON.parse(event.data);
  elevations = scene.elevations;
  fits = scene.fits;
  expose(scene.exposure);
  fit();
  if (canvas.width !== scene.width || canvas.height !== scene.height) {
    [canvas.width, canvas.height] = [scene.width, scene.height];
  }
});
events.addEventListener("frame", (event) => {
  pending = JSON.parse(event.data);
  if (performance.now() - movedAt > SETTLED) {
    // Another page may have moved the camera, or this one before it was loaded anew.
    view = pending.view;
  }
  show();
});
events.addEventListener("trouble", (event) => {
  events.close();
  document.body.dataset.state = "ended";
  byId("message").textContent = JSON.parse(event.data).line;
});
events.addEventListener("error", () => {
  if (document.body.dataset.state !== "ended") {
    document.body.dataset.state = "waiting";
    byId("message").textContent = "The viewer has ended; the picture is as it was.";
  }
});
