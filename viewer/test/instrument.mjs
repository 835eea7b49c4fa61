// The page of `e2lf live`, while a recording plays at its own speed, again and again, so that it does not end before a slow test.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { readdirSync, readFileSync, rmSync, statSync } from 'node:fs';
import net from 'node:net';
import { assertNear, look, rowOf, settle, sizeOf, stateOf, withPage } from './browser.mjs';

const row = 20, numCycles = 40;

/** Serves the instrument; `check` gets its address, and what asks it. */
async function withInstrument(check, model = process.env.E2LF_MODEL) {
  rmSync('instrument', { recursive: true, force: true });
  const arguments_ = ['live', 'replay:long.raw?repeat=1000', '-m', model, '--size', 'full', '-o', 'instrument', '--json'];
  const program = spawn(process.env.E2LF, arguments_);
  let said = '';
  const address = await new Promise((resolve, reject) => {
    program.stdout.on('data', (data) => { said += data; if (said.includes('\n')) resolve(JSON.parse(said.slice(0, said.indexOf('\n'))).url); });
    program.on('exit', (code) => reject(new Error(`it ended with ${code}`)));
  });
  const ended = new Promise((resolve) => program.on('exit', resolve));
  const statistics = async () => (await fetch(`${address}statistics`)).json();
  try {
    await check(address, statistics);
  } finally {
    program.kill('SIGINT');
  }
  assert.equal(await ended, 130, 'Ctrl-C ends it');
  const { totals } = JSON.parse(said.trim().split('\n').at(-1));
  assert.equal(totals.fields + totals.skipped_cycles, totals.cycles, 'each cycle is shown or counted as skipped');
}

async function until(what, isSo) {
  for (const end = Date.now() + 120_000; !(await isSo());) {
    assert.ok(Date.now() < end, what);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

/** A row of a view of a cycle as `e2lf reconstruct` wrote it, in 8 bits. The cycle at each repetition counts, but is dropped. */
function rowOfReconstruct(cycle, viewRow, viewColumn) {
  const bytes = readFileSync(`long/cycle_${String(cycle % (numCycles + 1)).padStart(5, '0')}/lightfield.npy`);
  const begin = 10 + bytes.readUInt16LE(8);
  const [height, width] = /\(8, 8, (\d+), (\d+)\)/.exec(bytes.toString('latin1', 0, begin)).slice(1).map(Number);
  const first = ((viewRow * 8 + viewColumn) * height + row) * width;
  return Array.from({ length: width }, (_, x) => Math.round(255 * Math.min(Math.max(bytes.readFloatLE(begin + 4 * (first + x)), 0), 1)));
}

const tabNames = (page) => page.locator('#tabs button').allTextContents();
const chosenTab = (page) => page.locator('#tabs button[aria-selected=true]').textContent();

/** The values of a list of figures by their names. */
const figures = (page) => page.evaluate(() => Object.fromEntries([...document.querySelectorAll('dl dt')].map((name) => [name.textContent, name.nextSibling.textContent])));

export const tests = {
  'connections that never finish their requests neither hold the pictures nor the end': () => withInstrument(async (address, statistics) => {
    const { port } = new URL(address);
    await Promise.all(Array.from({ length: 100 }, () => new Promise((resolve) => {
      const socket = net.connect(port, '127.0.0.1', () => { socket.write('GET / HTTP/1.1\r\nHost: '); resolve(); });
      socket.on('error', () => {});
    })));
    const fields = async () => (await statistics()).fields;
    await until('a light field comes', async () => (await fields()) > 0);
    const before = await fields();
    await until('further ones come', async () => (await fields()) > before);
  }),

  'light fields at the pace of the cycles, and a frozen one is that of reconstruct': () => withInstrument((address, statistics) =>
    withPage(`${address}#tab=1`, {}, async (page) => {
      const shown = async () => Number(await page.evaluate(() => document.querySelector('.pane')?.dataset.cycle ?? -1));
      await until('a light field comes', async () => (await shown()) >= 0);
      // The picture of view (4, 4), and of another one when that is asked for: pixel for pixel, but for the rounding of
      // products of 16-bit integers.
      for (const [hash, viewRow, viewColumn] of [['tab=1&x=0.5&y=0.5', 4, 4], ['tab=1&x=-2.5&y=1.5', 5, 1]]) {
        await look(page, hash);
        await page.waitForTimeout(400);
        const [cycle, pixels] = await page.evaluate((y) => {
          const pane = document.querySelector('.pane'), canvas = pane.querySelector('canvas.picture');
          const { data } = canvas.getContext('2d').getImageData(0, y, canvas.width, 1);
          return [Number(pane.dataset.cycle), Array.from({ length: canvas.width }, (_, x) => data[4 * x])];
        }, row);
        assertNear(pixels, rowOfReconstruct(cycle, viewRow, viewColumn), 1, `cycle ${cycle}, view ${viewRow}, ${viewColumn}`);
      }
      const before = await shown();
      await until('more light fields come', async () => (await shown()) > before + 4);
      const rate = Number((await figures(page))['per second']);
      assert.ok(rate > 1 && rate < 20, `${rate} light fields per second, of 10.6 cycles`);
      await page.getByRole('button', { name: 'Freeze' }).click();
      await until('the frozen one has a tab', async () => (await page.locator('#tabs button').count()) === 3);
      await settle(page);
      const name = await page.locator('#tabs button[aria-selected=true]').textContent();
      const cycle = Number(/^cycle (\d+)$/.exec(name)[1]);
      await look(page, 'tab=2&x=0.5&y=0.5');
      assertNear(await rowOf(page, 'canvas.picture', row), rowOfReconstruct(cycle, 4, 4), 0, `frozen cycle ${cycle}`);
      await page.locator('#tabs button').nth(1).click();
      await page.getByRole('button', { name: 'Reconstruct this one well' }).click();
      await until('both have tabs', async () => (await page.locator('#tabs button').count()) === 5);
      await settle(page);
      assert.match(await page.locator('#tabs button[aria-selected=true]').textContent(), /^cycle \d+, reconstructed well and cycle \d+$/);
      assert.ok((await statistics()).fields > 5);
    })),

  'cycles are fused until the button or the key ends it, and the page shows how many each region rests on': () => withInstrument((address, statistics) =>
    withPage(`${address}#tab=1`, {}, async (page) => {
      const button = page.getByRole('button', { name: 'Fuse cycles' });
      const text = async () => page.locator('.advice', { hasText: /ycles/ }).first().textContent();
      const mean = async () => Number(/([\d.]+) on average/.exec(await text())?.[1] ?? 0);
      await until('regions rest on several cycles', async () => (await mean()) > 4);
      assert.deepEqual(await sizeOf(page, 'canvas.fused'), [16, 12]);
      assert.ok(Math.max(...await rowOf(page, 'canvas.fused', 6)) > 100, 'the map is bright where many cycles were fused');
      await until('the caption says it', async () => /fused with those before to [\d.]+ on average/.test(await page.locator('.pane').textContent()));
      await button.click();
      await until('it is off', async () => !(await statistics()).is_fusing && (await button.getAttribute('aria-pressed')) === 'false');
      await until('no map is shown', async () => !(await page.locator('canvas.fused').isVisible()));
      await page.keyboard.press('c');
      await until('it is on again', async () => (await statistics()).is_fusing);
      await until('it begins anew', async () => (await mean()) > 1);
    }), process.env.E2LF_MODEL.replace('e2lf-n4.', 'e2lf-n4-live.')),

  'a network that is not told the number of cycles fuses none, and the page says why': () => withInstrument((address) =>
    withPage(`${address}#tab=1`, {}, async (page) => {
      await until('it says why', async () => (await page.locator('.advice', { hasText: 'Cycles are not fused: e2lf-n4 is not conditioned' }).count()) === 1);
      assert.ok(await page.getByRole('button', { name: 'Fuse cycles' }).isDisabled());
    })),

  'a click focuses where it focuses in the frozen light field, and the controls show the settings of the server': () => withInstrument((address) =>
    withPage(`${address}#tab=1`, {}, async (page) => {
      await until('a light field comes', async () => (await page.locator('.pane[data-cycle]').count()) === 1);
      assert.equal(await page.locator('select[name=resolution]').inputValue(), 'full', '--size full');
      await page.locator('select[name=resolution]').selectOption('half');
      await withPage(`${address}#tab=1`, {}, (other) => until('another page shows it', async () => (await other.locator('select[name=resolution]').inputValue()) === 'half'));
      await page.locator('select[name=resolution]').selectOption('full');
      const focusByClick = async () => {
        const box = await page.locator('canvas.picture').first().boundingBox();
        await page.mouse.click(box.x + 0.55 * box.width, box.y + 0.55 * box.height);
        await until('it says where the focus is', async () => /^focus on x 35, y 26: /.test(await page.locator('#status').textContent()));
        await settle(page);
        return Number((await stateOf(page)).focus ?? 0);
      };
      await page.waitForTimeout(500); // light fields of half size have passed
      const live = await focusByClick();
      await page.getByRole('button', { name: 'Freeze' }).click();
      await until('it is frozen', async () => /^cycle/.test(await chosenTab(page)));
      await look(page, 'tab=2&focus=4');
      assertNear([live], [await focusByClick()], 0.3, 'focus');
      assert.notEqual(live, 0);
    })),

  'a page goes to what it froze, and what another page looks at stays': () => withInstrument((address) =>
    withPage(`${address}#tab=1`, {}, (first) => withPage(`${address}#tab=0`, {}, async (second) => {
      const freeze = async () => {
        const before = await tabNames(first);
        await until('it freezes', async () => {
          await first.locator('#tabs button').nth(1).click();
          // The page may move to what was frozen before, and the button with it.
          await first.getByRole('button', { name: 'Freeze' }).click({ timeout: 2000 }).catch(() => undefined);
          await first.waitForTimeout(500);
          return !before.includes(await chosenTab(first));
        });
        await settle(first);
        return chosenTab(first);
      };
      await until('a light field comes', async () => (await first.locator('.pane[data-cycle]').count()) === 1);
      const one = await freeze();
      await until('the other page has it', async () => (await tabNames(second)).length === 3);
      assert.equal(await chosenTab(second), 'Set up');
      await second.locator('#tabs button').nth(2).click();
      await settle(second);
      const seen = await rowOf(second, 'canvas.picture', row);
      const two = await freeze();
      await until('the other page has both', async () => (await tabNames(second)).length === 4);
      assert.deepEqual(await tabNames(second), ['Set up', 'Light field', two, one]);
      assert.equal(await chosenTab(second), one);
      assert.deepEqual(await rowOf(second, 'canvas.picture', row), seen);
      await second.locator('#tabs button').nth(2).click();
      await settle(second);
      assert.deepEqual(await tabNames(second), ['Set up', 'Light field', two]);
      assert.equal(await chosenTab(second), two);
    }))),

  'disparities are shown in colours and as a relief if the server sends them': () => withInstrument((address) => withPage(`${address}#tab=1`, {}, async (page) => {
    await page.route('**/statistics', async (route) => {
      const answer = await route.fetch();
      await route.fulfill({ response: answer, json: { ...(await answer.json()), has_depth: true } });
    });
    // A map of half the size: near on the left, far on the right, unknown at its top and uncertain below.
    const [width, height] = [32, 24];
    let serial = 0;
    await page.route('**/depth?*', (route) => {
      const header = Buffer.from(JSON.stringify({ serial: ++serial, width, height, range: [-1, 1], cycle: serial, cycles: 1, size: 'half', latency_s: 0.1 }));
      const length = Buffer.alloc(4);
      length.writeUInt32LE(header.length);
      const map = Buffer.alloc(2 * width * height), picture = Buffer.alloc(width * height, 128), confidence = Buffer.alloc(width * height, 255);
      confidence.fill(5, width, 2 * width);
      for (let i = 0; i < width * height; ++i) map.writeInt16LE(i < width ? -32768 : i % width < 16 ? -1000 : 1000, 2 * i);
      return route.fulfill({ body: Buffer.concat([length, header, map, confidence, picture]), contentType: 'application/octet-stream' });
    });
    await until('the choice is there', async () => page.locator('select[name=show]').isVisible());
    await page.locator('select[name=show]').selectOption('disparity');
    const colour = async (y) => Promise.all([0, 1, 2].map((channel) => rowOf(page, 'canvas.picture', y, channel)));
    await until('the map is shown', async () => (await sizeOf(page, 'canvas.picture'))[0] === width);
    const [red, green, blue] = await colour(12);
    assertNear([red[4], green[4], blue[4]], [253, 231, 37], 1, 'near is yellow');
    assertNear([red[28], green[28], blue[28]], [68, 1, 84], 1, 'far is violet');
    for (const y of [0, 1]) assertNear((await colour(y)).map((row) => row[4]), [128, 128, 128], 1, 'the picture where nothing is known');
    assert.deepEqual(await page.locator('.bar + .ends:visible span').allTextContents(), ['-1.00', '-0.50', '0.00', '0.50', '1.00']);
    await page.locator('select[name=show]').selectOption('relief');
    await until('a relief is shown', async () => (await sizeOf(page, 'canvas.picture'))[0] !== width);
    await page.unrouteAll({ behavior: 'ignoreErrors' });
  })),

  'the set-up: events, figures and recording': () => withInstrument((address, statistics) =>
    withPage(address, {}, async (page) => {
      await until('a picture of events comes', async () => (await page.locator('dl dt', { hasText: 'best so far' }).count()) === 1);
      assert.deepEqual(await sizeOf(page, '.live canvas.picture'), [64, 48]);
      const seen = new Set(); // a picture may lie within a pattern that makes events of one sign
      await until('ON and OFF events are seen', async () => {
        for (const y of [5, 20, 35]) for (const value of await rowOf(page, '.live canvas.picture', y)) seen.add(value);
        return Math.min(...seen) < 128 && Math.max(...seen) > 128;
      });
      await page.getByRole('button', { name: 'Record' }).click();
      await until('it records', async () => (await statistics()).recording.bytes > 10_000);
      await page.getByRole('button', { name: 'Stop recording' }).click();
      await until('it has stopped', async () => !(await statistics()).recording.is_recording);
      const { recording } = await statistics();
      assert.deepEqual(readdirSync('instrument').sort(), ['recording_000.raw', 'run.json']);
      assert.equal(statSync('instrument/recording_000.raw').size, recording.bytes);
      await until('cycles are counted', async () => Number((await figures(page)).complete) > 0);
      const shown = await figures(page);
      assert.ok(Number.parseFloat(shown['ON']) > 0 && Number(shown['now']) > 0, JSON.stringify(shown));
    })),

  'its server takes commands of its own page alone, and a browser that hangs disturbs nothing': () => withInstrument(async (address, statistics) => {
    const { pathname, port } = new URL(address);
    const tell = async (path, headers = {}, method = 'POST') => (await fetch(`http://127.0.0.1:${port}${path}`, { method, headers })).status;
    assert.equal(await tell(`${pathname}average?cycles=2`), 200);
    assert.equal((await statistics()).average, 2);
    assert.equal(await tell(`${pathname}average?cycles=1`, { Origin: 'http://evil.example' }), 403);
    assert.equal(await tell(`${pathname}average?cycles=1`, { 'Sec-Fetch-Site': 'cross-site' }), 403);
    assert.equal(await tell('/average?cycles=1'), 404);
    assert.equal(await tell(`/${'0'.repeat(32)}/average?cycles=1`), 404);
    assert.equal(await tell(`${pathname}average?cycles=1`, {}, 'GET'), 404);
    assert.equal(await tell(`${pathname}average?cycles=1`, {}, 'PUT'), 405);
    for (const path of ['nothing', 'document.json', '../../etc/passwd', 'record/x']) assert.equal(await tell(pathname + path), 404, path);
    assert.equal((await statistics()).average, 2);
    // Connections that ask for pictures and never read them.
    const sockets = Array.from({ length: 8 }, () => net.connect(port, '127.0.0.1', function ask() {
      this.pause();
      this.write(`GET ${pathname}picture HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n\r\n`.repeat(50));
    }));
    const before = (await statistics()).fields;
    await until('light fields go on', async () => (await statistics()).fields > before + 5);
    for (const socket of sockets) socket.destroy();
  }),
};
