// Pictures that show where everything is: each measured landmark a bright block on a dark ground, as a BMP file.

const HEADER_BYTES = 54;

/** @param {{frame_px: number[], landmarks: any[]}} seen */
export function bitmapOf({ frame_px: [width, height], landmarks }) {
  const file = Buffer.alloc(HEADER_BYTES + 4 * width * height, 70);
  file.write("BM");
  file.writeUInt32LE(file.length, 2);
  file.writeUInt32LE(HEADER_BYTES, 10);
  file.writeUInt32LE(40, 14);
  file.writeInt32LE(width, 18);
  // Rows from top to bottom have a negative height.
  file.writeInt32LE(-height, 22);
  file.writeUInt16LE(1, 26);
  file.writeUInt16LE(32, 28);
  file.fill(0, 30, HEADER_BYTES);
  for (const { outline_px: outline } of landmarks.filter((one) => one.result === "measured")) {
    const [left, right] = [Math.min, Math.max].map((choose) => choose(...outline.map(([x]) => Math.round(x))));
    const [top, bottom] = [Math.min, Math.max].map((choose) => choose(...outline.map(([, y]) => Math.round(y))));
    for (let y = Math.max(top, 0); y < Math.min(bottom, height); y += 1) {
      const row = HEADER_BYTES + 4 * width * y;
      if (right > left) file.fill(0xf0, row + 4 * Math.max(left, 0), row + 4 * Math.min(right, width));
    }
  }
  return file;
}
