// Frames per second with software rendering: node viewer/test/speed.mjs PAGE.html, where the page begins with a light
// field. Moves a slider at every frame of the screen, and says how many pictures were painted and with which share of pixels.
import { pathToFileURL } from 'node:url';
import { resolve } from 'node:path';
import { settle, startBrowser, stopBrowser, withPage } from './browser.mjs';

const seconds = 5;

async function measure(page, slider) {
  return page.evaluate(async ([name, limit]) => {
    const input = document.querySelector(`input[name=${name}]`);
    const picture = document.querySelector('canvas.picture');
    const frame = () => new Promise((done) => requestAnimationFrame(done));
    const begin = performance.now();
    let frames = 0, share = 0;
    while (performance.now() - begin < 1000 * limit) {
      input.value = String(Number(input.min) + (Number(input.max) - Number(input.min)) * (0.5 + 0.4 * Math.sin(frames / 7)));
      input.dispatchEvent(new Event('input'));
      await frame(); // the picture is painted at the beginning of this one
      ++frames;
      share += picture.width;
    }
    return { perSecond: (1000 * frames) / (performance.now() - begin), meanWidth: share / frames };
  }, [slider, seconds]);
}

await startBrowser();
await withPage(String(pathToFileURL(resolve(process.argv[2]))), {}, async (page) => {
  for (const [what, slider, size] of [['parallax, one view', 'x', 0], ['focus, radius 1.5', 'focus', 1.5], ['focus, all 64 views', 'focus', 6]]) {
    await page.locator('input[name=size]').fill(String(size));
    await settle(page);
    await measure(page, slider); // learns how long a picture takes
    await settle(page);
    const { perSecond, meanWidth } = await measure(page, slider);
    console.log(`${what}: ${perSecond.toFixed(1)} pictures/s, mean width ${meanWidth.toFixed(0)} px`);
  }
});
await stopBrowser();
