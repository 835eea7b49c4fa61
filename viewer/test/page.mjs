// The page around the pictures: address, keys, theme, help, screenshot, names, small screens.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { phone, rowOf, settle, sizeOf, stateOf, withPage } from './browser.mjs';

const pages = ['disparity.html', 'cycles.html', 'compare.html', 'truth.html', 'events.html', 'recording.html', 'model.html'];

/** Controls and pictures without a name that can be read aloud. */
async function nameless(page) {
  return page.evaluate(() => [...document.querySelectorAll('button, input, select, canvas')].filter((control) => {
    const isLabelled = [...(control.labels ?? [])].some((label) => label.querySelector('span')?.textContent);
    return !(control.getAttribute('aria-label') || isLabelled || (control.tagName === 'BUTTON' && control.textContent));
  }).map((control) => control.outerHTML));
}

export const tests = {
  'the address shows the same again': ({ url }) => withPage(url('light.html', ''), {}, async (page) => {
    await page.getByRole('slider', { name: 'Radius, views' }).fill('2');
    await page.getByRole('combobox', { name: 'Shape' }).selectOption('square');
    await page.getByRole('slider', { name: 'Disparity' }).fill('-1.5');
    await settle(page);
    assert.deepEqual(await stateOf(page), { focus: '-1.5', size: '2', shape: 'square' });
    const seen = await rowOf(page, 'canvas.picture', 20);
    await withPage(page.url(), {}, async (again) => assert.deepEqual(await rowOf(again, 'canvas.picture', 20), seen));
  }),

  'a damaged address is harmless': ({ url }) => withPage(url('light.html', 'x=1e99&cycle=-7&tab=99&shape=<b>&focus=NaN&none=1'), {}, async (page) => {
    assert.deepEqual(await sizeOf(page, 'canvas.picture'), [64, 48]);
  }),

  'keys': ({ url }) => withPage(url('compare.html', ''), {}, async (page) => {
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('+');
    await page.keyboard.press('t');
    assert.deepEqual(await stateOf(page), { theme: 'dark', x: '1', focus: '0.05' });
    await page.keyboard.press('2');
    await settle(page);
    assert.equal(await page.getByRole('tab', { selected: true }).count(), 1);
    assert.equal((await stateOf(page)).tab, '1');
    await page.keyboard.press('?');
    assert.ok(await page.getByRole('dialog').isVisible());
    await page.keyboard.press('Escape');
    assert.equal(await page.getByRole('dialog').count(), 0);
  }),

  'dark and light': ({ url }) => withPage(url('light.html', ''), { colorScheme: 'light' }, async (page) => {
    const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const light = await ground();
    await page.keyboard.press('t');
    assert.notEqual(await ground(), light);
  }),

  'a screenshot is the picture, pixel for pixel': ({ url }) => withPage(url('light.html', ''), {}, async (page) => {
    const waiting = page.waitForEvent('download');
    await page.getByRole('button', { name: 'Save the picture as PNG' }).click();
    const download = await waiting;
    assert.match(download.suggestedFilename(), /-picture\.png$/);
    const bytes = readFileSync(await download.path());
    assert.deepEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], [64, 48]);
  }),

  'each tab is reached on a phone': ({ url }) => withPage(url('all.html', 'tab=0'), { ...phone, viewport: { width: 390, height: 844 } }, async (page) => {
    for (const tab of await page.getByRole('tab').all()) {
      await tab.scrollIntoViewIfNeeded();
      const box = await tab.boundingBox();
      assert.ok(box.x >= 0 && box.x + box.width <= 390, `from ${box.x}, ${box.width} px`);
      await page.touchscreen.tap(box.x + box.width / 2, box.y + box.height / 2);
      await settle(page);
      assert.equal(await tab.getAttribute('aria-selected'), 'true', await tab.textContent());
    }
  }),

  'the chosen tab is in sight': ({ url }) => withPage(url('all.html', 'tab=4'), phone, async (page) => {
    const box = await page.getByRole('tab', { selected: true }).boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= 390, `from ${box.x}, ${box.width} px`);
  }),

  'on a phone event images and models are not cut off': async ({ url }) => {
    await withPage(url('events.html', ''), phone, async (page) => {
      const stage = await page.locator('#stage').boundingBox();
      for (const what of await page.locator('.frame canvas.counts, .thumbnail').all()) {
        const box = await what.boundingBox();
        assert.ok(box.y >= stage.y && box.y + box.height <= stage.y + stage.height, `${box.y} to ${box.y + box.height}`);
      }
    });
    await withPage(url('model.html', ''), phone, async (page) => {
      const stage = await page.locator('#stage').boundingBox();
      assert.ok(stage.height > 600, `nothing lies below, ${stage.height}`);
    });
  },

  'on a phone pictures have more room than their EPIs': ({ url }) => withPage(url('compare.html', ''), phone, async (page) => {
    const [picture, epi] = [await page.locator('canvas.picture').first().boundingBox(), await page.locator('.pane > canvas.epi:visible').first().boundingBox()];
    assert.ok(picture.height > 3 * Math.min(epi.height, epi.width), `${picture.height} against ${epi.width}x${epi.height}`);
  }),

  'every control has a name, and nothing is wider than a phone': async ({ url }) => {
    for (const name of pages) {
      await withPage(url(name, ''), { viewport: { width: 390, height: 844 }, hasTouch: true }, async (page) => {
        assert.deepEqual(await nameless(page), [], name);
        assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${name} fits`);
        // What lies in a strip is reached by scrolling it.
        const boxes = await page.evaluate(() => [...document.querySelectorAll('#stage canvas:not(.strip *), #stage .strip')].filter((one) => one.offsetParent)
          .map((one) => one.getBoundingClientRect()).filter((box) => box.left < -1 || box.right > innerWidth + 1).length);
        assert.equal(boxes, 0, `${name}: pictures inside`);
      });
    }
  },
};
