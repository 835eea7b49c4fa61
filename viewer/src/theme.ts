// The dark or light theme, which follows the system unless it is chosen.
import type { State } from './state';

export const themes = ['system', 'dark', 'light'];

export function applyTheme(state: State): void {
  const theme = state.get('theme');
  document.documentElement.dataset['theme'] = themes.includes(theme) ? theme : 'system';
}

/** Returns the colour of the ground of the page, in 0..1. */
export function groundColour(): number[] {
  return getComputedStyle(document.body).backgroundColor.match(/\d+/g)!.slice(0, 3).map((value) => Number(value) / 255);
}

/** Returns true if the page is dark. */
export function isDark(): boolean {
  const theme = document.documentElement.dataset['theme'];
  return theme === 'dark' || (theme !== 'light' && matchMedia('(prefers-color-scheme: dark)').matches);
}
