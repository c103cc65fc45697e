// The picture that somebody learns from, and the box drawn in it.

/** @typedef {{x: number, y: number, w: number, h: number}} Box frame pixels */
/** @typedef {{number: number, widthPx: number, heightPx: number, box: Box | null, showsMask: boolean, query: string}} Lesson */

/** @type {Lesson | null} */
let current = null;

/** The lesson that is under way, if any. */
export function lesson() {
  return current;
}

/** @param {Lesson | null} wanted */
export function setLesson(wanted) {
  current = wanted;
}

/** Where the picture of the lesson is, with or without what matches tinted in it. */
export function lessonPath() {
  const { number, showsMask, query } = current ?? { number: 0, showsMask: false, query: "" };
  const place = `/api/v1/lessons/${number}`;
  return showsMask && query ? `${place}/mask.png?${query}` : `${place}/picture.png`;
}
