// Runs the browser tests in the current folder, which holds what inputs.py made and the pages made of it; E2LF is the
// binary. Arguments choose tests by words of their names.
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { startBrowser, stopBrowser } from './browser.mjs';

const expected = JSON.parse(readFileSync('expected.json', 'utf8'));
const url = (name, hash) => `${pathToFileURL(resolve(name))}#${hash}`;
const wanted = process.argv.slice(2);
let failed = 0;

await startBrowser();
for (const file of ['light_field', 'disparity', 'film', 'compare', 'events', 'page', 'server', 'instrument']) {
  const { tests } = await import(`./${file}.mjs`);
  for (const [name, test] of Object.entries(tests)) {
    if (wanted.length > 0 && !wanted.some((word) => `${file} ${name}`.includes(word))) continue;
    const begin = Date.now();
    try {
      await test({ url, expected });
      console.log(`ok      ${file}: ${name} (${((Date.now() - begin) / 1000).toFixed(1)} s)`);
    } catch (error) {
      ++failed;
      console.log(`FAILED  ${file}: ${name}: ${error.stack}`);
    }
  }
}
await stopBrowser();
process.exit(failed === 0 ? 0 : 1);
