// The interface of a screen, and the context that it receives.
import type { Panel } from './dom';
import type { ViewDocument, Source } from './document';
import type { Painter } from './painter';
import type { Key, State } from './state';

export interface Context {
  document: ViewDocument;
  source: Source;
  state: State;
  painter: Painter;
  stage: HTMLElement;
  panel: Panel;
  /** Shows a line at the foot of the page. */
  say(text: string): void;
  /** Goes to the tab of the item with this name, as soon as there is one. */
  goTo(name: string): void;
  /** Shows an error in place of the screen. */
  fail(error: unknown): void;
}

export interface Screen {
  /** Called after a change of the state: of `key`, or of anything if it is `tab`. */
  follow(key: Key): void;
  /** Called after a change of the size of the stage. */
  layout(): void;
  /** Handles a key. Returns true if the screen uses it. */
  press(key: string): boolean;
  /** Returns the pictures for a screenshot, with the names of their files. */
  pictures(): { name: string; canvas: HTMLCanvasElement }[];
  /** The keys that the screen handles, for the help. */
  keys: [keys: string, does: string][];
  /** Parts of the description are still being fetched. */
  isLoading?(): boolean;
  close(): void;
}

/** Focuses on a point (px) of a picture. */
export function focusOn({ state, say }: Context, x: number, y: number, disparity: number): void {
  state.set('tiltx', 0);
  state.set('tilty', 0);
  state.set('focus', disparity);
  say(`focus on x ${Math.floor(x)}, y ${Math.floor(y)}: disparity ${disparity.toFixed(2)} px per view`);
}

/** The largest size that keeps the proportions of a picture in a box; small pictures grow to four times their size. */
export function fit(width: number, height: number, boxWidth: number, boxHeight: number): [number, number] {
  const scale = Math.max(Math.min(boxWidth / width, boxHeight / height, 4), 16 / Math.max(width, height));
  return [Math.floor(width * scale), Math.floor(height * scale)];
}

export function setSize(target: HTMLElement, width: number, height: number): void {
  target.style.width = `${width}px`;
  target.style.height = `${height}px`;
}
