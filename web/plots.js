// Plots of the last minute on one time axis, with a cursor that all of them share.

import { byId, make, setText } from "./dom.js";
import { PLOTS, SPAN_S, linesOf, remember, valueAt } from "./history.js";
import { known } from "./state.js";
import { loadPainter } from "./uplot_plots.js";
import { figure } from "./words.js";

const DASHES = [[], [6, 3], [2, 2], [8, 3, 2, 3], [12, 4], [1, 3]];
const PADDING_PX = { top: 6, bottom: 4, left: 0, right: 0 };

/** Seconds before now that the cursor stands at, or null for now. @type {number | null} */
let cursorS = null;

/** @type {{canvas: HTMLCanvasElement, legend: HTMLElement, scale: HTMLElement}[]} */
let made = [];

/** Plots by uPlot, where this build has it. @type {import("./uplot_plots.js").Painter | null} */
let painter = null;

/** @param {any} camera */
export function samplePlots(camera) {
  remember(camera, performance.now());
}

function makePlots() {
  made = PLOTS.map((plot) => {
    const canvas = make("canvas", "area");
    canvas.setAttribute("role", "img");
    const legend = make("ul", "legend plain");
    const scale = make("span", "scale quiet");
    const title = make("h3", "", plot.name, plot.unit ? make("span", "unit", ` ${plot.unit}`) : "");
    byId("plots").append(make("figure", "plot", make("figcaption", "", title, scale), canvas, legend));
    return { canvas, legend, scale };
  });
  const grid = byId("plots");
  grid.tabIndex = 0;
  grid.setAttribute("role", "group");
  grid.setAttribute("aria-label", "Plots; left and right arrow move the cursor, Escape returns to now");
  grid.addEventListener("pointermove", onPointer);
  grid.addEventListener("pointerleave", () => moveCursor(null));
  grid.addEventListener("keydown", onKey);
  void loadPainter().then((found) => {
    painter = found;
    byId("plots-note").hidden = found !== null;
  });
}

/** @param {PointerEvent} event */
function onPointer(event) {
  const area = event.target instanceof Element ? event.target.closest(".area") : null;
  if (!area) return;
  const box = area.getBoundingClientRect();
  moveCursor(SPAN_S * (1 - (event.clientX - box.left) / box.width));
}

/** @param {KeyboardEvent} event */
function onKey(event) {
  const steps = { ArrowLeft: 1, ArrowRight: -1, PageUp: 10, PageDown: -10 };
  const step = steps[/** @type {keyof typeof steps} */ (event.key)];
  if (event.key === "Escape") moveCursor(null);
  else if (step) moveCursor((cursorS ?? 0) + step);
  else return;
  event.preventDefault();
}

/** @param {number | null} seconds */
function moveCursor(seconds) {
  cursorS = seconds === null || seconds <= 0 ? null : Math.min(seconds, SPAN_S);
  drawPlots();
}

/** Draws what is known now. */
export function drawPlots() {
  if (made.length === 0) makePlots();
  const now = performance.now();
  setText(byId("plot-moment"), cursorS === null ? "now" : `${cursorS.toFixed(0)} s ago`);
  const style = getComputedStyle(document.documentElement);
  PLOTS.forEach((plot, index) => {
    const lines = known.camera ? linesOf(known.camera, index, now) : [];
    drawPlot(made[index], plot, lines, now, style);
  });
}

/**
 * @param {(typeof made)[number]} place @param {(typeof PLOTS)[number]} plot
 * @param {[string, import("./history.js").Sample[]][]} lines @param {number} now @param {CSSStyleDeclaration} style
 */
function drawPlot({ canvas, legend, scale }, plot, lines, now, style) {
  const [low, high] = plot.top ? [0, plot.top] : range(lines);
  setText(scale, lines.length > 0 ? `${low.toFixed(plot.digits)} to ${high.toFixed(plot.digits)}` : "no data");
  const colours = lines.map(([name], index) => lineColour(name, index, style));
  showLegend(legend, plot, lines, colours, now);
  if (painter) {
    painter.draw(canvas, { plot, lines, colours, dashes: DASHES, low, high, now, cursorS, style });
    return;
  }
  const pen = fit(canvas);
  if (!pen) return;
  const { width, height } = canvas.getBoundingClientRect();
  const x = (/** @type {number} */ at) => width * (1 - (now - at) / (SPAN_S * 1000));
  const y = (/** @type {number} */ value) =>
    height - PADDING_PX.bottom - ((value - low) / (high - low || 1)) * (height - PADDING_PX.top - PADDING_PX.bottom);
  pen.clearRect(0, 0, width, height);
  drawGrid(pen, width, height, style);
  lines.forEach(([, samples], index) => {
    pen.strokeStyle = colours[index];
    pen.setLineDash(DASHES[index]);
    drawLine(pen, samples, x, y);
  });
  if (cursorS !== null) drawCursor(pen, width * (1 - cursorS / SPAN_S), height, style);
  canvas.setAttribute("aria-label", `${plot.name}, last ${SPAN_S} s; the values are listed below`);
}

/** From 0 to a little above the largest value, so that a small change does not look like a large one. @param {[string, import("./history.js").Sample[]][]} lines */
function range(lines) {
  let high = 0;
  for (const [, samples] of lines) for (const { value } of samples) if (value !== null && value > high) high = value;
  return [0, high > 0 ? high * 1.05 : 1];
}

/** Gives the canvas as many pixels as the screen has for it. @param {HTMLCanvasElement} canvas */
function fit(canvas) {
  const box = canvas.getBoundingClientRect();
  const [width, height] = [box.width, box.height].map((side) => Math.round(side * devicePixelRatio));
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  const pen = canvas.getContext("2d");
  pen?.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
  return pen;
}

/** A line for every 10 s. @param {CanvasRenderingContext2D} pen @param {number} width @param {number} height @param {CSSStyleDeclaration} style */
function drawGrid(pen, width, height, style) {
  pen.setLineDash([]);
  pen.lineWidth = 1;
  pen.strokeStyle = style.getPropertyValue("--rule");
  pen.beginPath();
  for (let seconds = 10; seconds < SPAN_S; seconds += 10) {
    const x = Math.round((width * seconds) / SPAN_S) + 0.5;
    pen.moveTo(x, 0);
    pen.lineTo(x, height);
  }
  pen.moveTo(0, height - PADDING_PX.bottom + 0.5);
  pen.lineTo(width, height - PADDING_PX.bottom + 0.5);
  pen.stroke();
}

/**
 * A gap where there is no value: a missed frame is not a zero.
 * @param {CanvasRenderingContext2D} pen @param {import("./history.js").Sample[]} samples
 * @param {(at: number) => number} x @param {(value: number) => number} y
 */
function drawLine(pen, samples, x, y) {
  pen.lineWidth = 1.5;
  pen.beginPath();
  let down = false;
  for (const { at, value } of samples) {
    if (value === null) down = false;
    else if (down) pen.lineTo(x(at), y(value));
    else {
      pen.moveTo(x(at) - 1, y(value));
      pen.lineTo(x(at), y(value));
      down = true;
    }
  }
  pen.stroke();
}

/** @param {CanvasRenderingContext2D} pen @param {number} x @param {number} height @param {CSSStyleDeclaration} style */
function drawCursor(pen, x, height, style) {
  pen.setLineDash([]);
  pen.lineWidth = 1;
  pen.strokeStyle = style.getPropertyValue("--ink");
  pen.beginPath();
  pen.moveTo(x, 0);
  pen.lineTo(x, height);
  pen.stroke();
}

/**
 * A landmark's own colour, as light or dark as the page needs it; other lines take the page's colours in turn.
 * @param {string} name @param {number} index @param {CSSStyleDeclaration} style
 */
function lineColour(name, index, style) {
  const landmark = known.landmarks.find((one) => one.id === name.split(" #")[0]);
  if (!landmark) return style.getPropertyValue(`--line-${index + 1}`);
  const [red, green, blue] = landmark.shades[0].mean;
  const [low, high] = [Math.min(red, green, blue), Math.max(red, green, blue)];
  const saturation = high > 0 ? Math.round((70 * (high - low)) / high) : 0;
  const hue = Math.round((Math.atan2(Math.sqrt(3) * (green - blue), 2 * red - green - blue) * 180) / Math.PI);
  return `hsl(${hue} ${saturation}% ${style.getPropertyValue("--line-lightness")})`;
}

/**
 * @param {HTMLElement} legend @param {(typeof PLOTS)[number]} plot
 * @param {[string, import("./history.js").Sample[]][]} lines @param {string[]} colours @param {number} now
 */
function showLegend(legend, plot, lines, colours, now) {
  while (legend.children.length > lines.length) legend.lastElementChild?.remove();
  while (legend.children.length < lines.length) {
    const key = make("span", `key key-${legend.children.length + 1}`);
    key.setAttribute("aria-hidden", "true");
    legend.append(make("li", "", key, make("span", "name"), make("span", "value")));
  }
  lines.forEach(([name, samples], index) => {
    const value = valueAt(samples, now - (cursorS ?? 0) * 1000);
    /** @type {HTMLElement} */ (legend.children[index].children[0]).style.borderTopColor = colours[index];
    setText(legend.children[index].children[1], name);
    setText(legend.children[index].children[2], figure(value, plot.digits, value === null ? "" : plot.unit));
  });
}
