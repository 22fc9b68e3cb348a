// Mouse and keys, and their actions.

import { START, clamp } from "./orbit.js";

// Degrees for the height of the window, and the factor for a notch of the wheel.
const TURN = 180;
const NOTCH = 1.1;
// Pixels that the mouse may move within a click.
const SLIP = 3;

// Position of an event in the picture of a canvas, which keeps its aspect, from (0, 0) to (1, 1); null beside it.
function placeOf(canvas, event) {
  const { left, top, width, height } = canvas.getBoundingClientRect();
  const scale = Math.min(width / canvas.width, height / canvas.height);
  const x = (event.clientX - left - width / 2) / (scale * canvas.width) + 0.5;
  const y = (event.clientY - top - height / 2) / (scale * canvas.height) + 0.5;
  return x >= 0 && x < 1 && y >= 0 && y < 1 ? { x, y } : null;
}

const isPlain = (event) => !event.ctrlKey && !event.metaKey && !event.altKey;

// Listen to a canvas: `view` returns the camera's view, `move` is called with changes, `pick` with a position.
export function listen(canvas, { view, move, pick }) {
  const scale = () => Math.min(canvas.clientHeight, (canvas.clientWidth * canvas.height) / canvas.width) || 1;
  let slipped = 0;

  function drag(event) {
    const [x, y] = [event.movementX / scale(), event.movementY / scale()];
    const now = view();
    if (event.shiftKey || event.buttons !== 1) {
      move({ right: now.right + x / now.zoom, up: now.up - y / now.zoom });
    } else {
      move({ azimuth: now.azimuth - TURN * x, elevation: now.elevation + TURN * y });
    }
  }

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.classList.add("moving");
    slipped = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (canvas.hasPointerCapture(event.pointerId) && (event.movementX || event.movementY)) {
      slipped += Math.abs(event.movementX) + Math.abs(event.movementY);
      drag(event);
    }
  });
  canvas.addEventListener("click", (event) => {
    const place = placeOf(canvas, event);
    if (slipped <= SLIP && place) {
      pick(place);
    }
  });
  canvas.addEventListener("lostpointercapture", () => canvas.classList.remove("moving"));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("dblclick", () => move(START));
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      // In lines or pages, or in pixels, about a hundred per notch.
      const notches = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY / 100 : event.deltaY / 3;
      move({ zoom: view().zoom * NOTCH ** -clamp(notches, [-5, 5]) });
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    const now = view();
    const moves = {
      ArrowLeft: { azimuth: now.azimuth - 5 },
      ArrowRight: { azimuth: now.azimuth + 5 },
      ArrowUp: { elevation: now.elevation + 5 },
      ArrowDown: { elevation: now.elevation - 5 },
      "+": { zoom: now.zoom * NOTCH },
      "-": { zoom: now.zoom / NOTCH },
      0: START,
    };
    if (event.key in moves && isPlain(event)) {
      event.preventDefault();
      event.stopPropagation();
      move(moves[event.key]);
    }
  });
}

// Listen to keys anywhere within an element: an action by name of the key.
export function listenToKeys(target, actions) {
  target.addEventListener("keydown", (event) => {
    if (event.key in actions && isPlain(event)) {
      event.stopPropagation();
      actions[event.key]();
    }
  });
}
