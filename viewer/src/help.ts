// A dialog that lists the keys.
import { element } from './dom';

const everywhere: [string, string][] = [
  ['1 to 9', 'what to look at'],
  ['s', 'save the picture'],
  ['t', 'dark or light'],
  ['?', 'this help'],
];

export function showHelp(keys: [string, string][]): void {
  const rows = [...keys, ...everywhere].map(([key, does]) => element('tr', {}, element('th', { scope: 'row' }, key), element('td', {}, does)));
  const close = element('button', { type: 'button' }, 'Close');
  const dialog = element('dialog', { 'aria-label': 'Keys' }, element('h2', {}, 'Keys'), element('table', {}, element('tbody', {}, ...rows)),
    element('p', {}, 'On a light field: drag to move the viewpoint, turn the wheel or spread two fingers to zoom, turn the wheel with shift to focus, press on a point to focus on it. The address of the page contains the current view.'), close);
  close.addEventListener('click', () => dialog.close());
  dialog.addEventListener('close', () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}
