// Draws what was seen over its picture, live or recorded, with the signs of the service's own overlay: a solid outline, a
// dot and the vector from the origin (thesis Fig 4.5) for what was found, a dashed cross and the reason for what was not.

import { placeLabels } from "./labels.js";

/**
 * @typedef {object} SeenLandmark what one frame said of one instance of one landmark
 * @property {string} id
 * @property {number} instance
 * @property {string} result
 * @property {number | null} x_px
 * @property {number | null} y_px
 * @property {number | null} area_px2
 * @property {number | null} predicted_x_px
 * @property {number | null} predicted_y_px
 * @property {number | null} predicted_area_px2
 * @property {{x_px: number, y_px: number, radius_x_px: number, radius_y_px: number} | null} gate
 * @property {[number, number][]} outline_px
 * @property {[number, number, number, number][]} segments_px
 * @property {Record<string, any> | null} miss
 */
/** @typedef {{sequence: number, frame_px: [number, number], landmarks: SeenLandmark[]}} Seen */
/** @typedef {{perFramePx: number, perCssPx: number}} Scale canvas pixels for a pixel of the frame, and for one of the page */
/** @typedef {"thin" | "thick" | "dashed"} Kind */

/** Okabe and Ito's colours for colour-blind readers, without black; landmarks take them in the order of the set. */
const PALETTE = ["#f0e442", "#56b4e9", "#e69f00", "#00c694", "#e096be", "#f07828", "#c8c8ff"];
const RIM = "rgb(0 0 0 / 75%)";
const PLATE = "rgb(0 0 0 / 72%)";

/** Coordinates beyond this are not drawn, frame pixels. */
const FURTHEST_PX = 1e5;

/** On pictures narrower than this lines and signs are smaller, down to these times their size, for so are the objects. */
const FULL_SIZE_PX = 640;
const LEAST_SIZE = 0.65;

/** So many square pixels of the page for each label, or there is room for names only. */
const ROOM_FOR_FIGURES_PX2 = 24_000;

/** @param {CanvasRenderingContext2D} pen @param {Seen} seen @param {Set<string>} layers @param {Scale} scale */
export function drawSeen(pen, seen, layers, scale) {
  const inks = inksOf(seen.landmarks);
  pen.lineCap = "round";
  pen.lineJoin = "round";
  const size = Math.min(Math.max(pen.canvas.width / scale.perCssPx / FULL_SIZE_PX, LEAST_SIZE), 1);
  const signs = { ...scale, perCssPx: scale.perCssPx * size };
  seen.landmarks.forEach((one, index) => {
    const brush = brushOf(pen, signs, inks[index]);
    drawExpectation(brush, one, layers);
    if (one.result === "measured") drawSighting(brush, one, layers);
  });
  if (layers.has("labels")) drawLabels(pen, seen.landmarks, inks, scale);
}

/** Every id, its instances included, has the next colour. @param {SeenLandmark[]} landmarks */
function inksOf(landmarks) {
  const ids = [...new Set(landmarks.map((one) => one.id))];
  return landmarks.map((one) => PALETTE[ids.indexOf(one.id) % PALETTE.length]);
}

/** @typedef {ReturnType<typeof brushOf>} Brush */

/** @param {CanvasRenderingContext2D} pen @param {Scale} scale @param {string} ink */
function brushOf(pen, { perFramePx, perCssPx }, ink) {
  const length = (/** @type {number} */ cssPx) => (cssPx * perCssPx) / perFramePx;
  /** @param {Path2D} path @param {Kind} kind */
  const stroke = (path, kind) => {
    const width = (kind === "thick" ? 3 : 1.5) * perCssPx;
    pen.setLineDash(kind === "dashed" ? [6 * perCssPx, 5 * perCssPx] : []);
    for (const [style, lineWidth] of /** @type {const} */ ([[RIM, width + 2.4 * perCssPx], [ink, width]])) {
      pen.strokeStyle = style;
      pen.lineWidth = lineWidth;
      pen.stroke(path);
    }
  };
  return {
    /** So many pixels of the page, in those of the frame. */
    length,
    /** @param {number[][]} points frame pixels @param {Kind} kind @param {boolean} [isClosed] */
    lines(points, kind, isClosed = false) {
      if (points.length < 2 || !points.every(isDrawable)) return;
      const path = new Path2D();
      for (const [x, y] of points) path.lineTo(x * perFramePx, y * perFramePx);
      if (isClosed) path.closePath();
      stroke(path, kind);
    },
    /** @param {number[]} centre @param {number[]} radii frame pixels @param {Kind} kind */
    ellipse(centre, radii, kind) {
      if (!isDrawable(centre) || !isDrawable(radii)) return;
      const path = new Path2D();
      path.ellipse(centre[0] * perFramePx, centre[1] * perFramePx, radii[0] * perFramePx, radii[1] * perFramePx, 0, 0, 2 * Math.PI);
      stroke(path, kind);
    },
    /** @param {number[]} centre */
    dot(centre) {
      if (!isDrawable(centre)) return;
      for (const [style, radius] of /** @type {const} */ ([[RIM, 3.7], [ink, 2.5]])) {
        pen.fillStyle = style;
        pen.beginPath();
        pen.arc(centre[0] * perFramePx, centre[1] * perFramePx, radius * perCssPx, 0, 2 * Math.PI);
        pen.fill();
      }
    },
  };
}

/** @param {number[]} point */
const isDrawable = (point) => point.every((value) => Math.abs(value ?? NaN) < FURTHEST_PX);

/** @param {Brush} brush @param {SeenLandmark} one @param {Set<string>} layers */
function drawExpectation(brush, one, layers) {
  if (one.gate && layers.has("gate")) {
    brush.ellipse([one.gate.x_px, one.gate.y_px], [one.gate.radius_x_px, one.gate.radius_y_px], "dashed");
  }
  if (one.predicted_x_px === null || one.predicted_y_px === null || !layers.has("prediction")) return;
  const [x, y] = [one.predicted_x_px, one.predicted_y_px];
  if (one.result === "measured") {
    const arm = brush.length(4.5);
    brush.lines([[x + arm, y], [x, y + arm], [x - arm, y], [x, y - arm]], "thin", true);
    return;
  }
  const arm = Math.max(Math.sqrt(one.predicted_area_px2 ?? 0) / 2, brush.length(7));
  brush.lines([[x - arm, y - arm], [x + arm, y + arm]], "dashed");
  brush.lines([[x - arm, y + arm], [x + arm, y - arm]], "dashed");
}

/** @param {Brush} brush @param {SeenLandmark} one @param {Set<string>} layers */
function drawSighting(brush, one, layers) {
  const centre = [one.x_px ?? NaN, one.y_px ?? NaN];
  if (layers.has("vector")) drawArrow(brush, centre);
  if (layers.has("outline")) brush.lines(one.outline_px, "thin", true);
  if (layers.has("segments")) {
    for (const [fromX, fromY, toX, toY] of one.segments_px) brush.lines([[fromX, fromY], [toX, toY]], "thick");
  }
  if (layers.has("outline") || layers.has("vector")) brush.dot(centre);
}

/** From the picture's origin. @param {Brush} brush @param {number[]} to */
function drawArrow(brush, [x, y]) {
  const length = Math.max(Math.hypot(x, y), 1);
  const head = Math.min(brush.length(10), length);
  const [backX, backY] = [(-x / length) * head, (-y / length) * head];
  const side = (/** @type {number} */ turn) => [x + backX - turn * backY * 0.4, y + backY + turn * backX * 0.4];
  brush.lines([[0, 0], [x, y]], "thin");
  brush.lines([side(1), [x, y], side(-1)], "thin");
}

/** @param {CanvasRenderingContext2D} pen @param {SeenLandmark[]} landmarks @param {string[]} inks @param {Scale} scale */
function drawLabels(pen, landmarks, inks, { perFramePx, perCssPx }) {
  const { width, height } = pen.canvas;
  const room = { w: width / perCssPx, h: height / perCssPx };
  pen.font = `${12.5 * perCssPx}px system-ui, "Noto Sans", "DejaVu Sans", sans-serif`;
  pen.textBaseline = "middle";
  const isRoomy = room.w * room.h >= ROOM_FOR_FIGURES_PX2 * Math.max(landmarks.length, 6);
  const words = landmarks.map((one) => labelOf(one, isRoomy));
  const wanted = landmarks.map((one, index) => ({
    about: extentOf(one, perFramePx / perCssPx, room), w: pen.measureText(words[index]).width / perCssPx + 8,
  }));
  placeLabels(wanted, room, 18).forEach((place, index) => {
    if (!place) return;
    const [x, y, w, h] = [place.x, place.y, place.w, place.h].map((side) => side * perCssPx);
    pen.fillStyle = PLATE;
    pen.fillRect(x, y, w, h);
    pen.fillStyle = inks[index];
    pen.fillText(words[index], x + 4 * perCssPx, y + h / 2);
  });
}

/** The words beside a landmark. @param {SeenLandmark} one @param {boolean} withFigures */
export function labelOf(one, withFigures) {
  const name = one.instance > 0 ? `${one.id}#${one.instance}` : one.id;
  if (one.result !== "measured") return `${name}: ${reasonOf(one)}`;
  if (!withFigures) return name;
  return `${name}  x ${one.x_px?.toFixed(1)} y ${one.y_px?.toFixed(1)}  ${one.area_px2?.toFixed(0)} px²`;
}

/** @param {SeenLandmark} one */
function reasonOf({ result, miss }) {
  const words = result.replaceAll("_", " ");
  if (typeof miss?.shape_score === "number") return `${words} (${miss.shape_score.toFixed(2)})`;
  if (typeof miss?.innovation_px === "number") return `${words} (${miss.innovation_px.toFixed(0)} px off)`;
  if (typeof miss?.visible === "number") return `${words} (${(100 * miss.visible).toFixed(0)} % seen)`;
  return words;
}

/**
 * The square on the page that the object, or the place where it was expected, takes; null where that is not in the picture.
 * @param {SeenLandmark} one @param {number} cssPerFramePx @param {{w: number, h: number}} room
 */
function extentOf(one, cssPerFramePx, room) {
  const isMeasured = one.result === "measured";
  const [x, y] = isMeasured ? [one.x_px, one.y_px] : [one.predicted_x_px, one.predicted_y_px];
  if (x === null || y === null || one.result === "outside_frame") return null;
  const area = (isMeasured ? one.area_px2 : one.predicted_area_px2) ?? 0;
  const half = Math.max(Math.sqrt(Math.max(area, 0)) * 0.6 * cssPerFramePx, 9);
  const [centreX, centreY] = [x * cssPerFramePx, y * cssPerFramePx];
  const isSeen = centreX > -half && centreY > -half && centreX < room.w + half && centreY < room.h + half;
  return isSeen ? { x: centreX - half, y: centreY - half, w: 2 * half, h: 2 * half } : null;
}
