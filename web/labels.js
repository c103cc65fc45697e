// Where labels go: beside what they name, and not over each other.

/** @typedef {{x: number, y: number, w: number, h: number}} Rect */
/** @typedef {{w: number, h: number}} Size */
/** @typedef {{about: Rect | null, w: number}} Wanted what a label names, if that is in the picture, and how wide it is */

const GAP = 4;

/**
 * Gives each label a place in the room: right, left, below or above of what it names, away from everything named, while
 * there is such a place; else further down. One for which there is no room at all has none: it would make two unreadable.
 * @param {Wanted[]} wanted @param {Size} room @param {number} height of each @param {number} [gap]
 */
export function placeLabels(wanted, room, height, gap = GAP) {
  const named = wanted.flatMap(({ about }) => (about ? [about] : []));
  /** @type {Rect[]} */
  const placed = [];
  return wanted.map(({ about, w }) => {
    const size = { w, h: height };
    const free = about ? beside(about, size, room, gap).find((place) => isInside(place, room) && isFree(place, [...placed, ...named])) : null;
    const place = free ?? movedDown(about ? within(about, size, room, gap) : { x: gap, y: gap, ...size }, placed, room, gap);
    if (place) placed.push(place);
    return place;
  });
}

/** @param {Rect} about @param {Size} size @param {Size} room @param {number} gap @returns {Rect[]} */
function beside(about, { w, h }, room, gap) {
  const middle = clamp(about.y + about.h / 2 - h / 2, room.h - h);
  const centre = clamp(about.x + about.w / 2 - w / 2, room.w - w);
  const [right, left] = [about.x + about.w + gap, about.x - w - gap];
  const [below, above] = [about.y + about.h + gap, about.y - h - gap];
  return [
    [right, middle], [left, middle], [centre, below], [centre, above], [centre, below + h + gap], [centre, above - h - gap],
  ].map(([x, y]) => ({ x, y, w, h }));
}

/** Right of what is named, moved into the room. @param {Rect} about @param {Size} size @param {Size} room @param {number} gap @returns {Rect} */
function within(about, { w, h }, room, gap) {
  return { x: clamp(about.x + about.w + gap, room.w - w), y: clamp(about.y, room.h - h), w, h };
}

/** Each label in the way moves it below itself; past the bottom it begins again at the top. @param {Rect} place @param {Rect[]} placed @param {Size} room @param {number} gap @returns {Rect | null} */
function movedDown(place, placed, room, gap) {
  for (let tries = 0; tries <= placed.length; tries += 1) {
    const inTheWay = placed.find((other) => overlap(other, place));
    if (!inTheWay) return place;
    const y = inTheWay.y + inTheWay.h + gap / 4;
    place = { ...place, y: y + place.h > room.h ? gap : y };
  }
  return null;
}

/** @param {Rect} place @param {Rect[]} others */
const isFree = (place, others) => others.every((other) => !overlap(other, place));

/** @param {Rect} place @param {Size} room */
const isInside = (place, room) => place.x >= 0 && place.y >= 0 && place.x + place.w <= room.w && place.y + place.h <= room.h;

/** @param {Rect} a @param {Rect} b */
const overlap = (a, b) => a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;

/** @param {number} value @param {number} most */
const clamp = (value, most) => Math.max(0, Math.min(value, most));
