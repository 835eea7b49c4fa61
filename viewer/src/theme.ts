// The dark or light theme, which follows the system unless it is chosen.
import type { State } from './state';

export const themes = ['system', 'dark', 'light'];

export function applyTheme(state: State): void {
  const theme = state.get('theme');
  document.documentElement.dataset['theme'] = themes.includes(theme) ? theme : 'system';
}

/** Returns true if the page is dark. */
export function isDark(): boolean {
  const theme = document.documentElement.dataset['theme'];
  return theme === 'dark' || (theme !== 'light' && matchMedia('(prefers-color-scheme: dark)').matches);
}
