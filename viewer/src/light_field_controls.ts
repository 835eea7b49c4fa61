// The controls of one or two light fields.
import { shapes } from './aperture';
import type { ApertureMap } from './aperture_map';
import { paths, videoEndings } from './animation';
import { sequential } from './colour_map';
import type { QualityFigures } from './comparison';
import type { DisparityMap } from './disparity_map';
import type { LightFieldItem } from './document';
import { element } from './dom';
import { colourBar, DisparityLegend, sureSlider } from './legend';
import { maxDisparity } from './light_field';
import type { Context } from './screen';

const signed = (value: number) => (value > 0 ? '+' : '') + value.toFixed(2);
const percent = (value: number) => `${Math.round(100 * value)} %`;

export interface Controlled {
  item: LightFieldItem;
  map: ApertureMap;
  quality: QualityFigures | null; // if there are two
  disparity: DisparityMap | null; // of the first one that has a map
  record(ending: string): void; // a film, as `webm`, `mp4` or `gif`
  saveRelief(): void;
}

export class LightFieldControls {
  private readonly note = element('p', { class: 'figures', 'aria-live': 'polite' });
  private swipe: HTMLElement | null = null;
  private boost: HTMLElement | null = null;
  private ofRelief: HTMLElement | null = null;
  private overlay: HTMLElement | null = null;
  private cycle: HTMLElement | null = null;

  constructor(private readonly context: Context, private readonly of: Controlled) {
    const { panel, state } = context;
    const [rows, columns] = of.item.views;
    const isSingleView = rows * columns === 1;
    if (of.quality) this.addComparison(of.quality);
    this.addTime();
    this.addPicture(isSingleView);
    if (!isSingleView) this.addView();
    panel.group('Brightness',
      panel.slider('gain', 'Gain', { low: 0.1, high: 8, step: 0.05 }),
      panel.slider('gamma', 'Gamma', { low: 0.4, high: 3, step: 0.05 }));
    if (!isSingleView) this.addFilm();
    panel.root.append(panel.button('Reset', () => state.reset()));
  }

  /** Shows the note of a cycle. */
  showNote(cycle: number): void {
    this.note.textContent = this.of.item.cycles[Math.round(cycle)]?.note ?? '';
  }

  /** Hides the controls without an effect on what is shown. */
  layout(shown: string, compared: string): void {
    const parts: [HTMLElement | null, boolean][] = [[this.swipe, compared === 'swipe'], [this.boost, compared === 'difference'],
      [this.ofRelief, shown === 'relief'], [this.overlay, shown !== 'disparity']];
    for (const [part, isUsed] of parts) if (part) part.hidden = !isUsed;
  }

  private addComparison(quality: QualityFigures): void {
    const { panel } = this.context;
    this.swipe = panel.slider('split', 'Swipe', { low: 0, high: 1, step: 0.005, text: percent });
    this.boost = panel.slider('boost', 'Differences times', { low: 1, high: 20, step: 0.5, text: (value) => value.toFixed(1) });
    panel.group('Compare',
      panel.choice('compare', 'Show', { side: 'side by side', swipe: 'swipe', difference: 'difference', first: 'the first', second: 'the second' }),
      this.swipe, this.boost,
      panel.choice('tone', 'Brightness', { stored: 'as stored', best: 'most similar' }), quality.root);
  }

  private addTime(): void {
    const { panel } = this.context;
    const { item } = this.of;
    if (item.cycles.length < 2) return;
    const label = (cycle: number) => item.cycles[cycle]?.label ?? '';
    this.cycle = panel.slider('cycle', 'Cycle', { low: 0, high: item.cycles.length - 1, step: 1, text: label });
    panel.group('Time', this.cycle, this.note);
  }

  private addPicture(isSingleView: boolean): void {
    const { panel } = this.context;
    const { disparity, quality } = this.of;
    const ways = { picture: 'picture', ...(disparity && { disparity: 'disparity', relief: 'relief' }), ...(!quality && !isSingleView && { grid: 'all views' }) };
    const parts = disparity ? this.partsOf(disparity) : [];
    if (Object.keys(ways).length > 1) panel.group('Picture', panel.choice('show', 'Show', ways), ...parts);
  }

  private partsOf(disparity: DisparityMap): HTMLElement[] {
    const { panel } = this.context;
    this.ofRelief = element('div', {}, panel.slider('depth', 'Depth of the relief', { low: 0, high: 1.5, step: 0.05 }),
      panel.button('Save GLB', () => this.of.saveRelief()));
    this.overlay = panel.slider('overlay', 'Colours of disparity', { low: 0, high: 1, step: 0.05, text: percent });
    const legend = new DisparityLegend();
    legend.show(disparity.range);
    return [this.overlay, ...(disparity.hasConfidence ? [sureSlider(panel)] : []), this.ofRelief, legend.root];
  }

  private addView(): void {
    const { panel } = this.context;
    const { item, map, quality } = this.of;
    const [rows, columns] = item.views;
    const psnrBar = quality ? [colourBar('Colours of PSNR', sequential, quality.worst, quality.best)] : [];
    panel.group('Viewpoint', map.canvas, ...psnrBar,
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

  private addFilm(): void {
    const { panel } = this.context;
    const names: Record<string, string> = { webm: 'WebM', mp4: 'MP4', gif: 'GIF' };
    const buttons = [...videoEndings(), 'gif'].map((ending) => panel.button(`Save ${names[ending]}`, () => this.of.record(ending)));
    panel.group('Film', panel.choice('path', 'Path', paths), ...buttons);
  }
}
