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

  'the swipe line stays in the part that is shown': ({ url, expected }) => withPage(url('compare.html', 'x=0.5&y=0.5&compare=swipe&zoom=2&panx=0.75'), {}, async (page) => {
    // The right half is shown, and its middle is at three quarters of the picture.
    assertNear(await rowOf(page, 'canvas.picture', row), [...expected.views[4][4].slice(0, 48), ...expected.other.slice(48)], 0, 'swipe');
    const [frame, line] = [await page.locator('.frame').first().boundingBox(), await page.locator('.split').first().boundingBox()];
    assert.ok(Math.abs(line.x + line.width / 2 - (frame.x + frame.width / 2)) < 2, `${line.x} in ${frame.x}`);
  }),

  'two pictures fill the stage beside or above each other': async ({ url }) => {
    for (const [viewport, isBeside] of [[{ width: 828, height: 460 }, true], [{ width: 390, height: 900 }, false]]) {
      await withPage(url('compare.html', ''), { viewport }, async (page) => {
        const stage = await page.locator('#stage').boundingBox();
        const [first, second] = [await page.locator('.frame').first().boundingBox(), await page.locator('.frame').nth(1).boundingBox()];
        const [begin, end, whole] = isBeside ? [first.x, second.x + second.width, stage.width] : [first.y, second.y + second.height, stage.height];
        assert.ok(end - begin > 0.88 * whole, `${begin} to ${end} of ${whole}`);
        assert.equal(first.y === second.y, isBeside);
      });
    }
  },

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
