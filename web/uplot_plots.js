// Plots drawn by uPlot, which gives them axes; this build may be without it.

import { make } from "./dom.js";
import { SPAN_S } from "./history.js";

const HEIGHT_PX = 110;

/** @typedef {[string, import("./history.js").Sample[]][]} Lines */
/** @typedef {{plot: {digits: number}, lines: Lines, colours: string[], dashes: number[][], low: number, high: number, now: number, cursorS: number | null, style: CSSStyleDeclaration}} Scene */
/** @typedef {{draw: (place: HTMLCanvasElement, scene: Scene) => void}} Painter */

/** @returns {Promise<Painter | null>} */
export async function loadPainter() {
  // @ts-ignore there once it is built; exports null where npm was not at hand
  const { default: uPlot } = await import("./uplot.js");
  if (!uPlot) return null;
  const style = make("link");
  style.rel = "stylesheet";
  style.href = "uplot.css";
  document.head.append(style);
  /** @type {Map<HTMLCanvasElement, {plot: any, mark: string, scene: Scene}>} */
  const drawn = new Map();
  return {
    draw(place, scene) {
      const names = scene.lines.map(([name]) => name).join("|");
      // What uPlot is told once; another set of lines, another colour scheme or another width need another plot.
      const width = Math.floor(place.parentElement?.clientWidth ?? 0);
      const mark = [names, ...scene.colours, width, scene.style.getPropertyValue("--ink")].join("|");
      let one = drawn.get(place);
      if (!one || one.mark !== mark) {
        one?.plot.destroy();
        const kept = { plot: null, mark, scene };
        kept.plot = create(uPlot, place, width, kept);
        drawn.set(place, kept);
        one = kept;
      }
      one.scene = scene;
      one.plot.setData(aligned(scene), true);
    },
  };
}

/** @param {any} uPlot @param {HTMLCanvasElement} place @param {number} width @param {{scene: Scene}} kept */
function create(uPlot, place, width, kept) {
  const { lines, colours, dashes, style, plot } = kept.scene;
  const ink = style.getPropertyValue("--quiet");
  const grid = { stroke: style.getPropertyValue("--rule"), width: 1 };
  const axis = { stroke: ink, grid, ticks: { show: false }, font: "11px system-ui, sans-serif" };
  place.hidden = true;
  const made = new uPlot({
    width,
    height: HEIGHT_PX,
    legend: { show: false },
    cursor: { show: false },
    scales: { x: { time: false, range: [-SPAN_S, 0] }, y: { range: () => [kept.scene.low, kept.scene.high] } },
    axes: [
      { ...axis, size: 20, values: (/** @type {any} */ _, /** @type {number[]} */ ticks) => ticks.map((tick) => `${tick} s`) },
      { ...axis, size: 42, values: (/** @type {any} */ _, /** @type {number[]} */ ticks) => ticks.map((tick) => label(tick, plot.digits)) },
    ],
    series: [{}, ...lines.map(([name], index) => ({
      label: name, stroke: colours[index], dash: dashes[index], width: 1.5, spanGaps: false, points: { show: false },
    }))],
    hooks: { draw: [(/** @type {any} */ self) => drawCursor(self, kept.scene)] },
  }, [[], ...lines.map(() => [])], place.parentElement);
  made.over.classList.add("area");
  made.root.setAttribute("aria-hidden", "true");
  // Between the caption and the values.
  place.after(made.root);
  return made;
}

/** Counts have no halves. @param {number} tick @param {number} digits */
function label(tick, digits) {
  if (digits === 0 && !Number.isInteger(tick)) return "";
  return tick.toFixed(tick > 10 ? 0 : digits);
}

/** One time axis for all lines: those of a camera are sampled together. @param {Scene} scene */
function aligned({ lines, now }) {
  const times = [...new Set(lines.flatMap(([, samples]) => samples.map(({ at }) => at)))].sort((a, b) => a - b);
  const columns = lines.map(([, samples]) => {
    const values = new Map(samples.map(({ at, value }) => [at, value]));
    return times.map((at) => values.get(at) ?? null);
  });
  return [times.map((at) => (at - now) / 1000), ...columns];
}

/** @param {any} plot @param {Scene} scene */
function drawCursor(plot, { cursorS, style }) {
  if (cursorS === null) return;
  const x = plot.valToPos(-cursorS, "x", true);
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.strokeStyle = style.getPropertyValue("--ink");
  ctx.lineWidth = devicePixelRatio;
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}
