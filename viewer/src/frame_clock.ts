// Paints when something has changed, once per frame of the screen. While something moves, pictures that take long are
// painted with fewer pixels; the full one follows when it rests.

import { busy } from './busy';

const wantedMs = 30;
const restMs = 160;

export class FrameClock {
  private isAsked = false;
  private timer = 0;
  private msPerUnit = 0; // of the last pictures; a unit is a pixel of one view
  private isFull = false; // the frame that is asked for shall have all its pixels
  private end: (() => void) | null = null;

  /** `paint` takes the share of pixels per axis to paint, 1 or less, and returns how many units that was. */
  constructor(private readonly paint: (scale: number) => number) {}

  /** `isMoving`: more will follow soon. */
  ask(isMoving: boolean, units: number): void {
    clearTimeout(this.timer);
    this.end ??= busy();
    this.isFull = !isMoving;
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => {
      this.isAsked = false;
      const scale = this.isFull ? 1 : this.scaleFor(units);
      const begin = performance.now();
      const painted = this.paint(scale);
      const rate = (performance.now() - begin) / Math.max(painted, 1);
      this.msPerUnit = this.msPerUnit === 0 ? rate : 0.7 * this.msPerUnit + 0.3 * rate;
      if (scale === 1) this.rest();
      // From now on, not from when it was asked for: a picture may take longer than that.
      else this.timer = window.setTimeout(() => this.ask(false, units), restMs);
    });
  }

  /** All pixels are there: nothing more is to come. */
  private rest(): void {
    clearTimeout(this.timer);
    this.end?.();
    this.end = null;
  }

  private scaleFor(units: number): number {
    for (const scale of [1, 0.5]) if (scale * scale * units * this.msPerUnit <= wantedMs) return scale;
    return 0.25;
  }
}
