// The disparities of a live source, in colours or as a relief, if the server sends them: see live_requests.h.
import { DisparityMap } from './disparity_map';
import type { LiveItem } from './document';
import { DisparityLegend } from './legend';
import { askForPicture } from './live';
import { toneOfGrey } from './light_field';
import type { Painter, Pictures } from './painter';
import { Relief } from './relief';
import { pictureOfMap } from './shaders';
import type { State } from './state';

/** After the header: int16 [y, x] in thousandths of a px per view step, -32768 = unknown, their confidence [y, x] from 0 to
 *  255, and the grey pixels [y, x] of the view of the map. */
interface DepthHeader {
  serial: number;
  width: number;
  height: number;
  range: [number, number]; // nearest and farthest, px per view step
  cycle: number;
  cycles: number; // that were summed
  size: string;
  latency_s: number; // 0 = made after the end of the source
}

export class LiveDepth {
  about = ''; // the newest map, in words
  readonly legend = new DisparityLegend();
  private serial = 0;
  private shown: { map: DisparityMap; relief: Relief; picture: Pictures } | null = null;

  constructor(private readonly painter: Painter, private readonly item: LiveItem) {}

  /** Requests the map after the newest one. Returns false if there is none soon. */
  async ask(): Promise<boolean> {
    const got = await askForPicture<DepthHeader>(`depth?after=${this.serial}`);
    if (!got || got.header.serial <= this.serial) return false;
    const { serial, width, height, range, cycle, cycles, size, latency_s } = got.header;
    const numPixels = width * height;
    this.serial = serial;
    const { map, picture } = this.sized(width, height);
    map.range = range;
    const late = latency_s > 0 ? `, ${Math.round(1000 * latency_s)} ms after its last event` : '';
    this.about = `cycle ${cycle}${cycles > 1 ? `, sum of ${cycles}` : ''}: ${size} size${late}`;
    this.legend.show(range);
    const confidence = Int16Array.from(got.pixels.subarray(2 * numPixels, 3 * numPixels), (byte) => Math.round((1000 * byte) / 255));
    map.set(new Int16Array(got.pixels.slice(0, 2 * numPixels).buffer), confidence);
    this.painter.putGrey(picture, width, height, got.pixels.subarray(3 * numPixels));
    return true;
  }

  /** Returns the disparity at a pixel of the sensor; null if it is unknown. */
  at(x: number, y: number): number | null {
    if (!this.shown) return null;
    const [width, height] = this.shown.map.size;
    return this.shown.map.at(Math.floor((x * width) / this.item.width), Math.floor((y * height) / this.item.height));
  }

  paint(target: HTMLCanvasElement, state: State, isRelief: boolean): void {
    if (!this.shown) return;
    const { map, relief, picture } = this.shown;
    const [width, height] = map.size;
    const light = toneOfGrey(picture.texture, map.size);
    if (isRelief) relief.paint(target, state, 1, light);
    else this.painter.paint(target, width, height, pictureOfMap, { ...light, ...map.uniforms(state, 1) });
  }

  /** Returns the relief as a glTF file; null if there is none yet. */
  async glb(state: State): Promise<Blob | null> {
    if (!this.shown) return null;
    const { map, relief, picture } = this.shown;
    return relief.glb(state, toneOfGrey(picture.texture, map.size));
  }

  private sized(width: number, height: number): NonNullable<LiveDepth['shown']> {
    const size = this.shown?.map.size;
    if (this.shown && size?.[0] === width && size[1] === height) return this.shown;
    this.close();
    const map = new DisparityMap(this.painter, [width, height], [1, 1], { view: [0, 0], range: [0, 1], confidences: [] });
    this.shown = { map, relief: new Relief(this.painter, map), picture: this.painter.pictures(width, height, 1, true) };
    return this.shown;
  }

  close(): void {
    this.shown?.map.close();
    this.shown?.relief.close();
    if (this.shown) this.painter.gl.deleteTexture(this.shown.picture.texture);
    this.shown = null;
  }
}
