// The figures of a reconstruction beside the truth, as `e2lf eval` computes them.
import type { Comparison, Quality } from './document';
import { element, FigureList } from './dom';

const decibels = (values: (number | null)[]): string => {
  const known = values.filter((value): value is number => value !== null);
  if (known.length < values.length) return `${values.length - known.length} of ${values.length} views are equal`;
  return `${(known.reduce((sum, value) => sum + value, 0) / known.length).toFixed(2)} dB`;
};

export class QualityFigures {
  readonly root: HTMLElement;
  readonly worst = element('span');
  readonly best = element('span');
  private readonly list = new FigureList();
  private readonly about = element('p', { class: 'figures' });

  constructor(private readonly comparison: Comparison) {
    this.root = element('div', { class: 'quality' }, this.list.root, this.about);
  }

  of(cycle: number): Quality | undefined {
    return this.comparison.cycles[Math.round(cycle)];
  }

  /** Returns the PSNR of each view of what is shown. */
  psnr(cycle: number, isToned: boolean): (number | null)[] | undefined {
    const quality = this.of(cycle);
    return isToned ? quality?.toned_psnr_db : quality?.psnr_db;
  }

  show(cycle: number, isToned: boolean): void {
    const quality = this.of(cycle);
    this.root.hidden = !quality;
    if (!quality) return;
    const { psnr_db, tone: [gain, black], toned_psnr_db, disparity } = quality;
    const rows: [string, string][] = [
      ['PSNR, mean of views', decibels(psnr_db)],
      ['with best brightness', decibels(toned_psnr_db)],
      ['(gain, black level)', `${gain.toFixed(3)}, ${black.toFixed(3)}`],
    ];
    if (disparity) {
      rows.push(['disparity > 0.07 px off', `${disparity.bad_07_percent.toFixed(1)} %`], ['disparity > 0.2 px off', `${disparity.bad_20_percent.toFixed(1)} %`],
        ['disparity, mean error', `${disparity.mean_absolute_px.toFixed(3)} px`], ['disparity, slope', disparity.slope.toFixed(2)]);
    }
    this.list.show(rows);
    this.about.textContent = disparity ? `Disparities that e2lf depth finds in the reconstruction, against ${disparity.source}` : '';
    const shown = isToned ? toned_psnr_db : psnr_db;
    const known = shown.filter((value): value is number => value !== null);
    this.worst.textContent = known.length > 0 ? `${Math.min(...known).toFixed(2)} dB` : '';
    this.best.textContent = known.length > 0 ? `${Math.max(...known).toFixed(2)} dB${known.length < shown.length ? ', equal' : ''}` : 'equal';
  }
}
