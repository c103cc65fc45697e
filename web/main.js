// Starts the page: what is asked when, and what is shown how often.

import { Problem, followEvents, getJson, getStatus } from "./api.js";
import { byId } from "./dom.js";
import { showFleet } from "./fleet.js";
import { showHeader } from "./header.js";
import { showLandmarks } from "./landmarks.js";
import { restartLive, showLayers, showLive } from "./live.js";
import { watchChanges } from "./log.js";
import { drawPlots, samplePlots } from "./plots.js";
import { showProbe, startProbe } from "./probe.js";
import { showRecorder } from "./recorder.js";
import { known, learnCamera, learnStatus } from "./state.js";

const ASK_STATUS_MS = 1000;
/** Text is shown this often: faster than this nobody reads. */
const SHOW_MS = 200;

/** The set whose landmarks are shown, so that they are asked for again when it changes. */
let landmarksAskedAt = -Infinity;

async function askStatus() {
  try {
    const { status, access } = await getStatus();
    learnStatus(status, access);
    chooseCamera();
    showSections();
    if (performance.now() - landmarksAskedAt > 2000) await askLandmarks();
  } catch {
    // Silence is what the header shows; there is nothing else to do than to ask again.
  }
  setTimeout(askStatus, ASK_STATUS_MS);
}

/** The browser asks with its entity tag, so an unchanged set costs a 304. */
async function askLandmarks() {
  const set = await getJson("/api/v1/landmarks");
  known.landmarks = set.landmarks ?? [];
  known.version = set.version ?? null;
  landmarksAskedAt = performance.now();
}

async function askFleet() {
  try {
    showFleet(await getJson("/api/v1/fleet"));
  } catch (error) {
    // A service without a fleet view has nothing to show, now or later.
    if (error instanceof Problem && error.status === 404) return;
  }
  setTimeout(askFleet, 2000);
}

async function askLayers() {
  try {
    known.layers = (await getJson("/api/v1/cameras")).layers ?? [];
    showLayers();
    restartLive();
  } catch {
    setTimeout(askLayers, ASK_STATUS_MS);
  }
}

function chooseCamera() {
  if (known.camera && known.cameras.has(known.camera)) return;
  known.camera = known.cameras.keys().next().value ?? null;
  restartLive();
}

/** A leader has no cameras of its own and may have no recorder: what a service does not report is not shown. */
function showSections() {
  for (const [field, sections] of Object.entries({ cameras: ["live", "plots-section"], recorder: ["recorder-section"] })) {
    for (const section of sections) byId(section).hidden = known.status[field] === undefined;
  }
}

function show() {
  showHeader();
  watchChanges();
  if (document.hidden) return;
  showLive();
  showProbe();
  showLandmarks();
  showRecorder();
  drawPlots();
}

followEvents(
  (camera) => {
    learnCamera(camera);
    samplePlots(camera);
  },
  (following) => (known.following = following),
);
startProbe();
void askStatus();
void askLayers();
void askFleet();
setInterval(show, SHOW_MS);
