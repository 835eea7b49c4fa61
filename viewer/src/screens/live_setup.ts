// The tab for the set-up of a live source: a picture of the events and its sharpness, rates, triggers, cycles, losses,
// and the switch of the recording.
import { CameraControls } from '../camera_controls';
import type { LiveItem } from '../document';
import { canvas, element, FigureList } from '../dom';
import { askForPicture, command, countText, drawGrey, FindingList, followStatistics, rest, type Statistics } from '../live';
import { fit, setSize, type Context, type Screen } from '../screen';

interface EventsHeader {
  width: number;
  height: number;
  events: number;
  sharpness: number;
  cycle?: number; // the newest one, and the sharpness of its event images
  cycle_sharpness?: number;
}

const pauseMs = 60; // between two pictures of events
const meanOf = 8; // cycles or, until there is one, pictures

const sum = (counts: Record<string, number>): number => Object.values(counts).reduce((all, count) => all + count, 0);

const reasons = (counts: Record<string, number>): [string, string][] =>
  Object.entries(counts).filter(([, count]) => count > 0).map(([reason, count]) => [reason, countText(count)]);

export class LiveSetupScreen implements Screen {
  readonly keys: [string, string][] = [['r', 'record, or stop']];
  private readonly picture = canvas('The newest events: brighter = ON, darker = OFF', 'picture');
  private readonly figure: HTMLElement;
  private readonly sharpness = new FigureList();
  private readonly events = new FigureList();
  private readonly triggers = new FigureList();
  private readonly cycles = new FigureList();
  private readonly losses = new FigureList();
  private readonly recording = new FigureList();
  private readonly findings = new FindingList();
  private readonly problem = element('p', { class: 'advice', role: 'status' });
  private readonly recordButton: HTMLElement;
  private isRecording = false;
  private sharpest = 0;
  private last: number[] = []; // sharpness of the last cycles or pictures
  private cycle = -1; // the last one of them; -1 = pictures
  private readonly camera: CameraControls;
  private readonly cameraGroup: HTMLElement;
  private isClosed = false;

  constructor(private readonly context: Context, private readonly item: LiveItem) {
    const { panel, stage } = context;
    this.figure = element('figure', { class: 'live' }, this.picture);
    stage.append(this.figure);
    this.recordButton = panel.button('Record', () => this.switchRecording());
    panel.group('Findings', this.findings.root, this.problem);
    panel.group('Sharpness', this.sharpness.root, panel.button('Reset the best', () => (this.sharpest = 0)));
    this.camera = new CameraControls(context.say);
    this.cameraGroup = panel.group('Camera', this.camera.root);
    this.cameraGroup.hidden = true;
    panel.group('Recording', this.recording.root, this.recordButton);
    panel.group('Events', this.events.root);
    panel.group('Triggers', this.triggers.root);
    panel.group('Cycles', this.cycles.root);
    panel.group('Left out', this.losses.root);
    const fail = (error: unknown) => this.isClosed || context.fail(error);
    this.followEvents().catch(fail);
    followStatistics(() => this.isClosed, (now) => this.show(now)).catch(fail);
  }

  private async followEvents(): Promise<void> {
    while (!this.isClosed) {
      const got = await askForPicture<EventsHeader>('events');
      if (got) this.showEvents(got.header, got.pixels);
      await rest(pauseMs);
    }
  }

  private showEvents(header: EventsHeader, pixels: Uint8Array): void {
    const { width, height, events } = header;
    drawGrey(this.picture, width, height, pixels);
    this.addSharpness(header);
    const mean = this.last.reduce((sum, value) => sum + value, 0) / this.last.length;
    if (this.last.length === meanOf) this.sharpest = Math.max(this.sharpest, mean);
    const share = this.sharpest > 0 ? `${Math.round((100 * mean) / this.sharpest)} %` : `${this.last.length} of ${meanOf} seen`;
    this.sharpness.show([
      ['now', mean.toFixed(3)],
      ['best so far', this.sharpest > 0 ? this.sharpest.toFixed(3) : ''],
      ['share of the best', share],
      ['events in the picture', countText(events)],
    ]);
  }

  /** Whole cycles are compared, because the pictures show different patterns. */
  private addSharpness({ sharpness, cycle = -1, cycle_sharpness = sharpness }: EventsHeader): void {
    if (cycle >= 0 && cycle === this.cycle) return;
    if (cycle < 0 !== this.cycle < 0) {
      this.last = [];
      this.sharpest = 0;
    }
    this.cycle = cycle;
    this.last = [...this.last, cycle_sharpness].slice(-meanOf);
  }

  private show(now: Statistics): void {
    const expected = (1e6 * now.schedule.patterns) / now.schedule.cycle_us;
    this.events.show([
      ['per second', countText(now.events_per_s)],
      ['ON', `${(100 * now.on_share).toFixed(1)} %`],
      ['all', countText(now.events)],
    ]);
    const rates = Object.entries(now.triggers_per_s).map(([channel, rate]): [string, string] => [`channel ${channel}, per second`, rate.toFixed(1)]);
    this.triggers.show([
      ...(rates.length > 0 ? rates : [['triggers', 'none so far'] as [string, string]]),
      ['patterns of the schedule, per second', expected.toFixed(1)],
    ]);
    this.findings.show(now.findings);
    this.camera.show(now.camera ?? []);
    this.cameraGroup.hidden = !now.camera?.length;
    this.problem.textContent = now.error ?? (now.findings.length === 0 ? 'none so far' : '');
    this.problem.className = now.error === null ? 'figures' : 'advice';
    this.cycles.show([
      ['complete', String(now.cycles)],
      ['dropped', String(sum(now.dropped_cycles))],
      ...reasons(now.dropped_cycles),
      ['confidence', `${now.confidence.toFixed(2)} (least ${now.least_confidence.toFixed(2)})`],
      ['delay of events after triggers', now.event_delay_us === null ? 'unknown' : `${now.event_delay_us} us`],
    ]);
    const sensor: [string, string][] = now.sensor_dropped_share === undefined ? [] : [['by the sensor', `${(100 * now.sensor_dropped_share).toFixed(1)} %`]];
    this.losses.show([
      ...reasons(now.left_out),
      ...sensor,
      ['from hot pixels, pixels removed', String(now.silenced_pixels)],
      ['because reading was too slow', now.may_have_lost_events ? 'yes' : 'none'],
    ]);
    this.showRecording(now.recording);
  }

  private showRecording({ can_record, is_recording, file, bytes, error }: Statistics['recording']): void {
    this.isRecording = is_recording;
    this.recordButton.textContent = is_recording ? 'Stop recording' : 'Record';
    this.recordButton.toggleAttribute('disabled', !can_record);
    const rows: [string, string][] = file === '' ? [] : [['file', file.split('/').pop()!], ['size', `${(bytes / 1e6).toFixed(1)} MB`]];
    if (error !== '') rows.push(['error', error]);
    if (!can_record) rows.push(['no folder', 'start e2lf live with -o']);
    this.recording.show(rows);
  }

  private switchRecording(): void {
    command(`record?on=${this.isRecording ? 0 : 1}`).catch((error: Error) => this.context.say(error.message));
  }

  follow(): void {}
  layout(): void {
    const { stage } = this.context;
    setSize(this.picture, ...fit(this.item.width, this.item.height, stage.clientWidth - 16, stage.clientHeight - 16));
  }
  press(key: string): boolean {
    if (key !== 'r') return false;
    this.switchRecording();
    return true;
  }
  pictures(): { name: string; canvas: HTMLCanvasElement }[] {
    return [{ name: 'events', canvas: this.picture }];
  }
  close(): void {
    this.isClosed = true;
  }
}
