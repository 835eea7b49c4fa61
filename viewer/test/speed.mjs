// What the page needs with software rendering: node viewer/test/speed.mjs PAGE.html, where the page begins with a light
// field. Says for the whole browser: seconds until all views are there, memory at rest, and, while something moves at
// every frame of the screen, pictures per second, their mean width, and the processor's time for each. The last one says
// what a machine that does nothing else can do.
import { readFileSync } from 'node:fs';
import { cpus, loadavg } from 'node:os';
import { pathToFileURL } from 'node:url';
import { resolve } from 'node:path';
import { processes, settle, startBrowser, stopBrowser, withPage } from './browser.mjs';

const seconds = Number(process.env.SECONDS_EACH ?? 5);

/** Processor's time of all processes of the browser, s. */
const cpuTime = async () => (await processes()).reduce((sum, { cpuTime: time }) => sum + time, 0);

/** Memory of the processes of a kind that is theirs alone or their share of it, MB. */
async function megabytes(kind) {
  const pss = ({ id }) => Number(/^Pss:\s+(\d+)/m.exec(readFileSync(`/proc/${id}/smaps_rollup`, 'utf8'))[1]) / 1024;
  const wanted = (await processes()).filter(({ type }) => type.toLowerCase() === kind);
  return wanted.reduce((sum, process) => sum + pss(process), 0).toFixed(0);
}

/** Moves what `move` says at every frame of the screen. */
async function measure(page, move) {
  const before = await cpuTime();
  const { frames, length, width } = await page.evaluate(async ([what, limit]) => {
    const picture = document.querySelector('canvas.picture');
    const input = document.querySelector(`input[name=${what}]`);
    const box = picture.getBoundingClientRect();
    const point = (type, share) => picture.dispatchEvent(new PointerEvent(type,
      { pointerId: 1, button: 0, clientX: box.left + share * box.width, clientY: box.top + box.height / 2 }));
    picture.setPointerCapture = () => {};
    if (!input) point('pointerdown', 0.5);
    const frame = () => new Promise((done) => requestAnimationFrame(done));
    const begin = performance.now();
    let frames = 0, width = 0;
    while (performance.now() - begin < 1000 * limit) {
      const share = 0.5 + 0.4 * Math.sin(frames / 7);
      if (!input) point('pointermove', share);
      else {
        input.value = String(Number(input.min) + (Number(input.max) - Number(input.min)) * share);
        input.dispatchEvent(new Event('input'));
      }
      await frame(); // the picture is painted at the beginning of this one
      ++frames;
      width += picture.width;
    }
    if (!input) point('pointerup', 0.5);
    return { frames, length: (performance.now() - begin) / 1000, width: width / frames };
  }, [move, seconds]);
  const cpu = (await cpuTime()) - before;
  return { perSecond: frames / length, width, cpuMs: (1000 * cpu) / frames };
}

await startBrowser();
const begin = Date.now();
await withPage(String(pathToFileURL(resolve(process.argv[2]))), {}, async (page) => {
  console.log(`${cpus().length} cores, load ${loadavg()[0].toFixed(1)}`);
  console.log(`open: ${((Date.now() - begin) / 1000).toFixed(1)} s`);
  const devtools = await page.context().newCDPSession(page);
  await devtools.send('HeapProfiler.collectGarbage');
  const { usedSize } = await devtools.send('Runtime.getHeapUsage');
  console.log(`memory: scripts ${(usedSize / 2 ** 20).toFixed(0)} MiB, page ${await megabytes('renderer')} MiB, graphics ${await megabytes('gpu')} MiB`);
  for (const [what, move, size] of [['drag, one view', 'drag', 0], ['focus, radius 1.5', 'focus', 1.5], ['focus, all views', 'focus', 6]]) {
    await page.locator('input[name=size]').fill(String(size));
    await settle(page);
    await measure(page, move); // learns how long a picture takes
    await settle(page);
    const { perSecond, width, cpuMs } = await measure(page, move);
    console.log(`${what}: ${perSecond.toFixed(1)} pictures/s, mean width ${width.toFixed(0)} px, ${cpuMs.toFixed(1)} ms of processor each`);
  }
});
await stopBrowser();
