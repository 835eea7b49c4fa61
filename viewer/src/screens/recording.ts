// A recording as frames of accumulated events, with its event rate, triggers and cycles.
import { busy } from '../busy';
import { countKeys, CountPicture } from '../count_picture';
import type { CountImage } from '../counts';
import { inflateCounts, type RecordingItem } from '../document';
import { clamp, element } from '../dom';
import { setSize, type Context, type Screen } from '../screen';
import type { Key } from '../state';
import { TimeAxis } from '../time_axis';

const axisPx = 150;
const playMs = 80; // per frame

export class RecordingScreen implements Screen {
  readonly keys: [string, string][] = [
    ['left and right', 'the frame before and after'],
    ['space', 'play and stop'],
    ['+ and -', 'zoom in time, as the wheel and two fingers do on the time axis'],
    ['shift and wheel', 'along the time axis'],
    ...countKeys,
  ];
  private readonly picture: CountPicture;
  private readonly axis: TimeAxis;
  private readonly playButton: HTMLElement;
  private shown: { number: number; image: CountImage } | null = null;
  private wanted = -1;
  private timer = 0;

  constructor(
    private readonly context: Context,
    private readonly item: RecordingItem,
  ) {
    const { panel, state } = context;
    this.picture = new CountPicture(context, `${item.name}: events of a stretch of time, ON red, OFF blue`, item);
    this.axis = new TimeAxis(item, state, (timeUs) => this.goTo(timeUs));
    this.playButton = panel.button('Play', () => this.play());
    const frameText = (number: number) => {
      const frame = item.frames[number];
      return frame ? `${(frame.begin_us / 1000).toFixed(2)} ms` : '';
    };
    panel.group('Time',
      panel.slider('frame', 'Frame', { low: 0, high: item.frames.length - 1, step: 1, text: frameText }),
      this.playButton,
      panel.button('Zoom in', () => this.zoom(0.5)), panel.button('Zoom out', () => this.zoom(2)),
      panel.button('All of it', () => this.axis.zoom(1e6, 0.5)),
      element('p', { class: 'figures' }, this.about()));
    panel.group('Picture', ...this.picture.controls);
    this.picture.addHistogram();
    context.stage.append(this.picture.root, this.axis.canvas);
    this.load();
  }

  /** Describes the content of the time axis in words. */
  private about(): string {
    const { events, triggers, cycles } = this.item;
    const counted = (count: number, name: string) => `${count.toLocaleString('en')} ${name}${count === 1 ? '' : 's'}`;
    return `${counted(events, 'event')}: ON above the line, OFF below. ${counted(triggers.length, 'trigger')}: ticks. ${counted(cycles.length, 'cycle')} found: shaded.`;
  }

  private zoom(factor: number): void {
    const frame = this.item.frames[this.frame()];
    if (frame) this.axis.zoomAround(factor, (frame.begin_us + frame.end_us) / 2);
  }

  private frame(): number {
    return clamp(Math.round(this.context.state.get('frame')), 0, this.item.frames.length - 1);
  }

  private goTo(timeUs: number): void {
    const number = this.item.frames.findIndex((frame) => timeUs < frame.end_us);
    this.context.state.set('frame', number < 0 ? this.item.frames.length - 1 : number);
  }

  private play(): void {
    const isPlaying = this.timer !== 0;
    clearInterval(this.timer);
    this.timer = isPlaying ? 0 : window.setInterval(() => this.step(1), playMs);
    this.playButton.textContent = isPlaying ? 'Play' : 'Stop';
  }

  private step(by: number): void {
    const count = this.item.frames.length;
    this.context.state.set('frame', (this.frame() + by + count) % count);
  }

  private load(): void {
    const number = this.frame();
    const frame = this.item.frames[number];
    if (!frame || number === this.wanted) return;
    this.wanted = number;
    const end = busy();
    this.context.source.part(frame.counts).then(inflateCounts).then((counts) => {
      if (this.wanted !== number) return;
      const { width, height } = this.item;
      this.shown = { number, image: { width, height, counts } };
      this.draw();
    }).catch((error) => this.context.fail(error)).finally(end);
  }

  private draw(): void {
    this.axis.draw(this.frame());
    if (!this.shown) return;
    this.picture.show(this.shown.image);
  }

  follow(key: Key): void {
    if (this.picture.follow(key)) return;
    const frame = this.item.frames[this.frame()];
    if (key === 'frame' && frame) this.axis.reveal(frame.begin_us);
    if (key === 'frame' || key === 'tab') this.load();
    this.draw();
  }

  layout(): void {
    const { stage } = this.context;
    this.picture.layout(stage.clientWidth - 16, stage.clientHeight - axisPx - 32);
    setSize(this.axis.canvas, stage.clientWidth - 16, axisPx);
    this.draw();
  }

  press(key: string): boolean {
    switch (key) {
      case 'ArrowLeft': this.step(-1); return true;
      case 'ArrowRight': this.step(1); return true;
      case ' ': this.play(); return true;
      case '+': this.zoom(0.8); return true;
      case '-': this.zoom(1.25); return true;
      default: return this.picture.press(key);
    }
  }

  pictures(): { name: string; canvas: HTMLCanvasElement }[] {
    return [{ name: `frame-${this.frame()}`, canvas: this.picture.canvas }, { name: 'rate', canvas: this.axis.canvas }];
  }

  close(): void {
    clearInterval(this.timer);
  }
}
