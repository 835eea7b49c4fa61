// The keys that change the viewpoint and the focus of a light field.
import { nearestViewpoint } from './aperture';
import { maxDisparity } from './light_field';
import type { PaneSize } from './pane';
import type { State } from './state';

export const viewKeys: [keys: string, does: string][] = [
  ['arrows', 'move the viewpoint'],
  ['+ and -', 'focus nearer and farther'],
  ['a and A', 'smaller and larger aperture'],
  ['0', 'everything as at the start'],
];

/** Handles a key. Returns true if it is one of them. */
export function pressViewKey(state: State, { views: [rows, columns], disparity }: PaneSize, key: string): boolean {
  const move = (name: 'x' | 'y', by: number, count: number) =>
    state.set(name, nearestViewpoint(state.get(name) + by, count, state.get('size'), disparity !== undefined));
  switch (key) {
    case 'ArrowLeft': move('x', -0.5, columns); return true;
    case 'ArrowRight': move('x', 0.5, columns); return true;
    case 'ArrowUp': move('y', -0.5, rows); return true;
    case 'ArrowDown': move('y', 0.5, rows); return true;
    case '+': state.set('focus', Math.min(state.get('focus') + 0.05, maxDisparity)); return true;
    case '-': state.set('focus', Math.max(state.get('focus') - 0.05, -maxDisparity)); return true;
    case 'a': state.set('size', Math.max(state.get('size') - 0.5, 0)); return true;
    case 'A': state.set('size', Math.min(state.get('size') + 0.5, Math.hypot(rows, columns) / 2)); return true;
    case '0': state.reset(); return true;
    default: return false;
  }
}
