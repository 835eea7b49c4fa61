// Writes animated GIFs (GIF89a). Grey pictures keep their 256 levels; colours are reduced to 6 x 7 x 6 levels of red,
// green and blue with ordered dithering.

const greenLevels = 7, otherLevels = 6;

// The 4 x 4 Bayer matrix, centred: -0.5 to 0.5.
const bayer = [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5].map((value) => (value + 0.5) / 16 - 0.5);

function palette(isGrey: boolean): Uint8Array {
  const colours = new Uint8Array(3 * 256);
  if (isGrey) return colours.map((_, i) => Math.floor(i / 3));
  for (let i = 0; i < otherLevels * greenLevels * otherLevels; ++i) {
    const [red, green, blue] = [Math.floor(i / (greenLevels * otherLevels)), Math.floor(i / otherLevels) % greenLevels, i % otherLevels];
    colours.set([(255 * red) / (otherLevels - 1), (255 * green) / (greenLevels - 1), (255 * blue) / (otherLevels - 1)].map(Math.round), 3 * i);
  }
  return colours;
}

function isGreyPicture(rgba: Uint8ClampedArray): boolean {
  for (let i = 0; i < rgba.length; i += 4) if (rgba[i] !== rgba[i + 1] || rgba[i] !== rgba[i + 2]) return false;
  return true;
}

/** Returns the index of the palette for each pixel. */
function indices(rgba: Uint8ClampedArray, width: number, isGrey: boolean): Uint8Array {
  const result = new Uint8Array(rgba.length / 4);
  for (let i = 0; i < result.length; ++i) {
    if (isGrey) {
      result[i] = rgba[4 * i]!;
      continue;
    }
    const shift = bayer[4 * (Math.floor(i / width) % 4) + ((i % width) % 4)]!;
    const level = (channel: number, levels: number) =>
      Math.min(Math.max(Math.round((rgba[4 * i + channel]! / 255) * (levels - 1) + shift), 0), levels - 1);
    result[i] = (level(0, otherLevels) * greenLevels + level(1, greenLevels)) * otherLevels + level(2, otherLevels);
  }
  return result;
}

/** Packs codes of 9 to 12 bits, lowest bit first, into blocks of up to 255 bytes. */
class CodeWriter {
  readonly bytes: number[] = [];
  private block: number[] = [];
  private bits = 0;
  private held = 0;

  write(code: number, width: number): void {
    this.held |= code << this.bits;
    for (this.bits += width; this.bits >= 8; this.bits -= 8, this.held >>>= 8) this.put(this.held & 255);
  }

  finish(): void {
    if (this.bits > 0) this.put(this.held & 255);
    this.endBlock();
    this.bytes.push(0);
  }

  private put(byte: number): void {
    this.block.push(byte);
    if (this.block.length === 255) this.endBlock();
  }

  private endBlock(): void {
    if (this.block.length > 0) this.bytes.push(this.block.length, ...this.block);
    this.block = [];
  }
}

/** Compresses with GIF's variant of LZW for 8 bits per pixel. */
function compress(pixels: Uint8Array): number[] {
  const clear = 256, end = 257, mostCodes = 4096;
  const writer = new CodeWriter();
  const table = new Uint16Array(mostCodes * 256); // code of a run * 256 + the next pixel -> the longer run's; 0 = none
  let next = end + 1, width = 9;
  writer.write(clear, width);
  let run = pixels[0]!;
  for (let i = 1; i < pixels.length; ++i) {
    const key = run * 256 + pixels[i]!;
    if (table[key] !== 0) {
      run = table[key]!;
      continue;
    }
    writer.write(run, width);
    run = pixels[i]!;
    if (next === mostCodes) {
      writer.write(clear, width);
      table.fill(0);
      next = end + 1;
      width = 9;
      continue;
    }
    table[key] = next;
    if (next === 1 << width && width < 12) ++width;
    ++next;
  }
  writer.write(run, width);
  writer.write(end, width);
  writer.finish();
  return writer.bytes;
}

const word = (value: number): [number, number] => [value & 255, value >> 8];

export class GifWriter {
  private readonly parts: BlobPart[] = [];
  private isGrey = false;

  constructor(
    private readonly width: number,
    private readonly height: number,
    private readonly framesPerSecond: number,
  ) {}

  /** Adds a frame of RGBA bytes. The first frame determines whether all are grey. */
  add(rgba: Uint8ClampedArray): void {
    if (this.parts.length === 0) this.begin(isGreyPicture(rgba));
    const hundredths = Math.round(100 / this.framesPerSecond);
    this.put([0x21, 0xf9, 4, 0, ...word(hundredths), 0, 0]);
    this.put([0x2c, ...word(0), ...word(0), ...word(this.width), ...word(this.height), 0, 8]);
    this.put(compress(indices(rgba, this.width, this.isGrey)));
  }

  finish(): Blob {
    this.put([0x3b]);
    return new Blob(this.parts, { type: 'image/gif' });
  }

  private begin(isGrey: boolean): void {
    this.isGrey = isGrey;
    this.put([...new TextEncoder().encode('GIF89a'), ...word(this.width), ...word(this.height), 0xf7, 0, 0]);
    this.put(palette(isGrey));
    // Repeats forever.
    this.put([0x21, 0xff, 11, ...new TextEncoder().encode('NETSCAPE2.0'), 3, 1, 0, 0, 0]);
  }

  private put(bytes: Iterable<number>): void {
    this.parts.push(Uint8Array.from(bytes));
  }
}
