// A served description that grows while a reconstruction goes on: the page asks for its version again and again, and for
// the description when that has changed.
import { fetchFile, type Source, type ViewDocument } from './document';

const periodMs = 300;

const rest = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, periodMs));

/** Takes over what is new. A reconstruction only ever adds items and cycles; a live page replaces what was frozen. */
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

/** Calls `onGrowth` after each change until nothing more will come. Fails where the server is gone. */
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
