// The states that the page must show well, each as the JSON that a follower would give.

export const STATES = ["well", "no-camera", "stale", "no-landmark", "one-lost", "recording-failed", "thirty", "read-only", "leader-gone", "leader"];

/** Size of the pictures that are made up here. */
const FRAME_PX = [640, 480];
/** Half a block's side, px. */
const HALF_PX = 22;

const RED = { mean: [181, 52, 47], variance: [310, 95, 88] };
const BLUE = { mean: [44, 71, 158], variance: [70, 102, 240] };

/** @param {string} id @param {object[]} shades @param {string} shape */
function landmark(id, shades, shape) {
  return {
    id, revision: 1, digest: "5d".repeat(32), window_px: [12, 12], shape, size_m: 0.3, shades,
    tolerance: { mean: [15, 15, 15], variance: [150, 150, 150] },
  };
}

/** @param {string} state */
function landmarksIn(state) {
  if (state === "no-landmark" || state === "no-camera") return [];
  if (state === "thirty") {
    return Array.from({ length: 30 }, (_, n) => landmark(`sign-${String(n + 1).padStart(2, "0")}`, n % 2 ? [RED, BLUE] : [BLUE], "rectangle"));
  }
  return [landmark("blue", [BLUE], "block"), landmark("red", [RED, { ...RED, mean: [140, 38, 36] }], "block")];
}

/** @param {string} state */
export function makeWorld(state) {
  const startedAt = Date.now();
  const set = landmarksIn(state);
  let sequence = 0;
  const noise = (/** @type {number} */ size) => (Math.random() - 0.5) * size;

  const measured = (/** @type {any} */ one, /** @type {number} */ index) => ({
    id: one.id, instance: 0, result: "measured",
    ...placeOf(index), area_px2: 1840 + 300 * Math.sin(sequence / 90) + noise(20),
    bearing_rad: 0.21 - 0.3 * index, range_m: 4.2 + index, score: 0.91 + noise(0.04), shape_score: 0.84 + noise(0.05), innovation_px: Math.abs(noise(3)), gain: 0.96 + 0.08 * Math.sin(sequence / 100),
    predicted_x_px: placeOf(index).x_px + 2, predicted_y_px: placeOf(index).y_px - 1,
    observed: {
      mean: one.shades[0].mean.map((/** @type {number} */ value) => value + noise(20)),
      variance: one.shades[0].variance.map((/** @type {number} */ value) => value + noise(60)),
    },
    miss: null,
  });
  /** Far enough from frame to frame that a drawing of the wrong frame shows. @param {number} index */
  const placeOf = (index) => state === "thirty"
    ? { x_px: 60 + 100 * (index % 6) + 20 * Math.sin(sequence / 20), y_px: 50 + 90 * Math.floor(index / 6) }
    : { x_px: 60 + ((sequence * 37 + index * 260) % 520), y_px: 200 + 90 * index };
  const geometryOf = (/** @type {any} */ entry) => {
    const { x_px: x, y_px: y } = entry;
    const corners = [[x - HALF_PX, y - HALF_PX], [x + HALF_PX, y - HALF_PX], [x + HALF_PX, y + HALF_PX], [x - HALF_PX, y + HALF_PX]];
    const isMeasured = entry.result === "measured";
    return {
      ...entry, digest: "5d".repeat(32), predicted_area_px2: 1840,
      gate: { x_px: entry.predicted_x_px, y_px: entry.predicted_y_px, radius_x_px: 60, radius_y_px: 45 },
      outline_px: isMeasured ? corners : [],
      segments_px: isMeasured ? [[...corners[0], ...corners[1]], [...corners[1], ...corners[2]]] : [],
    };
  };
  const missed = (/** @type {any} */ one, /** @type {string} */ reason, /** @type {object} */ figures) => ({
    id: one.id, instance: 0, result: reason, x_px: null, y_px: null, area_px2: null, score: null, shape_score: null,
    innovation_px: null, gain: null, predicted_x_px: 300, predicted_y_px: 250, observed: null, miss: { reason, ...figures },
  });
  const misses = [["no_colour", { excess: 2.4 }], ["wrong_shape", { shape_score: 0.31 }], ["outside_gate", { innovation_px: 84 }], ["too_small", {}]];
  const results = () => set.map((one, index) => {
    if (state === "one-lost" && index === 1) return missed(one, "no_colour", { excess: 2.4, observed: { mean: [120, 90, 80], variance: [800, 300, 200] } });
    if (state === "thirty" && index % 5 === 4) return missed(one, ...misses[(index / 5 | 0) % 4]);
    return measured(one, index);
  });

  return {
    seen: () => ({ sequence, captured_at_ns: Date.now() * 1e6, set: { epoch: 3, version: 7 }, frame_px: FRAME_PX, landmarks: results().map(geometryOf) }),
    get sequence() { return sequence; },
    tick() {
      if (state === "no-camera" || (state === "stale" && sequence > 60)) return false;
      sequence += 1;
      return true;
    },
    refusal() {
      if (state === "no-camera") return "no picture has arrived yet";
      if (state === "stale" && sequence > 60) return "the newest picture is 14.2 s old; the camera has stopped";
      return null;
    },
    fleet: () => ({ members: [
      { vehicle: "follower-1", role: "follower", instance: "a1", answers: true, host: "car-1", version: "0.1.0", clock: { offset_ms: 0, uncertainty_ms: 0.1, in_step: true } },
      { vehicle: "follower-2", role: "follower", instance: "b2", answers: state !== "one-lost", host: "car-2", version: state === "thirty" ? "0.2.0" : "0.1.0", clock: state === "one-lost" ? null : { offset_ms: 1.4, uncertainty_ms: 0.3, in_step: true } },
      ...(state === "leader-gone" ? [] : [{ vehicle: "lead", role: "leader", instance: "c3", answers: true, host: "truck", version: "0.1.0", clock: { offset_ms: state === "one-lost" ? -3210 : 0.4, uncertainty_ms: 0.2, in_step: state !== "one-lost" } }]),
    ] }),
    recordings: () => ({ next: null, recordings: [3, 2, 1].map((number) => ({
      name: `follower-1-20261122T18${number}604Z-000${number}.mcap`, vehicle: "follower-1", started_at: `20261122T18${number}604Z`,
      state: number === 3 ? "unfinished" : "finished", bytes: number * 1_204_000_000,
      duration_s: number === 3 ? null : 3599.4, messages: number === 3 ? null : 431_022,
      cameras: number === 3 ? [] : [{ id: "front", frames: 107_982, registrations: 107_900 }],
    })) }),
    landmarks: () => ({ version: { epoch: 3, version: 7 }, landmarks: set }),
    status: () => state === "leader" ? {
      vehicle: "lead", role: "leader", version: "0.1.0", uptime_s: 4021, router: { connected: true }, landmarks: set.length,
      set: { epoch: 3, version: 7 }, edits: { made: 4, refused: 0 }, cameras: [{ id: "front", state: "live", sequence, age_ms: 18 }],
    } : ({
      vehicle: "follower-1", role: "follower", version: "0.1.0", uptime_s: 4021 + (Date.now() - startedAt) / 1000,
      leader: { vehicle: "lead", present: state !== "leader-gone", age_s: state === "leader-gone" ? 48 : 0.4,
        clock: state === "leader-gone" ? null : { offset_ms: state === "one-lost" ? -3210 : 0.4, uncertainty_ms: 0.2, in_step: state !== "one-lost" } },
      router: { connected: true },
      landmarks: set.length,
      cameras: state === "no-camera" ? [] : [{
        id: "front", state: this_state(), sequence, age_ms: state === "stale" && sequence > 60 ? 14200 : 18, fps: 29.8 + noise(0.4),
        latency_ms: 21 + noise(6), processing_ms: 2.2 + noise(0.6),
        dropped: { missed: 3, replaced: 0, undecodable: 0, refused: 0, unread: 0 }, landmarks: results(),
      }],
      recorder: state === "recording-failed"
        ? { state: "failed", file: null, bytes: 0, lost: 812, free_bytes: 0, reason: "no space left on the disk" }
        : { state: "recording", file: "recordings/2026-11-22T18-36-04Z_follower-1_0003.mcap.active", bytes: 48_211_004 + sequence * 61_000, lost: 0, free_bytes: 212_000_000_000 },
    }),
  };

  function this_state() {
    return state === "stale" && sequence > 60 ? "stale" : "live";
  }
}
