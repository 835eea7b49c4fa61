// Paints after changes, at most once per frame of the screen. During motion, pictures that take long are painted with
// fewer pixels; the full resolution follows when the motion ends.

import { busy } from './busy';

const wantedMs = 30;
const restMs = 160;

export class FrameClock {
  private isAsked = false;
  private timer = 0;
  private msPerUnit = 0; // mean of the last pictures; a unit is a pixel of one view
  private isFull = false; // the requested frame must have the full resolution
  private end: (() => void) | null = null;

  /** `paint` receives the share of the pixels per axis to paint, 1 or less, and returns the number of units. */
  constructor(private readonly paint: (scale: number) => number) {}

  /** Requests a frame. `isMoving` states that more requests will follow soon. */
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
      // The time starts now rather than at the request, because a picture may take longer than that.
      else this.timer = window.setTimeout(() => this.ask(false, units), restMs);
    });
  }

  /** Ends the work, because the frame has the full resolution. */
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
