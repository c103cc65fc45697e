// Starts the page: what is asked when, and what is shown how often.

import { followEvents, getJson, getStatus } from "./api.js";
import { byId } from "./dom.js";
import { followFleet, showFleet } from "./fleet.js";
import { showHeader } from "./header.js";
import { showLandmarks } from "./landmarks.js";
import { showLayers } from "./layers.js";
import { restartLive, showLive } from "./live.js";
import { watchChanges } from "./log.js";
import { drawPlots, samplePlots } from "./plots.js";
import { showPlayback, startPlayback, whenPlaybackChanges } from "./playback.js";
import { showProbe, startProbe } from "./probe.js";
import { showRecorder } from "./recorder.js";
import { followRecordings, showRecordings, startRecordings } from "./recordings.js";
import { known, learnCamera, learnStatus } from "./state.js";
import { showTeaching, startTeaching } from "./teach.js";

const ASK_STATUS_MS = 1000;
/** Text is shown this often: faster than this nobody reads. */
const SHOW_MS = 200;

/** The set whose landmarks are shown, so that they are asked for again when it changes. */
let landmarksAskedAt = -Infinity;

/** Whether pictures and events are being asked for. */
let started = false;

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

/** A leader registers and records nothing: those sections, and what feeds them, are a follower's. */
function showSections() {
  const isFollower = known.status.role === "follower";
  for (const section of ["plots-section", "recorder-section", "fleet-section", "recordings-section"]) byId(section).hidden = !isFollower;
  byId("live").hidden = !isFollower && known.cameras.size === 0;
  byId("teach").hidden = isFollower || known.cameras.size === 0;
  if (started) return;
  started = true;
  void askLayers();
  if (isFollower) {
    followEvents(
      (camera) => {
        learnCamera(camera);
        samplePlots(camera);
      },
      (following) => (known.following = following),
    );
    void followFleet();
    void followRecordings();
  }
}

function show() {
  showHeader();
  watchChanges();
  if (document.hidden) return;
  showLive();
  showProbe();
  showLandmarks();
  showPlayback();
  showTeaching();
  showRecorder();
  showFleet();
  showRecordings();
  drawPlots();
}

startProbe();
startPlayback();
startRecordings();
startTeaching();
whenPlaybackChanges(restartLive);
void askStatus();
setInterval(show, SHOW_MS);
