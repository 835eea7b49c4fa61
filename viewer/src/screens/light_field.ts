// One light field or two light fields side by side: parallax, focus, synthetic aperture, EPIs, all views, disparity and
// relief, gain and gamma.
import { nearestView, shapes } from '../aperture';
import { ApertureMap } from '../aperture_map';
import { numFrames, paths, placeOnPath, recordGif, recordVideo, videoEndings, type Place } from '../animation';
import { busy } from '../busy';
import { QualityFigures } from '../comparison';
import { isLivePage, type Comparison, type LightFieldItem } from '../document';
import { disparityColour, drawColours, sequential, type Colour } from '../colour_map';
import { canvas, clamp, element, placeOn } from '../dom';
import { DisparityMap } from '../disparity_map';
import { FrameClock } from '../frame_clock';
import { Camera, LightFieldViews, lightFieldUniforms, maxDisparity, middleOf, toneUniforms } from '../light_field';
import { Pane } from '../pane';
import type { Uniform } from '../painter';
import { pressReliefKey, Relief } from '../relief';
import { fit, focusOn, setSize, type Context, type Screen } from '../screen';
import { saveBlob } from '../screenshot';
import { epiShader, gridShader, pictureShader } from '../shaders';
import type { Key } from '../state';
import { pressViewKey, viewKeys } from '../view_keys';
import { partOf, zoomKeys } from '../zoom';

const keysWhileMoving: Key[] = ['x', 'y', 'focus', 'tiltx', 'tilty', 'size', 'split', 'gain', 'gamma', 'boost', 'overlay', 'turn', 'tip', 'depth'];
const keysOfPart: Key[] = ['zoom', 'panx', 'pany'];
const modes: Record<string, number> = { first: 0, second: 1, swipe: 2, difference: 3 };
const swipeMode = 2;

const signed = (value: number) => (value > 0 ? '+' : '') + value.toFixed(2);

export class LightFieldScreen implements Screen {
  readonly keys: [string, string][] = [
    ...viewKeys,
    ...zoomKeys,
    ['g', 'all views'],
    ['< and >', 'the cycle before and after'],
  ];
  private readonly first: LightFieldViews;
  private readonly second: LightFieldViews;
  private readonly camera: Camera;
  private readonly map: ApertureMap;
  private readonly clock = new FrameClock((scale) => this.paint(scale));
  private readonly epiClock = new FrameClock(() => this.paint(0));
  private readonly panes: { pane: Pane; views: LightFieldViews; map: DisparityMap | null; relief: Relief | null; isSecond: boolean }[] = [];
  private readonly sheet = canvas('All views. Press on one to look from there.', 'sheet');
  private readonly quality: QualityFigures | null = null;
  private swipeSlider: HTMLElement | null = null;
  private boostSlider: HTMLElement | null = null;
  private reliefSlider: HTMLElement | null = null;
  private overlaySlider: HTMLElement | null = null;
  private cycleSlider: HTMLElement | null = null;
  private readonly note = element('p', { class: 'figures', 'aria-live': 'polite' });
  private readonly isLive: boolean; // cycles may be added
  private numLoading = 0;
  private isJumping = false;
  private readonly disparity: DisparityMap | null; // of the first one that has a map
  private isRecording = false;
  private isClosed = false;

  constructor(
    private readonly context: Context,
    item: LightFieldItem,
    private readonly comparison?: { item: LightFieldItem; figures: Comparison },
  ) {
    const { source, painter, state } = context;
    this.isLive = context.document.is_growing === true && !isLivePage(context.document);
    this.first = new LightFieldViews(item, source, painter);
    this.second = comparison ? new LightFieldViews(comparison.item, source, painter) : this.first;
    this.camera = new Camera(painter);
    if (comparison) this.quality = new QualityFigures(comparison.figures);
    this.map = new ApertureMap(state, item.views, context.say);
    this.addPane(this.first, false);
    if (comparison) this.addPane(this.second, true);
    this.disparity = this.panes.find(({ map }) => map)?.map ?? null;
    // The maps of the truth and of the reconstruction have the same colours.
    for (const { map } of this.panes) if (map) map.range = this.disparity!.range;
    const overlay = comparison ? 0 : this.isSingleView ? 1 : 0.5;
    state.start({ x: middleOf(item.views[1]), y: middleOf(item.views[0]), overlay });
    this.addControls();
    this.sheet.addEventListener('click', (event) => this.choose(placeOn(this.sheet, event)));
    context.stage.append(this.sheet);
    this.load();
  }

  isLoading(): boolean {
    return this.numLoading > 0;
  }

  private get item(): LightFieldItem {
    return this.first.item;
  }

  private get isSingleView(): boolean {
    return this.item.views[0] * this.item.views[1] === 1;
  }

  private addPane(views: LightFieldViews, isSecond: boolean): void {
    const { item } = views;
    const focusAt = (x: number, y: number) => focusOn(this.context, x, y, views.disparityAt(x, y));
    const pane = new Pane(item.name, item, this.context.state, focusAt);
    const map = item.disparity ? new DisparityMap(this.context.painter, [item.width, item.height], item.views, item.disparity.view) : null;
    if (map) map.range = item.disparity!.range;
    this.panes.push({ pane, views, map, relief: map && new Relief(this.context.painter, map), isSecond });
    this.context.stage.append(pane.root);
  }

  private addControls(): void {
    const { panel, state } = this.context;
    if (this.comparison) {
      this.swipeSlider = panel.slider('split', 'Swipe', { low: 0, high: 1, step: 0.005, text: (value) => `${Math.round(100 * value)} %` });
      this.boostSlider = panel.slider('boost', 'Differences times', { low: 1, high: 20, step: 0.5, text: (value) => value.toFixed(1) });
      panel.group('Compare',
        panel.choice('compare', 'Show', { side: 'side by side', swipe: 'swipe', difference: 'difference', first: 'the first', second: 'the second' }),
        this.swipeSlider, this.boostSlider,
        panel.choice('tone', 'Brightness', { stored: 'as stored', best: 'most similar' }), this.quality!.root);
    }
    this.addTimeControls();
    this.addPictureControls();
    if (!this.isSingleView) this.addViewControls();
    panel.group('Brightness',
      panel.slider('gain', 'Gain', { low: 0.1, high: 8, step: 0.05 }),
      panel.slider('gamma', 'Gamma', { low: 0.4, high: 3, step: 0.05 }));
    if (!this.isSingleView) this.addFilmControls();
    panel.root.append(panel.button('Reset', () => state.reset()));
  }

  private addViewControls(): void {
    const { panel } = this.context;
    const [rows, columns] = this.item.views;
    const psnrBar = this.quality ? [this.bar('Colours of PSNR', sequential, this.quality.worst, this.quality.best)] : [];
    panel.group('Viewpoint', this.map.canvas, ...psnrBar,
      panel.slider('x', 'To the right', { low: -(columns - 1) / 2, high: (columns - 1) / 2, step: 0.05, text: signed }),
      panel.slider('y', 'Down', { low: -(rows - 1) / 2, high: (rows - 1) / 2, step: 0.05, text: signed }));
    panel.group('Focus',
      panel.slider('focus', 'Disparity, px per view', { low: -maxDisparity, high: maxDisparity, step: 0.01, text: signed }),
      panel.slider('tiltx', 'Tilt to the right', { low: -4, high: 4, step: 0.05, text: signed }),
      panel.slider('tilty', 'Tilt downwards', { low: -4, high: 4, step: 0.05, text: signed }));
    panel.group('Aperture',
      panel.slider('size', 'Radius, views', { low: 0, high: Math.ceil(Math.hypot(rows, columns) / 2), step: 0.05 }),
      panel.choice('shape', 'Shape', shapes));
  }

  private addFilmControls(): void {
    const { panel } = this.context;
    const videos = videoEndings().map((ending) =>
      panel.button(`Save ${ending === 'webm' ? 'WebM' : 'MP4'}`, () => this.record(ending, (picture, paint) => recordVideo(ending, picture, paint))));
    panel.group('Film', panel.choice('path', 'Path', paths), ...videos, panel.button('Save GIF', () => this.record('gif', recordGif)));
  }

  private addTimeControls(): void {
    const { panel } = this.context;
    if (this.item.cycles.length < 2 && !this.isLive) return;
    const label = (cycle: number) => this.item.cycles[cycle]?.label ?? '';
    this.cycleSlider = panel.slider('cycle', 'Cycle', { low: 0, high: this.item.cycles.length - 1, step: 1, text: label });
    const newest = this.isLive ? [panel.choice('newest', 'New cycles', { show: 'show each', stay: 'stay at this one' })] : [];
    panel.group('Time', this.cycleSlider, this.note, ...newest);
  }

  private addPictureControls(): void {
    const { panel } = this.context;
    const ways = { picture: 'picture', ...(this.disparity && { disparity: 'disparity', relief: 'relief' }), ...(!this.comparison && !this.isSingleView && { grid: 'all views' }) };
    const parts: HTMLElement[] = [];
    if (this.disparity) {
      const [near, far] = this.disparity.range;
      const numbers = [0, 0.25, 0.5, 0.75, 1].map((share) => element('span', {}, (near + share * (far - near)).toFixed(2)));
      this.reliefSlider = panel.slider('depth', 'Depth of the relief', { low: 0, high: 1.5, step: 0.05 });
      this.overlaySlider = panel.slider('overlay', 'Colours of disparity', { low: 0, high: 1, step: 0.05, text: (value) => `${Math.round(100 * value)} %` });
      parts.push(this.overlaySlider, this.reliefSlider,
        this.bar('Colours of disparity from near to far', disparityColour, ...numbers),
        element('p', { class: 'figures ends' }, element('span', {}, 'near'), element('span', {}, 'px per view step'), element('span', {}, 'far')));
    }
    if (Object.keys(ways).length > 1) panel.group('Picture', panel.choice('show', 'Show', ways), ...parts);
  }

  /** A colour bar with numbers along it. */
  private bar(name: string, colourOf: (share: number) => Colour, ...numbers: HTMLElement[]): HTMLElement {
    const bar = canvas(name, 'bar');
    drawColours(bar, colourOf);
    return element('div', {}, bar, element('p', { class: 'figures ends' }, ...numbers));
  }

  /** What is shown of the light fields; a damaged address may ask for something else. */
  private shown(): string {
    const show = this.context.state.get('show');
    const isThere = show === 'grid' ? !this.comparison : this.disparity !== null;
    return isThere ? show : 'picture';
  }

  /** How two light fields are compared. Colours and reliefs are not mixed. */
  private compared(): string {
    const mode = this.context.state.get('compare');
    return this.shown() === 'picture' || mode === 'first' || mode === 'second' ? mode : 'side';
  }

  private isToned(): boolean {
    return this.quality !== null && this.context.state.get('tone') === 'best';
  }

  private load(): void {
    const cycle = this.context.state.get('cycle');
    for (const { map, views } of this.panes) {
      if (!map) continue;
      const end = busy();
      map.load(cycle, views.item.disparity!, this.context.source).then(() => this.clock.ask(false, this.units())).catch((error) => this.context.fail(error)).finally(end);
    }
    const all = this.comparison ? [this.first, this.second] : [this.first];
    this.note.textContent = this.item.cycles[Math.round(cycle)]?.note ?? '';
    for (const views of all) {
      const end = busy();
      ++this.numLoading;
      views.load(cycle, (share) => {
        if (this.isClosed) return;
        this.context.say(share < 1 ? `loading views, ${Math.round(100 * share)} %` : '');
        this.clock.ask(false, this.units());
      }).catch((error) => this.context.fail(error)).finally(() => {
        --this.numLoading;
        end();
        this.showNewest();
      });
    }
  }

  grow(): void {
    const slider = this.cycleSlider?.querySelector('input');
    if (slider) slider.max = String(this.item.cycles.length - 1);
    this.showNewest();
  }

  /** Waits for the cycle that is being loaded; otherwise, cycles in quick succession would never be complete. */
  private showNewest(): void {
    const { state } = this.context;
    if (!this.isLive || this.isClosed || this.numLoading > 0 || state.get('newest') !== 'show') return;
    this.isJumping = true;
    state.set('cycle', this.item.cycles.length - 1);
    this.isJumping = false;
  }

  follow(key: Key): void {
    if (key === 'cycle' && this.isLive && !this.isJumping) this.context.state.set('newest', 'stay');
    if (key === 'newest') this.showNewest();
    if (key === 'cycle' || key === 'tab') this.load();
    if (key === 'show' || key === 'compare' || key === 'tab') this.layout();
    if (this.isRecording) return; // the recording paints its frames itself
    if (key === 'row' || key === 'column') this.point();
    else if (keysOfPart.includes(key) && this.shown() !== 'relief') this.epiClock.ask(false, 1);
    else this.clock.ask(keysWhileMoving.includes(key), this.units());
  }

  /** States what is under the cursor. */
  private point(): void {
    this.epiClock.ask(false, 1);
    const { row, column } = this.panes[0]!.pane.cut();
    const values = this.panes.map(({ isSecond, views }) => `${this.comparison ? `${views.item.name} ` : ''}${this.valueAt(column, row, isSecond)}`);
    const known = this.panes.map(({ map }) => map?.at(column, row)).filter((value) => value != null);
    const disparity = known.length > 0 ? `; disparity ${known.map((value) => value.toFixed(3)).join(' and ')} px per view` : '';
    this.context.say(`x ${column}, y ${row}: ${values.join(', ')}${disparity}`);
  }

  /** Returns the value of a pixel of the picture, before gain and gamma. */
  private valueAt(x: number, y: number, isSecond: boolean): string {
    const { painter, state } = this.context;
    const { width, height } = this.item;
    const whole = { ...lightFieldUniforms(this.first, this.second), ...this.camera.uniforms(state, this.item.views), ...this.overlay({}, null), mode: Number(isSecond) };
    const colour = painter.read(1, 1, pictureShader, { ...whole, part: [x / width, y / height, 1 / width, 1 / height] });
    const isGrey = (isSecond ? this.second : this.first).isGrey;
    return [...colour.subarray(0, isGrey ? 1 : 3)].map((value) => (value / 255).toFixed(3)).join(' ');
  }

  layout(): void {
    const { stage } = this.context;
    const isGrid = this.shown() === 'grid', isRelief = this.shown() === 'relief';
    const isSide = this.compared() === 'side';
    this.sheet.hidden = !isGrid;
    if (this.swipeSlider) this.swipeSlider.hidden = this.compared() !== 'swipe';
    this.panes[0]!.pane.caption.textContent = this.captionOfFirst();
    if (this.boostSlider) this.boostSlider.hidden = this.compared() !== 'difference';
    if (this.reliefSlider) this.reliefSlider.hidden = !isRelief;
    if (this.overlaySlider) this.overlaySlider.hidden = this.shown() === 'disparity';
    this.panes.forEach(({ pane }, i) => (pane.root.hidden = isGrid || (i === 1 && !isSide)));
    const isWide = stage.clientWidth >= stage.clientHeight;
    const both = this.comparison && isSide ? 2 : 1;
    const width = stage.clientWidth / (isWide ? both : 1) - 16;
    const height = stage.clientHeight / (isWide ? 1 : both) - 16;
    for (const { pane } of this.panes) pane.layout(width, height, isRelief);
    const [rows, columns] = this.item.views;
    setSize(this.sheet, ...fit(this.item.width * columns, this.item.height * rows, stage.clientWidth - 16, stage.clientHeight - 16));
    this.clock.ask(false, this.units());
  }

  /** The first pane may also show both light fields at once, or only the second one. */
  private captionOfFirst(): string {
    const [first, second] = [this.first.item.name, this.second.item.name];
    switch (this.comparison && this.compared()) {
      case 'swipe': return `left ${first}, right ${second}`;
      case 'difference': return `${second} minus ${first}: brighter red, darker blue`;
      case 'second': return second;
      default: return first;
    }
  }

  private units(): number {
    const isSide = this.comparison && ['side', 'difference'].includes(this.compared());
    return this.item.width * this.item.height * (this.camera.numTaps || 4) * (isSide ? 2 : 1);
  }

  /** Paints at a scale; 0 = only the EPIs. Returns the number of pixels of views that were read. */
  private paint(scale: number): number {
    if (this.isClosed) return 1;
    try {
      return this.paintPanes(scale);
    } catch (error) {
      this.context.fail(error);
      return 1;
    }
  }

  private paintPanes(scale: number): number {
    const { painter, state } = this.context;
    const common = { ...lightFieldUniforms(this.first, this.second), ...this.secondTone(), ...toneUniforms(state) };
    const camera = this.camera.uniforms(state, this.item.views);
    const width = Math.max(1, Math.round(this.item.width * scale));
    const height = Math.max(1, Math.round(this.item.height * scale));
    for (const { pane, isSecond } of this.panes) {
      if (pane.root.hidden) continue;
      const mode = this.comparison ? (modes[this.compared()] ?? Number(isSecond)) : 0;
      const split = state.get('split');
      const { map, relief, views } = this.panes[mode === 1 ? 1 : 0]!;
      if (this.shown() === 'relief') {
        if (map?.isKnown && scale > 0) relief!.paint(pane.picture, state, scale, { ...lightFieldUniforms(views, views), ...toneUniforms(state) });
        pane.drawLines(null);
        continue;
      }
      const values = { ...common, ...camera, ...this.overlay(camera, mode < swipeMode ? map : null), mode, split, boost: state.get('boost') };
      if (scale > 0) painter.paint(pane.picture, width, height, pictureShader, values);
      this.paintEpis(pane, common, mode);
      pane.drawLines(mode === swipeMode ? split : null);
    }
    if (!this.sheet.hidden && scale > 0) this.paintSheet(common);
    painter.finish();
    this.showFigures();
    this.map.draw(this.camera.weights);
    return width * height * this.camera.numTaps;
  }

  /** A shader needs a texture even if there is no overlay. */
  private overlay(camera: Record<string, Uniform>, map: DisparityMap | null): Record<string, Uniform> {
    const { state } = this.context;
    const opacity = this.shown() === 'disparity' ? 1 : state.get('overlay');
    return map?.uniforms(opacity, { x: state.get('x'), y: state.get('y') }) ?? { disparities: camera['taps']!, overlay: 0 };
  }

  private secondTone(): Record<string, Uniform> {
    const tone = this.isToned() ? this.quality!.of(this.context.state.get('cycle'))?.tone : undefined;
    return tone ? { secondTone: tone } : {};
  }

  private paintEpis(pane: Pane, common: Record<string, Uniform>, mode: number): void {
    const { painter, state } = this.context;
    const { row, column } = pane.cut();
    const [rows, columns] = this.item.views;
    const view = nearestView(this.item.views, { x: state.get('x'), y: state.get('y') });
    const isSecond = mode === swipeMode ? column / this.item.width >= state.get('split') : mode > 0;
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

  private showFigures(): void {
    if (!this.quality) return;
    const cycle = this.context.state.get('cycle');
    this.map.showPsnr(this.quality.psnr(cycle, this.isToned()));
    this.quality.show(cycle, this.isToned());
  }

  /** Goes along the path once, records the first picture and saves the film; then all is as before. */
  private async record(ending: string, recorder: typeof recordGif): Promise<void> {
    if (this.isRecording || !this.sheet.hidden) return;
    const { state, say } = this.context;
    const now: Place = { x: state.get('x'), y: state.get('y'), focus: state.get('focus') };
    const go = ({ x, y, focus }: Place) => {
      state.set('x', x);
      state.set('y', y);
      state.set('focus', focus);
    };
    const range: [number, number] = this.disparity?.range ?? [-2, 2];
    const end = busy();
    this.isRecording = true;
    try {
      const film = await recorder(this.panes[0]!.pane.picture, (i) => {
        if (this.isClosed) throw new Error('The film ended with what it showed.');
        go(placeOnPath(state.get('path'), i, this.item.views, now, range));
        this.paint(1);
        say(`recording, ${Math.round((100 * i) / numFrames)} %`);
      });
      saveBlob(this.item.name, `${state.get('path')}.${ending}`, film);
      say(`film saved, ${(film.size / 1e6).toFixed(1)} MB`);
    } catch (error) {
      say(error instanceof Error ? error.message : String(error));
    } finally {
      this.isRecording = false;
      end();
      if (!this.isClosed) go(now);
    }
    this.clock.ask(false, this.units());
  }

  private choose(place: { x: number; y: number }): void {
    const [rows, columns] = this.item.views;
    const { state } = this.context;
    state.set('x', clamp(Math.floor(place.x * columns), 0, columns - 1) - (columns - 1) / 2);
    state.set('y', clamp(Math.floor(place.y * rows), 0, rows - 1) - (rows - 1) / 2);
    state.set('show', 'picture');
  }

  press(key: string): boolean {
    const { state } = this.context;
    if (this.panes[0]!.pane.zoom.press(key) || (this.shown() === 'relief' && pressReliefKey(state, key))) return true;
    if (pressViewKey(state, this.item.views, key)) return true;
    switch (key) {
      case 'g': state.set('show', state.get('show') === 'grid' ? 'picture' : 'grid'); return true;
      case '<': state.set('cycle', Math.max(state.get('cycle') - 1, 0)); return true;
      case '>': state.set('cycle', Math.min(state.get('cycle') + 1, this.item.cycles.length - 1)); return true;
      default: return false;
    }
  }

  pictures(): { name: string; canvas: HTMLCanvasElement }[] {
    if (!this.sheet.hidden) return [{ name: 'views', canvas: this.sheet }];
    const shown = this.panes.filter(({ pane }) => !pane.root.hidden);
    return shown.map(({ pane, isSecond }) => ({ name: isSecond ? 'second' : 'picture', canvas: pane.picture }));
  }

  close(): void {
    this.isClosed = true;
    for (const views of new Set([this.first, this.second])) views.close();
    for (const { map, relief } of this.panes) [map, relief].forEach((part) => part?.close());
  }
}
