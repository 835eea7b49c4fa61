// A recording as frames of accumulated events, with its event rate, triggers and cycles.
import { busy } from '../busy';
import { CountLegend, drawCounts, Histogram, limitText, mostLimit, type CountImage } from '../counts';
import { inflateCounts, type RecordingItem } from '../document';
import { canvas, clamp, element, placeOn } from '../dom';
import { fit, setSize, type Context, type Screen } from '../screen';
import type { Key } from '../state';
import { isDark } from '../theme';
import { TimeAxis } from '../time_axis';

const axisPx = 150;
const playMs = 80; // per frame

export class RecordingScreen implements Screen {
  readonly keys: [string, string][] = [
    ['left and right', 'the frame before and after'],
    ['space', 'play and stop'],
    ['+ and -', 'zoom in time, as the wheel and two fingers do on the time axis'],
    ['shift and wheel', 'along the time axis'],
    ['[ and ]', 'stronger and weaker colours'],
  ];
  private readonly picture: HTMLCanvasElement;
  private readonly axis: TimeAxis;
  private readonly histogram = new Histogram();
  private readonly legend = new CountLegend();
  private readonly playButton: HTMLElement;
  private shown: { number: number; image: CountImage } | null = null;
  private wanted = -1;
  private cursor: { x: number; y: number } | null = null;
  private timer = 0;

  constructor(
    private readonly context: Context,
    private readonly item: RecordingItem,
  ) {
    const { panel, state } = context;
    this.picture = canvas(`${item.name}: events of a stretch of time, ON red, OFF blue`, 'counts');
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
    panel.group('Picture', panel.slider('limit', 'Full colour at', { low: 0, high: mostLimit, step: 1, text: limitText }), this.legend.root);
    panel.group('Histogram under the cursor', this.histogram.root);
    context.stage.append(this.picture, this.axis.canvas);
    this.picture.addEventListener('pointerdown', (event) => this.point(event));
    this.picture.addEventListener('pointermove', (event) => this.point(event));
    // A lifted finger also leaves the element; the selected point is kept then.
    this.picture.addEventListener('pointerleave', (event) => event.pointerType === 'mouse' && this.point(null));
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
    this.legend.show(drawCounts(this.picture, this.shown.image, this.context.state.get('limit'), isDark()), isDark());
    this.histogram.show(this.shown.image, this.cursor);
  }

  private point(event: PointerEvent | null): void {
    if (!this.shown) return;
    const { width, height } = this.item;
    if (event) {
      const { x, y } = placeOn(this.picture, event);
      this.cursor = { x: clamp(Math.floor(x * width), 0, width - 1), y: clamp(Math.floor(y * height), 0, height - 1) };
    } else {
      this.cursor = null;
    }
    this.histogram.show(this.shown.image, this.cursor);
  }

  follow(key: Key): void {
    const frame = this.item.frames[this.frame()];
    if (key === 'frame' && frame) this.axis.reveal(frame.begin_us);
    if (key === 'frame' || key === 'tab') this.load();
    this.draw();
  }

  layout(): void {
    const { stage } = this.context;
    setSize(this.picture, ...fit(this.item.width, this.item.height, stage.clientWidth - 16, stage.clientHeight - axisPx - 32));
    setSize(this.axis.canvas, stage.clientWidth - 16, axisPx);
    this.draw();
  }

  press(key: string): boolean {
    const { state } = this.context;
    switch (key) {
      case 'ArrowLeft': this.step(-1); return true;
      case 'ArrowRight': this.step(1); return true;
      case ' ': this.play(); return true;
      case '+': this.zoom(0.8); return true;
      case '-': this.zoom(1.25); return true;
      case '[': state.set('limit', Math.max(state.get('limit') - 1, 0)); return true;
      case ']': state.set('limit', Math.min(state.get('limit') + 1, mostLimit)); return true;
      default: return false;
    }
  }

  pictures(): { name: string; canvas: HTMLCanvasElement }[] {
    return [{ name: `frame-${this.frame()}`, canvas: this.picture }, { name: 'rate', canvas: this.axis.canvas }];
  }

  close(): void {
    clearInterval(this.timer);
  }
}
