// The pictures of one light field, or of two side by side: views, EPIs, disparities and reliefs.
import { nearestView } from './aperture';
import type { QualityFigures } from './comparison';
import { DisparityMap } from './disparity_map';
import type { LightFieldItem } from './document';
import { canvas, clamp, placeOn } from './dom';
import { Camera, LightFieldViews, lightFieldUniforms, toneUniforms } from './light_field';
import type { Uniform } from './painter';
import { Pane, type Epis } from './pane';
import { Relief } from './relief';
import { fit, focusOn, setSize, type Context } from './screen';
import { epiShader, gridShader, pictureShader } from './shaders';
import { partOf } from './zoom';

const modes: Record<string, number> = { first: 0, second: 1, swipe: 2, difference: 3 };
const swipeMode = 2;
const paddingPx = 8; // of the stage, and the gap in it

type Arrangement = [boxWidth: number, boxHeight: number, epis: Epis];

interface Shown {
  pane: Pane;
  views: LightFieldViews;
  map: DisparityMap | null;
  relief: Relief | null;
  isSecond: boolean;
}

export class LightFieldPanes {
  readonly camera: Camera;
  readonly all: Shown[];
  readonly disparity: DisparityMap | null; // of the first one that has a map
  readonly sheet = canvas('All views. Press on one to look from there.', 'sheet');
  private readonly first: LightFieldViews;
  private readonly second: LightFieldViews;

  /** `second` and `quality` are those of the light field that is compared, if there is one. */
  constructor(private readonly context: Context, readonly item: LightFieldItem, second: LightFieldItem | undefined, private readonly quality: QualityFigures | null) {
    const { source, painter, stage } = context;
    this.first = new LightFieldViews(item, source, painter);
    this.second = second ? new LightFieldViews(second, source, painter) : this.first;
    this.camera = new Camera(painter);
    this.all = [this.pane(this.first, false), ...(second ? [this.pane(this.second, true)] : [])];
    this.disparity = this.all.find(({ map }) => map)?.map ?? null;
    // The maps of the truth and of the reconstruction have the same colours.
    for (const { map } of this.all) if (map) map.range = this.disparity!.range;
    this.sheet.addEventListener('click', (event) => this.choose(placeOn(this.sheet, event)));
    stage.append(...this.all.map(({ pane }) => pane.root), this.sheet);
  }

  get isSingleView(): boolean {
    return this.item.views[0] * this.item.views[1] === 1;
  }

  private get isComparison(): boolean {
    return this.all.length > 1;
  }

  private pane(views: LightFieldViews, isSecond: boolean): Shown {
    const { context, context: { painter } } = this;
    const { item } = views;
    const focusAt = (x: number, y: number) => focusOn(context, x, y, views.disparityAt(x, y));
    const map = item.disparity ? new DisparityMap(painter, [item.width, item.height], item.views, item.disparity) : null;
    return { pane: new Pane(item.name, item, context.state, focusAt), views, map, relief: map && new Relief(painter, map), isSecond };
  }

  /** What is shown of the light fields; a damaged address may ask for something else. */
  shown(): string {
    const show = this.context.state.get('show');
    const isThere = show === 'grid' ? !this.isComparison : this.disparity !== null;
    return isThere ? show : 'picture';
  }

  /** How two light fields are compared. Colours and reliefs are not mixed. */
  compared(): string {
    const mode = this.context.state.get('compare');
    return this.shown() === 'picture' || mode === 'first' || mode === 'second' ? mode : 'side';
  }

  isToned(): boolean {
    return this.quality !== null && this.context.state.get('tone') === 'best';
  }

  /** Returns the number of pixels of views that are read for what is shown. */
  units(): number {
    const isSide = this.isComparison && ['side', 'difference'].includes(this.compared());
    return this.item.width * this.item.height * (this.camera.numTaps || 4) * (isSide ? 2 : 1);
  }

  layout(): void {
    const { stage } = this.context;
    const isGrid = this.shown() === 'grid', isRelief = this.shown() === 'relief';
    const isSide = this.compared() === 'side';
    this.sheet.hidden = !isGrid;
    this.all[0]!.pane.caption.textContent = this.captionOfFirst();
    this.all.forEach(({ pane }, i) => (pane.root.hidden = isGrid || (i === 1 && !isSide)));
    this.arrange(this.isComparison && isSide, isRelief);
    const [rows, columns] = this.item.views;
    setSize(this.sheet, ...fit(this.item.width * columns, this.item.height * rows, stage.clientWidth - 16, stage.clientHeight - 16));
  }

  /** Two pictures are beside or above each other, as they become larger. Each leaves out the EPI that would take the room
   *  that they share. */
  private arrange(areTwo: boolean, isRelief: boolean): void {
    const { stage } = this.context;
    const [width, height] = [stage.clientWidth - 2 * paddingPx, stage.clientHeight - 2 * paddingPx];
    const half = (length: number) => Math.floor((length - paddingPx) / 2);
    const beside: Arrangement = [half(width), height, { row: true, column: false }];
    const above: Arrangement = [width, half(height), { row: false, column: true }];
    const area = ([boxWidth, boxHeight, epis]: Arrangement) => {
      const sizes = this.all[0]!.pane.sizesIn(boxWidth, boxHeight, epis);
      return sizes.width * sizes.height;
    };
    const isAbove = areTwo && area(above) > area(beside);
    stage.style.flexDirection = isAbove ? 'column' : '';
    const [boxWidth, boxHeight, epis] = !areTwo ? [width, height, undefined] : isAbove ? above : beside;
    for (const { pane } of this.all) pane.layout(boxWidth, boxHeight, isRelief, epis);
  }

  /** The first pane may also show both light fields at once, or only the second one. */
  private captionOfFirst(): string {
    const [first, second] = [this.first.item.name, this.second.item.name];
    switch (this.isComparison && this.compared()) {
      case 'swipe': return `left ${first}, right ${second}`;
      case 'difference': return `${second} minus ${first}: brighter red, darker blue`;
      case 'second': return second;
      default: return first;
    }
  }

  /** Paints at a scale; 0 = only the EPIs. Returns the number of pixels of views that were read. */
  paint(scale: number): number {
    const { painter, state } = this.context;
    const common = { ...lightFieldUniforms(this.first, this.second), ...this.secondTone(), ...toneUniforms(state) };
    const camera = this.camera.uniforms(state, this.item.views);
    const width = Math.max(1, Math.round(this.item.width * scale));
    const height = Math.max(1, Math.round(this.item.height * scale));
    const part = partOf(state);
    const split = part.x + state.get('split') * part.size; // of the whole picture: the line stays in the part that is shown
    for (const { pane, isSecond } of this.all) {
      if (pane.root.hidden) continue;
      const mode = this.isComparison ? (modes[this.compared()] ?? Number(isSecond)) : 0;
      const { map, relief, views } = this.all[mode === 1 ? 1 : 0]!;
      if (this.shown() === 'relief') {
        if (map?.isKnown && scale > 0) relief!.paint(pane.picture, state, scale, { ...lightFieldUniforms(views, views), ...toneUniforms(state) });
        pane.drawLines(null);
        continue;
      }
      const values = { ...common, ...camera, ...this.overlay(camera, mode < swipeMode ? map : null), mode, split, boost: state.get('boost') };
      if (scale > 0) painter.paint(pane.picture, width, height, pictureShader, values);
      this.paintEpis(pane, common, mode, split);
      pane.drawLines(mode === swipeMode ? state.get('split') : null);
    }
    if (!this.sheet.hidden && scale > 0) this.paintSheet(common);
    painter.finish();
    return width * height * this.camera.numTaps;
  }

  /** A shader needs a texture even if there is no overlay. */
  private overlay(camera: Record<string, Uniform>, map: DisparityMap | null): Record<string, Uniform> {
    const { state } = this.context;
    const opacity = this.shown() === 'disparity' ? 1 : state.get('overlay');
    return map?.uniforms(state, opacity) ?? { disparities: camera['taps']!, overlay: 0, followsMap: false };
  }

  private secondTone(): Record<string, Uniform> {
    const tone = this.isToned() ? this.quality!.of(this.context.state.get('cycle'))?.tone : undefined;
    return tone ? { secondTone: tone } : {};
  }

  private paintEpis(pane: Pane, common: Record<string, Uniform>, mode: number, split: number): void {
    const { painter, state } = this.context;
    const { row, column } = pane.cut();
    const [rows, columns] = this.item.views;
    const view = nearestView(this.item.views, { x: state.get('x'), y: state.get('y') });
    const isSecond = mode === swipeMode ? column / this.item.width >= split : mode > 0;
    if (this.isSingleView) return;
    const values = { ...common, isSecond };
    const part = partOf(state);
    const length = (pixels: number, shownPx: number) => (part.size < 1 ? Math.max(Math.round(shownPx * Math.min(devicePixelRatio, 2)), 1) : pixels);
    painter.paint(pane.rowEpi, length(this.item.width, pane.rowEpi.clientWidth), columns, epiShader,
      { ...values, isVertical: false, fixedView: Math.floor(view / columns), fixedPixel: row, part: [part.x, 0, part.size, 1] });
    painter.paint(pane.columnEpi, rows, length(this.item.height, pane.columnEpi.clientHeight), epiShader,
      { ...values, isVertical: true, fixedView: view % columns, fixedPixel: column, part: [0, part.y, 1, part.size] });
  }

  private paintSheet(common: Record<string, Uniform>): void {
    const ratio = Math.min(devicePixelRatio, 2);
    const [width, height] = [Math.round(this.sheet.clientWidth * ratio), Math.round(this.sheet.clientHeight * ratio)];
    if (width > 0 && height > 0) this.context.painter.paint(this.sheet, width, height, gridShader, { ...common, isSecond: false, sheet: [width, height] });
  }

  /** Describes what is under the cursor. */
  pointed(): string {
    const { row, column } = this.all[0]!.pane.cut();
    const values = this.all.map(({ isSecond, views }) => `${this.isComparison ? `${views.item.name} ` : ''}${this.valueAt(column, row, isSecond)}`);
    const known = this.all.map(({ map }) => map?.textAt(column, row)).filter((text) => text != null);
    const disparity = known.length > 0 ? `; disparity ${known.join(' and ')}` : '';
    return `x ${column}, y ${row}: ${values.join(', ')}${disparity}`;
  }

  /** Returns the value of a pixel of the picture, before gain and gamma. */
  private valueAt(x: number, y: number, isSecond: boolean): string {
    const { painter, state } = this.context;
    const { width, height } = this.item;
    const camera = this.camera.uniforms(state, this.item.views);
    const map = this.all.find((shown) => shown.isSecond === isSecond)?.map ?? null;
    const whole = { ...lightFieldUniforms(this.first, this.second), ...camera, ...this.overlay(camera, map), overlay: 0, mode: Number(isSecond) };
    const colour = painter.read(1, 1, pictureShader, { ...whole, part: [x / width, y / height, 1 / width, 1 / height] });
    const isGrey = (isSecond ? this.second : this.first).isGrey;
    return [...colour.subarray(0, isGrey ? 1 : 3)].map((value) => (value / 255).toFixed(3)).join(' ');
  }

  private choose(place: { x: number; y: number }): void {
    const [rows, columns] = this.item.views;
    const { state } = this.context;
    state.set('x', clamp(Math.floor(place.x * columns), 0, columns - 1) - (columns - 1) / 2);
    state.set('y', clamp(Math.floor(place.y * rows), 0, rows - 1) - (rows - 1) / 2);
    state.set('show', 'picture');
  }

  /** Returns the relief of the first light field with a map that is shown, as a glTF file. */
  async glb(): Promise<Blob> {
    const { state } = this.context;
    const { relief, views } = this.all.find((shown) => shown.relief && !shown.pane.root.hidden)!;
    return relief!.glb(state, { ...lightFieldUniforms(views, views), ...toneUniforms(state) });
  }

  pictures(): { name: string; canvas: HTMLCanvasElement }[] {
    if (!this.sheet.hidden) return [{ name: 'views', canvas: this.sheet }];
    const shown = this.all.filter(({ pane }) => !pane.root.hidden);
    return shown.map(({ pane, isSecond }) => ({ name: isSecond ? 'second' : 'picture', canvas: pane.picture }));
  }

  close(): void {
    this.context.stage.style.flexDirection = '';
    for (const { views, map, relief } of this.all) [views, map, relief].forEach((part) => part?.close());
  }
}
