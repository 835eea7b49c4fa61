// Two light fields: side by side, swipe, difference, PSNR.
import assert from 'node:assert/strict';
import { assertNear, look, rowOf, settle, stateOf, withPage } from './browser.mjs';

const row = 20;

export const tests = {
  'side by side, swipe and difference': ({ url, expected }) => withPage(url('compare.html', 'x=0.5&y=0.5'), {}, async (page) => {
    const [first, second] = [expected.views[4][4], expected.other];
    assertNear(await rowOf(page, '.pane:nth-of-type(1) canvas.picture', row), first, 0, 'left');
    assertNear(await rowOf(page, '.pane:nth-of-type(2) canvas.picture', row), second, 0, 'right');
    await look(page, 'x=0.5&y=0.5&compare=swipe&split=0.25');
    assertNear(await rowOf(page, 'canvas.picture', row), [...first.slice(0, 16), ...second.slice(16)], 0, 'swipe');
    await look(page, 'x=0.5&y=0.5&compare=difference&boost=4');
    // Brighter is red (no blue), darker is blue (no red); white where equal.
    const faded = first.map((value, i) => Math.round(255 * Math.max(0, 1 - (4 * Math.abs(second[i] - value)) / 255)));
    const red = first.map((value, i) => (second[i] > value ? 255 : faded[i]));
    assertNear(await rowOf(page, 'canvas.picture', row, 0), red, 1, 'red of the difference');
    const blue = first.map((value, i) => (second[i] < value ? 255 : faded[i]));
    assertNear(await rowOf(page, 'canvas.picture', row, 2), blue, 1, 'blue of the difference');
  }),

  'the swipe line is dragged': ({ url }) => withPage(url('compare.html', 'compare=swipe'), {}, async (page) => {
    const box = await page.locator('.frame').first().boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + 40);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.75 * box.width, box.y + 40, { steps: 3 });
    await page.mouse.up();
    await settle(page);
    assert.ok(Math.abs(Number((await stateOf(page)).split) - 0.75) < 0.01);
  }),

  'PSNR of each view is a map that selects the view': ({ url, expected }) => withPage(url('compare.html', ''), {}, async (page) => {
    const known = expected.psnr_db.filter((value) => value !== null);
    const ends = (await page.locator('.bar + .ends span').allTextContents()).map((text) => /^([\d.]+) dB(, equal)?$/.exec(text));
    assertNear(ends.map((end) => Number(end[1])), [Math.min(...known), Math.max(...known)], 0.01, 'the ends of the colours');
    assert.equal(ends[1][2], ', equal');
    const box = await page.locator('canvas.map').boundingBox();
    const status = async (viewRow, viewColumn) => {
      await page.mouse.move(box.x + ((viewColumn + 0.5) / 8) * box.width, box.y + ((viewRow + 0.5) / 8) * box.height);
      return page.locator('#status').textContent();
    };
    assert.equal(await status(3, 5), `view 3, 5, ${expected.psnr_db[29].toFixed(2)} dB`);
    assert.equal(await status(0, 0), 'view 0, 0, equal');
    await page.mouse.down();
    await page.mouse.up();
    const state = await stateOf(page);
    assert.deepEqual([Number(state.x), Number(state.y)], [-3.5, -3.5]);
  }),
};
