// One light field or two light fields side by side: parallax, focus, synthetic aperture, EPIs, all views, disparity and
// relief, gain and gamma.
import { ApertureMap } from '../aperture_map';
import { numFrames, placeOnPath, recordGif, recordVideo, type Place } from '../animation';
import { busy } from '../busy';
import { QualityFigures } from '../comparison';
import type { Comparison, LightFieldItem } from '../document';
import { FrameClock } from '../frame_clock';
import { middleOf } from '../light_field';
import { LightFieldControls } from '../light_field_controls';
import { LightFieldPanes } from '../light_field_panes';
import { pressReliefKey } from '../relief';
import type { Context, Screen } from '../screen';
import { saveBlob } from '../screenshot';
import type { Key } from '../state';
import { pressViewKey, viewKeys } from '../view_keys';
import { keysOfPart, zoomKeys } from '../zoom';

const keysWhileMoving: Key[] = ['x', 'y', 'focus', 'tiltx', 'tilty', 'size', 'split', 'gain', 'gamma', 'boost', 'overlay', 'sure', 'turn', 'tip', 'depth'];

export class LightFieldScreen implements Screen {
  readonly keys: [string, string][] = [
    ...viewKeys,
    ...zoomKeys,
    ['g', 'all views'],
    ['< and >', 'the cycle before and after'],
  ];
  private readonly panes: LightFieldPanes;
  private readonly controls: LightFieldControls;
  private readonly map: ApertureMap;
  private readonly quality: QualityFigures | null;
  private readonly clock = new FrameClock((scale) => this.paint(scale));
  private readonly epiClock = new FrameClock(() => this.paint(0));
  private numLoading = 0;
  private isRecording = false;
  private isClosed = false;

  constructor(
    private readonly context: Context,
    private readonly item: LightFieldItem,
    comparison?: { item: LightFieldItem; figures: Comparison },
  ) {
    const { state } = context;
    this.quality = comparison ? new QualityFigures(comparison.figures) : null;
    this.panes = new LightFieldPanes(context, item, comparison?.item, this.quality);
    this.map = new ApertureMap(state, item.views, context.say);
    state.start({ x: middleOf(item.views[1]), y: middleOf(item.views[0]), overlay: comparison ? 0 : this.panes.isSingleView ? 1 : 0.5 });
    const { map, quality, panes: { disparity } } = this;
    this.controls = new LightFieldControls(context, { item, map, quality, disparity, record: (ending) => this.record(ending), saveRelief: () => this.saveRelief() });
    this.load();
  }

  isLoading(): boolean {
    return this.numLoading > 0;
  }

  private load(): void {
    const { context } = this;
    const cycle = context.state.get('cycle');
    this.controls.showNote(cycle);
    for (const { map, views } of this.panes.all) {
      if (!map) continue;
      const end = busy();
      map.load(cycle, views.item.disparity!, context.source).then(() => this.repaint(false)).catch((error) => context.fail(error)).finally(end);
    }
    for (const { views } of this.panes.all) {
      const end = busy();
      ++this.numLoading;
      views.load(cycle, (share) => {
        if (this.isClosed) return;
        context.say(share < 1 ? `loading views, ${Math.round(100 * share)} %` : '');
        this.repaint(false);
      }).catch((error) => context.fail(error)).finally(() => {
        --this.numLoading;
        end();
      });
    }
  }

  follow(key: Key): void {
    if (key === 'cycle' || key === 'tab') this.load();
    if (key === 'show' || key === 'compare' || key === 'tab') this.layout();
    if (this.isRecording) return; // the recording paints its frames itself
    const isPoint = key === 'row' || key === 'column';
    const isWhole = this.panes.shown() !== 'relief' && this.panes.compared() !== 'swipe'; // the page moves what was painted
    if (isPoint || (keysOfPart.includes(key) && isWhole)) this.epiClock.ask(false, 1);
    else this.repaint(keysWhileMoving.includes(key));
    if (isPoint) this.context.say(this.panes.pointed());
  }

  layout(): void {
    this.panes.layout();
    this.controls.layout(this.panes.shown(), this.panes.compared());
    this.repaint(false);
  }

  private repaint(isMoving: boolean): void {
    this.clock.ask(isMoving, this.panes.units());
  }

  /** Paints at a scale; 0 = only the EPIs. Returns the number of pixels of views that were read. */
  private paint(scale: number): number {
    if (this.isClosed) return 1;
    try {
      const pixels = this.panes.paint(scale);
      this.showFigures();
      return pixels;
    } catch (error) {
      this.context.fail(error);
      return 1;
    }
  }

  private showFigures(): void {
    const cycle = this.context.state.get('cycle');
    const isToned = this.panes.isToned();
    this.map.showPsnr(this.quality?.psnr(cycle, isToned));
    this.quality?.show(cycle, isToned);
    this.map.draw(this.panes.camera.weights);
  }

  /** Goes along the path once, records the first picture and saves the film; then all is as before. */
  private async record(ending: string): Promise<void> {
    if (this.isRecording || this.panes.shown() === 'grid') return;
    const { state, say } = this.context;
    const now: Place = { x: state.get('x'), y: state.get('y'), focus: state.get('focus') };
    const go = ({ x, y, focus }: Place) => {
      state.set('x', x);
      state.set('y', y);
      state.set('focus', focus);
    };
    const range: [number, number] = this.panes.disparity?.range ?? [-2, 2];
    const end = busy();
    this.isRecording = true;
    const { picture } = this.panes.all[0]!.pane;
    const paint = (i: number) => {
      if (this.isClosed) throw new Error('The film ended with what it showed.');
      go(placeOnPath(state.get('path'), i, this.item.views, now, range));
      this.paint(1);
      say(`recording, ${Math.round((100 * i) / numFrames)} %`);
    };
    try {
      const film = await (ending === 'gif' ? recordGif(picture, paint) : recordVideo(ending, picture, paint));
      saveBlob(this.item.name, `${state.get('path')}.${ending}`, film);
      say(`film saved, ${(film.size / 1e6).toFixed(1)} MB`);
    } catch (error) {
      say(error instanceof Error ? error.message : String(error));
    } finally {
      this.isRecording = false;
      end();
      if (!this.isClosed) go(now);
    }
    this.repaint(false);
  }

  private saveRelief(): void {
    const end = busy();
    this.panes.glb().then((file) => {
      saveBlob(this.item.name, 'relief.glb', file);
      this.context.say(`relief saved, ${(file.size / 1e6).toFixed(1)} MB`);
    }).catch((error) => this.context.fail(error)).finally(end);
  }

  press(key: string): boolean {
    const { state } = this.context;
    if (this.panes.all[0]!.pane.zoom.press(key) || (this.panes.shown() === 'relief' && pressReliefKey(state, key))) return true;
    if (pressViewKey(state, this.item, key)) return true;
    switch (key) {
      case 'g': state.set('show', state.get('show') === 'grid' ? 'picture' : 'grid'); return true;
      case '<': state.set('cycle', Math.max(state.get('cycle') - 1, 0)); return true;
      case '>': state.set('cycle', Math.min(state.get('cycle') + 1, this.item.cycles.length - 1)); return true;
      default: return false;
    }
  }

  pictures(): { name: string; canvas: HTMLCanvasElement }[] {
    return this.panes.pictures();
  }

  close(): void {
    this.isClosed = true;
    this.panes.close();
  }
}
