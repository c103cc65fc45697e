// JPEG files as the registration reads them: pixel by pixel as they are stored.

const APP1 = 0xe1;
const START_OF_SCAN = 0xda;

/**
 * Browsers turn a picture as its Exif says, and cannot be asked not to; coordinates belong to the pixels as they are
 * stored. So Exif and everything else in APP1 is left out (ITU-T T.81 annex B).
 * @param {Blob} file
 */
export async function asStored(file) {
  const spans = applicationData(new DataView(await file.arrayBuffer()));
  if (spans.length === 0) return file;
  const kept = [];
  let from = 0;
  for (const [start, end] of spans) {
    kept.push(file.slice(from, start));
    from = end;
  }
  return new Blob([...kept, file.slice(from)], { type: file.type });
}

/** Where the APP1 segments before the picture's data begin and end. @param {DataView} bytes @returns {[number, number][]} */
function applicationData(bytes) {
  /** @type {[number, number][]} */
  const found = [];
  if (bytes.byteLength < 4 || bytes.getUint16(0) !== 0xffd8) return found;
  for (let at = 2; at + 4 <= bytes.byteLength && bytes.getUint8(at) === 0xff; ) {
    const marker = bytes.getUint8(at + 1);
    if (marker === START_OF_SCAN) break;
    const end = at + 2 + bytes.getUint16(at + 2);
    if (marker === APP1) found.push([at, end]);
    at = end;
  }
  return found;
}
