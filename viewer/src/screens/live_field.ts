// The light fields of a live source at the pace of its cycles. The server renders only the displayed picture: a view, or
// the sum over a synthetic aperture.
import { apertureWeights } from '../aperture';
import { ApertureMap } from '../aperture_map';
import { fetchFile, type LiveItem } from '../document';
import { clamp, element, FigureList } from '../dom';
import { maxDisparity, middleOf, toneOfGrey } from '../light_field';
import { sureSlider } from '../legend';
import { askForPicture, command, drawGrey, drawPart, FindingList, followStatistics, rest, SettingControl, type Framed, type Statistics } from '../live';
import { LiveDepth } from '../live_depth';
import { Pane } from '../pane';
import type { Pictures } from '../painter';
import { pressReliefKey } from '../relief';
import { focusOn, type Context, type Screen } from '../screen';
import { saveBlob } from '../screenshot';
import { enlargeShader } from '../shaders';
import type { Key } from '../state';
import { pressViewKey, viewKeys } from '../view_keys';
import { partOf, zoomKeys } from '../zoom';

interface PictureHeader {
  serial: number;
  width: number;
  height: number;
  row_epi: [number, number]; // width, height
  column_epi: [number, number];
  field: number;
  cycle: number;
  cycles: number;
  fused_cycles: number; // mean over the pixels; 0 = none were fused
  size: string;
  latency_s: number;
  reconstruct_s: number;
}

/** Before the number of cycles of each pixel [y, x], in a quarter of the size. */
interface FusedHeader {
  width: number;
  height: number;
  most: number; // largest number of cycles
}

const rateWindowMs = 2000;

export class LiveFieldScreen implements Screen {
  readonly keys: [string, string][] = [...viewKeys, ...zoomKeys, ['f', 'freeze'], ['c', 'fuse cycles or not']];
  private readonly pane: Pane;
  private readonly map: ApertureMap;
  private readonly figures = new FigureList();
  private readonly fineButton: HTMLElement;
  private readonly average: SettingControl<HTMLInputElement>;
  private readonly averageText = element('output');
  private readonly fuseButton: HTMLElement;
  private readonly fusedMap = element('canvas', { class: 'fused', role: 'img' });
  private readonly fusedText = element('p', { class: 'advice' });
  private isAskingFused = false;
  private readonly size: SettingControl<HTMLSelectElement>;
  private readonly findings = new FindingList();
  private readonly problem = element('p', { class: 'advice', role: 'status' });
  private readonly depth: LiveDepth;
  private readonly ways: HTMLElement; // to look at it, if there are several
  private readonly ofDepth: HTMLElement;
  private readonly ofRelief: HTMLElement;
  private grey: { header: PictureHeader; pixels: Uint8Array } | null = null;
  private small: { width: number; height: number; pictures: Pictures } | null = null;
  private isAskingDepth = false;
  private serial = 0;
  private field = 0;
  private numPending = 0;
  private asked = ''; // the parameters of the last request
  private comings: number[] = []; // arrival times of the newest light fields
  private isClosed = false;

  constructor(private readonly context: Context, private readonly item: LiveItem) {
    const { panel, state, stage } = context;
    const [rows, columns] = item.views;
    const signed = (value: number) => (value > 0 ? '+' : '') + value.toFixed(2);
    this.pane = new Pane(item.name, item, state, (x, y) => this.focusAt(x, y));
    this.map = new ApertureMap(state, item.views, context.say);
    this.depth = new LiveDepth(context.painter, item);
    state.start({ x: middleOf(columns), y: middleOf(rows), overlay: 0.3 });
    this.fineButton = panel.button('Reconstruct this one well', () => this.tell('freeze', 'fine'));
    const average = element('input', { type: 'range', min: '1', max: '16', step: '1', name: 'average', 'aria-label': 'Cycles of a still scene' });
    this.average = new SettingControl(average, (cycles) => this.tell(`average?cycles=${cycles}`));
    const size = element('select', { name: 'resolution' }, ...['auto', 'full', 'half', 'quarter'].map((name) => element('option', { value: name }, name)));
    this.size = new SettingControl(size, (to) => this.tell(`size?to=${to}`));
    panel.group('Light field', this.figures.root, this.findings.root, this.problem,
      panel.button('Freeze', () => this.tell('freeze')), this.fineButton, panel.button('Adjust brightness', () => this.tell('brightness')));
    this.ofRelief = element('div', {}, panel.slider('overlay', 'Colours on the relief', { low: 0, high: 1, step: 0.05 }),
      panel.slider('depth', 'Depth of the relief', { low: 0, high: 1.5, step: 0.05 }), panel.button('Save GLB', () => this.saveRelief()));
    this.ofDepth = element('div', {}, sureSlider(panel), this.ofRelief, this.depth.legend.root);
    this.ways = panel.group('Picture', panel.choice('show', 'Show', { picture: 'light field', disparity: 'disparity', relief: 'relief' }), this.ofDepth);
    this.ways.hidden = true;
    this.fuseButton = panel.button('Fuse cycles', () => this.switchFusing());
    panel.group('Pace',
      element('label', { class: 'choice' }, element('span', {}, 'Size'), size),
      element('label', { class: 'slider' }, element('span', {}, 'Cycles of a still scene'), average, this.averageText),
      this.fuseButton, this.fusedMap, this.fusedText);
    panel.group('Viewpoint', this.map.canvas,
      panel.slider('x', 'To the right', { low: -(columns - 1) / 2, high: (columns - 1) / 2, step: 0.05, text: signed }),
      panel.slider('y', 'Down', { low: -(rows - 1) / 2, high: (rows - 1) / 2, step: 0.05, text: signed }));
    panel.group('Focus', panel.slider('focus', 'Disparity, px per view', { low: -maxDisparity, high: maxDisparity, step: 0.01, text: signed }));
    panel.group('Aperture', panel.slider('size', 'Radius, views', { low: 0, high: Math.ceil(Math.hypot(rows, columns) / 2), step: 0.05 }));
    panel.root.append(panel.button('Reset', () => state.reset()));
    stage.append(this.pane.root);
    followStatistics(() => this.isClosed, (now) => this.show(now)).catch((error) => this.isClosed || context.fail(error));
    this.askNext();
  }

  /** Returns the parameters of the request for the current picture. */
  private look(): string {
    const { state } = this.context;
    const { row, column } = this.pane.cut();
    return `x=${state.get('x')}&y=${state.get('y')}&focus=${state.get('focus')}&radius=${state.get('size')}&row=${row}&column=${column}`;
  }

  /** A request waits at the server for the next light field. One for another look goes out beside it, but not more: the
   *  next one follows when an answer has come. */
  private askNext(): void {
    if (this.isClosed || this.way() !== 'picture') return; // disparities have the time of light fields
    const look = this.look();
    if (this.numPending > 1 || (this.numPending === 1 && look === this.asked)) return;
    this.asked = look;
    ++this.numPending;
    this.ask(look).catch((error) => this.isClosed || this.context.fail(error)).finally(() => {
      --this.numPending;
      this.askNext();
    });
  }

  private async ask(look: string): Promise<void> {
    const got = await askForPicture<PictureHeader>(`picture?after=${this.serial}&${look}`);
    if (this.isClosed) return;
    if (got && got.header.serial > this.serial) this.paint(got);
    else await rest(50);
  }

  private paint({ header, pixels }: Framed<PictureHeader>): void {
    this.serial = header.serial;
    this.grey = { header, pixels };
    this.draw();
    this.pane.root.dataset['cycle'] = String(header.cycle);
    if (header.field === this.field) return;
    this.field = header.field;
    this.count();
    const fused = header.fused_cycles > 0 ? `, fused with those before to ${header.fused_cycles.toFixed(1)} on average` : '';
    const summed = header.cycles > 1 ? `, sum of ${header.cycles}` : fused;
    this.pane.caption.textContent = `cycle ${header.cycle}${summed}: ${header.size} size, ${Math.round(1000 * header.latency_s)} ms after its last event`;
  }

  /** Draws what has come. */
  private draw(): void {
    const show = this.way();
    if (show !== 'picture') {
      this.depth.paint(this.pane.picture, this.context.state, show === 'relief');
    } else if (this.grey) {
      const { header: { width, height, row_epi, column_epi }, pixels } = this.grey;
      const numPixels = width * height, numOfRow = row_epi[0] * row_epi[1];
      const part = partOf(this.context.state);
      this.drawPicture(width, height, pixels.subarray(0, numPixels));
      drawPart(this.pane.rowEpi, ...row_epi, pixels.subarray(numPixels, numPixels + numOfRow), { x: part.x, width: part.size, y: 0, height: 1 });
      drawPart(this.pane.columnEpi, ...column_epi, pixels.subarray(numPixels + numOfRow), { x: 0, width: 1, y: part.y, height: part.size });
    }
    this.pane.drawLines(null);
  }

  /** Smaller light fields are enlarged to the size of the sensor. */
  private drawPicture(width: number, height: number, grey: Uint8Array): void {
    if (width === this.item.width || width * height === 0) return drawGrey(this.pane.picture, width, height, grey);
    const { painter } = this.context;
    if (this.small?.width !== width || this.small.height !== height) {
      if (this.small) painter.gl.deleteTexture(this.small.pictures.texture);
      this.small = { width, height, pictures: painter.pictures(width, height, 1, true) };
    }
    painter.putGrey(this.small.pictures, width, height, grey);
    const side = Math.round(this.item.width / width);
    painter.paint(this.pane.picture, side * width, side * height, enlargeShader, { ...toneOfGrey(this.small.pictures.texture, [width, height]), small: [width, height] });
  }

  /** Returns what is shown: the light field, or the disparity if the source has it. */
  private way(): string {
    const show = this.context.state.get('show');
    return !this.ways.hidden && (show === 'disparity' || show === 'relief') ? show : 'picture';
  }

  /** Requests disparities while they are shown. */
  private async followDepth(): Promise<void> {
    if (this.isAskingDepth) return;
    this.isAskingDepth = true;
    try {
      while (!this.isClosed && this.way() !== 'picture') {
        if (await this.depth.ask()) this.showDepth();
        else await rest(50);
      }
    } finally {
      this.isAskingDepth = false;
    }
  }

  private showDepth(): void {
    this.draw();
    this.count();
    this.pane.caption.textContent = this.depth.about;
  }

  private saveRelief(): void {
    this.depth.glb(this.context.state).then((file) => file && saveBlob(this.item.name, 'relief.glb', file))
      .catch((error: Error) => this.context.say(error.message));
  }

  /** States what is under the cursor. */
  private point(): void {
    if (!this.grey) return;
    const { column, row } = this.pane.cut();
    const { header: { width, height, size }, pixels } = this.grey;
    const [x, y] = [clamp(Math.floor((column * width) / this.item.width), 0, width - 1), clamp(Math.floor((row * height) / this.item.height), 0, height - 1)];
    const disparity = this.way() === 'picture' ? null : this.depth.at(column, row);
    const value = `${(pixels[y * width + x]! / 255).toFixed(3)} (${size} size)`;
    this.context.say(`x ${column}, y ${row}: ${disparity === null ? value : `disparity ${disparity.toFixed(3)} px per view`}`);
  }

  /** Notes that a light field, or a map, has come. */
  private count(): void {
    const now = performance.now();
    this.comings = [...this.comings.filter((time) => now - time < rateWindowMs), now];
  }

  /** Returns the number of light fields per second that the page has shown. */
  private rate(): number {
    const now = performance.now();
    this.comings = this.comings.filter((time) => now - time < rateWindowMs);
    if (this.comings.length < 2) return 0;
    return (1000 * (this.comings.length - 1)) / (this.comings.at(-1)! - this.comings[0]!);
  }

  private show(now: Statistics): void {
    this.figures.show([
      ['per second', this.rate().toFixed(1)],
      ['light fields', String(now.fields)],
      ['cycles skipped', now.late_cycles > 0 ? `${now.skipped_cycles}, ${now.late_cycles} as late` : String(now.skipped_cycles)],
      ['latency, median', `${Math.round(1000 * now.latency_s.median)} ms`],
      ['latency, 90 %', `${Math.round(1000 * now.latency_s.p90)} ms`],
      ['network', now.network],
      ['size', now.size],
    ]);
    this.findings.show(now.findings);
    this.size.show(now.size_choice);
    if (this.ways.hidden === now.has_depth) {
      this.ways.hidden = !now.has_depth;
      this.follow('show');
    }
    this.average.show(String(now.average));
    this.averageText.textContent = String(now.average);
    this.average.control.setAttribute('aria-valuetext', `${now.average} cycles`);
    this.showFusing(now);
    this.fineButton.toggleAttribute('disabled', now.is_refining);
    const state = now.has_ended ? 'The source has ended.' : now.fields === 0 ? 'Waiting for the first cycle.' : '';
    this.problem.textContent = now.error ?? (now.refining_error || (now.is_refining ? 'Reconstructing the frozen cycle well ...' : state));
  }

  private switchFusing(): void {
    if (!this.fuseButton.hasAttribute('disabled')) this.tell(`fuse?on=${this.fuseButton.getAttribute('aria-pressed') === 'true' ? 0 : 1}`);
  }

  private showFusing(now: Statistics): void {
    this.fuseButton.setAttribute('aria-pressed', String(now.is_fusing));
    this.fuseButton.toggleAttribute('disabled', now.fuse === 0 || now.average > 1);
    this.fusedMap.hidden = !now.is_fusing;
    if (now.is_fusing) {
      this.showFused().catch((error) => this.isClosed || this.context.fail(error));
    } else if (now.fuse === 0) {
      this.fusedText.textContent = `Cycles are not fused: ${now.fuse_obstacle}.`;
    } else {
      this.fusedText.textContent = now.average > 1 ? 'Cycles of a still scene are summed instead.' : '';
    }
  }

  /** Draws on how many cycles each region rests: black is 1, and white the largest number. */
  private async showFused(): Promise<void> {
    if (this.isAskingFused) return;
    this.isAskingFused = true;
    try {
      const got = await askForPicture<FusedHeader>('fused');
      if (!got || this.isClosed) return;
      const { header: { width, height, most }, pixels } = got;
      const mean = pixels.reduce((sum, cycles) => sum + cycles, 0) / Math.max(pixels.length, 1);
      drawGrey(this.fusedMap, width, height, pixels.map((cycles) => Math.round((255 * Math.log2(Math.max(cycles, 1))) / Math.log2(Math.max(most, 2)))));
      this.fusedText.textContent = `Cycles that each region rests on: 1 (black) to ${most} (white), ${mean.toFixed(1)} on average.`;
      this.fusedMap.setAttribute('aria-label', this.fusedText.textContent);
    } finally {
      this.isAskingFused = false;
    }
  }

  /** Sends commands one after another. */
  private tell(...commands: string[]): void {
    const all = async () => {
      for (const one of commands) {
        const { name } = await command(one);
        if (name) this.context.goTo(name);
      }
    };
    all().catch((error: Error) => this.context.say(error.message));
  }

  /** The server has the views. */
  private focusAt(x: number, y: number): void {
    const ask = async () => {
      const answer = await fetchFile(`disparity?x=${x}&y=${y}`);
      if (answer.status === 204) return;
      const { disparity } = (await answer.json()) as { disparity: number };
      if (!this.isClosed) focusOn(this.context, x, y, disparity);
    };
    ask().catch((error: Error) => this.context.say(error.message));
  }

  follow(key: Key): void {
    if (key === 'show' || key === 'tab') this.layout();
    if (this.way() !== 'picture') this.followDepth().catch((error) => this.isClosed || this.context.fail(error));
    if (key === 'row' || key === 'column') this.point();
    this.draw();
    this.map.draw(this.weights());
    this.askNext();
  }

  private weights(): Float32Array {
    const { state } = this.context;
    return apertureWeights(this.item.views, { x: state.get('x'), y: state.get('y'), size: state.get('size'), shape: 'round' });
  }

  layout(): void {
    const { stage } = this.context;
    this.ofDepth.hidden = this.way() === 'picture';
    this.ofRelief.hidden = this.way() !== 'relief';
    this.pane.layout(stage.clientWidth - 16, stage.clientHeight - 16, this.way() === 'relief');
  }

  press(key: string): boolean {
    if (this.pane.zoom.press(key) || (this.way() === 'relief' && pressReliefKey(this.context.state, key))) return true;
    if (key === 'f') this.tell('freeze');
    if (key === 'c') this.switchFusing();
    return key === 'f' || key === 'c' || pressViewKey(this.context.state, this.item, key);
  }

  pictures(): { name: string; canvas: HTMLCanvasElement }[] {
    return [{ name: 'picture', canvas: this.pane.picture }];
  }

  close(): void {
    this.isClosed = true;
    this.depth.close();
    if (this.small) this.context.painter.gl.deleteTexture(this.small.pictures.texture);
  }
}
