// The event images of a cycle: one in full size, and below it thumbnails of all with the patterns before and after.
import { busy } from '../busy';
import { countKeys, CountPicture } from '../count_picture';
import { drawCounts, type CountImage } from '../counts';
import { inflateCounts, type EventImagesItem } from '../document';
import { canvas, clamp, element } from '../dom';
import { patternFigure } from '../patterns';
import { fit, setSize, type Context, type Screen } from '../screen';
import type { Key } from '../state';
import { isDark } from '../theme';

export class EventsScreen implements Screen {
  readonly keys: [string, string][] = [
    ['left and right', 'the transition before and after'],
    ['< and >', 'the cycle before and after'],
    ...countKeys,
  ];
  private readonly large: CountPicture;
  private readonly thumbnails: HTMLCanvasElement[] = [];
  private readonly strip = element('div', { class: 'strip' });
  private counts: Int16Array | null = null;
  private loaded = -1;

  constructor(
    private readonly context: Context,
    private readonly item: EventImagesItem,
  ) {
    this.large = new CountPicture(context, `${item.name}: event image, ON red, OFF blue`, item);
    this.addControls();
    for (let i = 0; i < item.transitions; ++i) this.addThumbnail(i);
    context.stage.append(element('div', { class: 'events' }, this.large.root, this.strip));
    this.load();
  }

  private addThumbnail(number: number): void {
    const { state } = this.context;
    const thumbnail = canvas(`transition ${number + 1}`, 'counts');
    const button = element('button', { type: 'button', class: 'thumbnail', 'aria-label': `Show transition ${number + 1}` }, thumbnail);
    button.addEventListener('click', () => state.set('image', number));
    this.thumbnails.push(thumbnail);
    const codes = this.item.codes;
    const before = codes ? [patternFigure(codes, number, 56)] : [];
    const after = codes ? [patternFigure(codes, number + 1, 56)] : [];
    this.strip.append(element('div', { class: 'transition' }, ...before, button, ...after));
  }

  private addControls(): void {
    const { panel } = this.context;
    const { cycles, transitions } = this.item;
    panel.group('Event image',
      panel.slider('image', 'Transition', { low: 0, high: transitions - 1, step: 1, text: (value) => `${value + 1} of ${transitions}` }),
      ...this.large.controls);
    if (cycles.length > 1) {
      panel.group('Time', panel.slider('cycle', 'Cycle', { low: 0, high: cycles.length - 1, step: 1, text: (value) => cycles[value]?.label ?? '' }));
    }
    this.large.addHistogram();
  }

  private load(): void {
    const cycle = clamp(Math.round(this.context.state.get('cycle')), 0, this.item.cycles.length - 1);
    if (cycle === this.loaded) return;
    this.loaded = cycle;
    const end = busy();
    this.context.source.part(this.item.cycles[cycle]!.counts).then(inflateCounts).then((counts) => {
      if (this.loaded !== cycle) return;
      this.counts = counts;
      this.draw();
    }).catch((error) => this.context.fail(error)).finally(end);
  }

  private image(number: number): CountImage {
    const { width, height } = this.item;
    return { width, height, counts: this.counts!.subarray(number * width * height, (number + 1) * width * height) };
  }

  private chosen(): number {
    return clamp(Math.round(this.context.state.get('image')), 0, this.item.transitions - 1);
  }

  private draw(): void {
    if (!this.counts) return;
    const limit = this.context.state.get('limit');
    this.thumbnails.forEach((target, i) => {
      drawCounts(target, this.image(i), limit, isDark());
      target.parentElement!.setAttribute('aria-pressed', String(i === this.chosen()));
    });
    this.large.show(this.image(this.chosen()));
  }

  follow(key: Key): void {
    if (this.large.follow(key)) return;
    if (key === 'cycle' || key === 'tab') this.load();
    if (key === 'image' || key === 'tab') this.thumbnails[this.chosen()]!.scrollIntoView({ block: 'nearest', inline: 'nearest' });
    this.draw();
  }

  layout(): void {
    const { stage } = this.context;
    const { width, height, transitions } = this.item;
    const stripHeight = clamp(stage.clientHeight * 0.25, 90, 180);
    const patterns = this.item.codes ? 2 * 66 : 0;
    this.large.layout(stage.clientWidth - 16, stage.clientHeight - stripHeight - 32);
    const size = fit(width, height, Math.max(stage.clientWidth / transitions - patterns - 24, 60), stripHeight - 12);
    for (const thumbnail of this.thumbnails) setSize(thumbnail, ...size);
  }

  press(key: string): boolean {
    const { state } = this.context;
    switch (key) {
      case 'ArrowLeft': state.set('image', Math.max(this.chosen() - 1, 0)); return true;
      case 'ArrowRight': state.set('image', Math.min(this.chosen() + 1, this.item.transitions - 1)); return true;
      case '<': state.set('cycle', Math.max(state.get('cycle') - 1, 0)); return true;
      case '>': state.set('cycle', Math.min(state.get('cycle') + 1, this.item.cycles.length - 1)); return true;
      default: return this.large.press(key);
    }
  }

  pictures(): { name: string; canvas: HTMLCanvasElement }[] {
    return [{ name: `transition-${this.chosen() + 1}`, canvas: this.large.canvas }];
  }

  close(): void {}
}
