// The description that e2lf live serves, which changes. The page requests its version periodically, and the description
// itself after a change.
import { fetchFile, type Source, type ViewDocument } from './document';

const periodMs = 300;

const rest = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, periodMs));

/** Merges a new description: frozen light fields are added or replaced. */
function merge(target: ViewDocument, fresh: ViewDocument): void {
  target.items.length = Math.min(target.items.length, fresh.items.length);
  fresh.items.forEach((item, i) => {
    const known = target.items[i];
    if (known?.kind === 'light_field' && item.kind === 'light_field' && known.name === item.name) known.cycles = item.cycles;
    else if (known?.kind !== item.kind || known.name !== item.name) target.items[i] = item;
  });
  target.comparisons = fresh.comparisons;
  target.is_growing = fresh.is_growing;
}

/** Calls `onGrowth` after each change until the description is complete. Fails if the server has ended. */
export async function followGrowth({ document }: Source, onGrowth: () => void): Promise<void> {
  let version = '';
  while (document.is_growing) {
    const now = await (await fetchFile('version')).text();
    if (now !== version) {
      merge(document, JSON.parse(await (await fetchFile('document.json')).text()));
      version = now;
      onGrowth();
    }
    await rest();
  }
}
