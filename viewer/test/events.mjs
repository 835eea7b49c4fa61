// Event images, recordings and models.
import assert from 'node:assert/strict';
import { assertNear, look, phone, pinch, rowOf, settle, sizeOf, stateOf, withPage } from './browser.mjs';

const large = '.frame canvas.counts';

export const tests = {
  'event images: colours, histogram, patterns, cycles': ({ url, expected }) => withPage(url('events.html', 'image=1&limit=4'), {}, async (page) => {
    assert.deepEqual(await sizeOf(page, large), [64, 48]);
    const [red, blue] = [await rowOf(page, large, 4, 0), await rowOf(page, large, 4, 2)];
    assert.ok(red[3] > blue[3] + 50 && blue[11] > red[11] + 50, 'ON is red, OFF is blue');
    const box = await page.locator(large).boundingBox();
    await page.mouse.move(box.x + (40.5 / 64) * box.width, box.y + (30.5 / 48) * box.height);
    const wanted = `33x33 px around x 40, y 30: ${expected.events_around.toFixed(2)} events per pixel; here ${expected.events_here}`;
    assert.equal(await page.locator('.histogram + .figures').textContent(), wanted);
    assert.deepEqual(await page.locator('.bar + .ends span').allTextContents(), ['4 OFF', '4 ON']);
    assert.equal(await page.getByRole('img', { name: /pattern \d: / }).count(), 6);
    assert.equal(await page.getByRole('img', { name: 'pattern 2: 50.0 % open' }).count(), 2);
    const before = await rowOf(page, large, 30);
    await page.getByRole('button', { name: 'Show transition 3' }).click();
    assert.equal((await stateOf(page)).image, '2');
    assert.notDeepEqual(await rowOf(page, large, 30), before);
    await look(page, 'image=1&limit=4&cycle=1');
    assert.notDeepEqual(await rowOf(page, large, 30), before);
  }),

  'the wheel and keys zoom event images and recordings': async ({ url }) => {
    for (const file of ['events.html', 'recording.html']) {
      await withPage(url(file, ''), {}, async (page) => {
        const box = await page.locator(large).boundingBox();
        await page.mouse.move(box.x + 1, box.y + 1);
        await page.mouse.wheel(0, -100);
        const { zoom, panx, pany } = await stateOf(page);
        assertNear([Number(zoom), Number(panx), Number(pany)], [1.2, 0.5 / 1.2, 0.5 / 1.2], 0.01, `${file}: the corner stays`);
        const wide = (await page.locator(large).boundingBox()).width;
        assert.ok(Math.abs(wide / box.width - 1.2) < 0.01, `${file}: ${wide} of ${box.width} px`);
        await page.keyboard.press('Z');
        assert.equal((await stateOf(page)).zoom, undefined, `${file}: and back`);
      });
    }
  },

  'a recording: frames, rate, triggers, zoom': ({ url }) => withPage(url('recording.html', ''), {}, async (page) => {
    const picture = '.frame canvas.counts';
    assert.deepEqual(await sizeOf(page, picture), [64, 48]);
    const box = await page.locator('canvas.axis').boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + 40);
    await settle(page);
    const frame = Number((await stateOf(page)).frame);
    assert.ok(Math.abs(frame - 10) <= 1, `the middle of 20 frames, ${frame}`);
    await page.mouse.wheel(0, -100);
    const { from, to } = await stateOf(page);
    assert.ok(Math.abs(Number(from) - 0.1) < 0.01 && Math.abs(Number(to) - 0.9) < 0.01, `zoomed to ${from}..${to}`);
    await page.getByRole('button', { name: 'Play' }).click();
    await page.waitForFunction((start) => Number(document.querySelector('input[name=frame]').value) !== start, frame);
    await page.getByRole('button', { name: 'Stop' }).click();
    const description = JSON.parse(await page.locator('#e2lf-document').textContent()).items[0];
    assert.equal(description.frames.length, 20);
    const counted = [...description.rate.on, ...description.rate.off].reduce((sum, value) => sum + value, 0);
    assert.equal(counted, description.events);
    assert.ok(description.triggers.length >= 4 && description.cycles.length >= 1, 'triggers and cycles');
  }),

  'time is zoomed by buttons and by two fingers, and the frame stays on the axis': ({ url }) => withPage(url('recording.html', 'frame=3'), phone, async (page) => {
    const range = async () => {
      const { from, to } = await stateOf(page);
      return [Number(from ?? 0), Number(to ?? 1)];
    };
    await page.getByRole('button', { name: 'Zoom in' }).click();
    const [from, to] = await range();
    assert.ok(Math.abs(to - from - 0.5) < 0.01 && from < 3.5 / 20 && to > 3.5 / 20, `${from}..${to} holds frame 3 of 20`);
    await pinch(page, 'canvas.axis', 60, 120);
    const [narrow, wide] = await range();
    assert.ok(Math.abs(wide - narrow - 0.25) < 0.02, `${narrow}..${wide}`);
    await page.locator('input[name=frame]').fill('19');
    await settle(page);
    const [after, end] = await range();
    assert.ok(after < 19 / 20 && end > 19 / 20 && Math.abs(end - after - (wide - narrow)) < 1e-3, `${after}..${end} holds the last frame`);
    await page.getByRole('button', { name: 'All of it' }).click();
    assert.deepEqual(await range(), [0, 1]);
    assert.match(await page.locator('.figures').first().textContent(), /^[\d,]+ events: ON above.* triggers: ticks. \d+ cycles? found: shaded.$/);
  }),

  'a finger points at the histogram': ({ url, expected }) => withPage(url('events.html', 'image=1'), phone, async (page) => {
    const box = await page.locator(large).boundingBox();
    await page.touchscreen.tap(box.x + (40.5 / 64) * box.width, box.y + (30.5 / 48) * box.height);
    assert.match(await page.locator('.histogram + .figures').textContent(), new RegExp(`around x 40, y 30: .*; here ${expected.events_here}$`));
  }),

  'a model shows its patterns and what is known of it': ({ url }) => withPage(url('model.html', ''), {}, async (page) => {
    assert.equal(await page.getByRole('img', { name: /pattern \d: / }).count(), 4);
    const said = await page.evaluate(() => Object.fromEntries([...document.querySelectorAll('.sentences tr')].map((row) => [...row.children].map((cell) => cell.textContent))));
    assert.equal(said['Output'], 'A light field of 8x8 views at the resolution of the sensor.');
    assert.match(said['Patterns'], /^4 patterns of 8x8 views, of which the first one is black\. They open 0 % to 13 % of the aperture, and each cell is open or closed\.$/);
    assert.match(said['Network'], /^2,090,272 parameters in 42 layers\./);
    assert.ok(!(await page.locator('td', { hasText: 'e2lf-n4' }).first().isVisible()), 'the facts are folded');
    await page.locator('summary').click();
    assert.ok(await page.locator('td', { hasText: 'e2lf-n4' }).first().isVisible());
  }),
};
