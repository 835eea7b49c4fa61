// The light fields of a live source at the pace of its cycles. The server renders only the displayed picture: a view, or
// the sum over a synthetic aperture.
import { apertureWeights } from '../aperture';
import { ApertureMap } from '../aperture_map';
import { fetchFile, type LiveItem } from '../document';
import { element } from '../dom';
import { maxDisparity } from '../light_field';
import { askForPicture, command, drawGrey, FigureList, FindingList, followStatistics, rest, SettingControl, type Framed, type Statistics } from '../live';
import { Pane } from '../pane';
import { focusOn, type Context, type Screen } from '../screen';
import { pressViewKey, viewKeys } from '../view_keys';

interface PictureHeader {
  serial: number;
  width: number;
  height: number;
  row_epi: [number, number]; // width, height
  column_epi: [number, number];
  field: number;
  cycle: number;
  cycles: number;
  size: string;
  latency_s: number;
  reconstruct_s: number;
}

const rateWindowMs = 2000;

export class LiveFieldScreen implements Screen {
  readonly keys: [string, string][] = [...viewKeys, ['f', 'freeze']];
  private readonly pane: Pane;
  private readonly map: ApertureMap;
  private readonly figures = new FigureList();
  private readonly fineButton: HTMLElement;
  private readonly average: SettingControl<HTMLInputElement>;
  private readonly size: SettingControl<HTMLSelectElement>;
  private readonly findings = new FindingList();
  private readonly problem = element('p', { class: 'advice', role: 'status' });
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
    this.fineButton = panel.button('Reconstruct this one well', () => this.tell('freeze', 'fine'));
    const average = element('input', { type: 'range', min: '1', max: '16', step: '1', name: 'average', 'aria-label': 'Cycles of a still scene' });
    this.average = new SettingControl(average, (cycles) => this.tell(`average?cycles=${cycles}`));
    const size = element('select', { name: 'resolution' }, ...['auto', 'full', 'half', 'quarter'].map((name) => element('option', { value: name }, name)));
    this.size = new SettingControl(size, (to) => this.tell(`size?to=${to}`));
    panel.group('Light field', this.figures.root, this.findings.root, this.problem,
      panel.button('Freeze', () => this.tell('freeze')), this.fineButton, panel.button('Brightness anew', () => this.tell('brightness')));
    panel.group('Pace',
      element('label', { class: 'choice' }, element('span', {}, 'Size'), size),
      element('label', { class: 'slider' }, element('span', {}, 'Cycles of a still scene'), average));
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
    if (this.isClosed) return;
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
    const numPixels = header.width * header.height;
    const numOfRow = header.row_epi[0] * header.row_epi[1];
    drawGrey(this.pane.picture, header.width, header.height, pixels);
    drawGrey(this.pane.rowEpi, ...header.row_epi, pixels.subarray(numPixels, numPixels + numOfRow));
    drawGrey(this.pane.columnEpi, ...header.column_epi, pixels.subarray(numPixels + numOfRow));
    this.pane.root.dataset['cycle'] = String(header.cycle);
    this.pane.drawLines(null);
    if (header.field === this.field) return;
    this.field = header.field;
    const now = performance.now();
    this.comings = [...this.comings.filter((time) => now - time < rateWindowMs), now];
    const summed = header.cycles > 1 ? `, sum of ${header.cycles}` : '';
    this.pane.caption.textContent = `cycle ${header.cycle}${summed}: ${header.size} size, ${Math.round(1000 * header.latency_s)} ms after its last event`;
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
      ['cycles skipped', String(now.skipped_cycles)],
      ['latency, median', `${Math.round(1000 * now.latency_s.median)} ms`],
      ['latency, 90 %', `${Math.round(1000 * now.latency_s.p90)} ms`],
      ['network', now.network],
      ['size', now.size],
    ]);
    this.findings.show(now.findings);
    this.size.show(now.size_choice);
    this.average.show(String(now.average));
    this.average.control.setAttribute('aria-valuetext', `${now.average} cycles`);
    this.fineButton.toggleAttribute('disabled', now.is_refining);
    const state = now.has_ended ? 'The source has ended.' : now.fields === 0 ? 'Waiting for the first cycle.' : '';
    this.problem.textContent = now.error ?? (now.refining_error || (now.is_refining ? 'Reconstructing the frozen cycle well ...' : state));
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

  follow(): void {
    this.pane.drawLines(null);
    this.map.draw(this.weights());
    this.askNext();
  }

  private weights(): Float32Array {
    const { state } = this.context;
    return apertureWeights(this.item.views, { x: state.get('x'), y: state.get('y'), size: state.get('size'), shape: 'round' });
  }

  layout(): void {
    const { stage } = this.context;
    this.pane.layout(stage.clientWidth - 16, stage.clientHeight - 16);
  }

  press(key: string): boolean {
    if (key === 'f') this.tell('freeze');
    return key === 'f' || pressViewKey(this.context.state, this.item.views, key);
  }

  pictures(): { name: string; canvas: HTMLCanvasElement }[] {
    return [{ name: 'picture', canvas: this.pane.picture }];
  }

  close(): void {
    this.isClosed = true;
  }
}
