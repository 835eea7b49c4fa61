// A reconstruction that is going on: cycles come through a pipe while the page is open.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { readFileSync, rmSync } from 'node:fs';
import { assertNear, rowOf, settle, stateOf, withPage } from './browser.mjs';

const row = 20, numCycles = 6;

/** A row of view (4, 4) of a cycle as it lies in the output, in 8 bits. */
function rowOfOutput(cycle, y) {
  const bytes = readFileSync(`live/cycle_0000${cycle}/lightfield.npy`);
  const begin = 10 + bytes.readUInt16LE(8);
  const [height, width] = /\(8, 8, (\d+), (\d+)\)/.exec(bytes.toString('latin1', 0, begin)).slice(1).map(Number);
  const first = ((4 * 8 + 4) * height + y) * width;
  return Array.from({ length: width }, (_, x) => Math.round(255 * Math.min(Math.max(bytes.readFloatLE(begin + 4 * (first + x)), 0), 1)));
}

/** The cycle on the page and a row of it, where no other came in between. */
async function rowAndItsCycle(page) {
  for (;;) {
    const before = await shown(page);
    await settle(page);
    const pixels = await rowOf(page, 'canvas.picture', row);
    if ((await shown(page)) === before) return [Number(before.slice(-1)), pixels];
  }
}

const shown = (page) => page.locator('input[name=cycle] + output').textContent();

async function waitForCycle(page, least) {
  // The page's policy forbids waitForFunction().
  const newest = () => page.evaluate(() => Number(document.querySelector('input[name=cycle]')?.max ?? -1));
  for (const end = Date.now() + 120_000; (await newest()) < least;) assert.ok(Date.now() < end, `cycle ${least} comes`);
  await settle(page);
}

export const tests = {
  'each cycle is shown as it comes, with its latency': async () => {
    rmSync('live', { recursive: true, force: true });
    const arguments_ = ['reconstruct', '-', '--source', 'triggers', '-m', process.env.E2LF_MODEL, '-o', 'live', '--format', 'npy', '--view', '--quiet'];
    const program = spawn(process.env.E2LF, arguments_);
    const recording = readFileSync('six.raw');
    const middle = Math.floor(recording.length / 2);
    program.stdin.write(recording.subarray(0, middle)); // a pipe without a byte has no format
    let said = '';
    const address = await new Promise((resolve, reject) => {
      program.stderr.on('data', (data) => {
        said += data;
        const found = /http:\S+/.exec(said);
        if (found) resolve(found[0]);
      });
      program.on('exit', (code) => reject(new Error(`it ended with ${code}: ${said}`)));
    });
    const ended = new Promise((resolve) => program.on('exit', resolve));
    const ask = async (path) => (await fetch(address + path)).text();
    await withPage(`${address}#x=0.5&y=0.5`, {}, async (page) => {
      await waitForCycle(page, 0);
      const [first, pixels] = await rowAndItsCycle(page);
      assert.ok(first < numCycles - 1, `half of the recording has ${first + 1} cycles`);
      assert.match(await page.locator('fieldset .figures').first().textContent(), /^latency \d+\.\d{3} s$/);
      assertNear(pixels, rowOfOutput(first, row), 0, `cycle ${first}`);
      program.stdin.end(recording.subarray(middle));
      await waitForCycle(page, numCycles - 1);
      assert.equal(await shown(page), `cycle 0000${numCycles - 1}`);
      assertNear(await rowOf(page, 'canvas.picture', row), rowOfOutput(numCycles - 1, row), 0, 'the newest');
      await page.locator('input[name=cycle]').fill('0');
      await settle(page);
      assertNear(await rowOf(page, 'canvas.picture', row), rowOfOutput(0, row), 0, 'an earlier one');
      assert.equal((await stateOf(page)).newest, 'stay');
      assert.equal(JSON.parse(await ask('document.json')).is_growing, undefined, 'nothing more will come');
    });
    program.kill('SIGINT');
    assert.equal(await ended, 130, 'Ctrl-C ends it');
  },
};
