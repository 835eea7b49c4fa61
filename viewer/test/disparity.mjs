// Disparity maps over light fields.
import assert from 'node:assert/strict';
import { assertNear, look, rowOf, settle, withPage } from './browser.mjs';

const row = 20;

export const tests = {
  'a map has the colours of e2lf depth, and leaves out what is not known': ({ url, expected }) =>
    withPage(url('disparity.html', 'x=0.5&y=0.5&overlay=1'), {}, async (page) => {
      for (const channel of [0, 1, 2]) {
        const got = await rowOf(page, 'canvas.picture', row, channel);
        assertNear(got.slice(0, 60), expected.disparity_colours[channel], 2, `channel ${channel}`);
        assertNear(got.slice(60), expected.views[4][4].slice(60), 0, 'the picture where nothing is known');
      }
    }),

  'it moves with what it measures': ({ url, expected }) => withPage(url('disparity.html', 'x=2.5&y=0.5&overlay=1'), {}, async (page) => {
    // A pixel of the map is a whole pixel wide: colours change by up to 8 within it.
    for (const channel of [0, 1, 2]) {
      const got = await rowOf(page, 'canvas.picture', row, channel);
      assertNear(got.slice(3, 60), expected.disparity_colours_moved[channel].slice(3, 60), 12, `channel ${channel}`);
    }
  }),

  'the focus moves map and picture alike': ({ url, expected }) => withPage(url('disparity.html', 'x=0.5&y=0.5&focus=2&overlay=1'), {}, async (page) => {
    // View 4, 4 is half a view from the middle on both axes: one pixel to the left.
    const got = await rowOf(page, 'canvas.picture', row);
    assertNear(got.slice(0, 59), expected.disparity_colours[0].slice(1), 2, 'moved by one pixel');
  }),

  'the slider mixes': ({ url, expected }) => withPage(url('disparity.html', 'x=0.5&y=0.5'), {}, async (page) => {
    await page.locator('input[name=overlay]').fill('0.25');
    await settle(page);
    const wanted = expected.disparity_colours[0].map((value, i) => 0.25 * value + 0.75 * expected.views[4][4][i]);
    assertNear((await rowOf(page, 'canvas.picture', row)).slice(0, 60), wanted, 2, 'a quarter');
    await look(page, 'x=0.5&y=0.5&overlay=0');
    assertNear(await rowOf(page, 'canvas.picture', row), expected.views[4][4], 0, 'none');
  }),

  'the number under the cursor is said': ({ url }) => withPage(url('disparity.html', 'x=0.5&y=0.5'), {}, async (page) => {
    const box = await page.locator('canvas.picture').boundingBox();
    await page.mouse.move(box.x + (32.5 / 64) * box.width, box.y + (10.5 / 48) * box.height);
    await settle(page);
    assert.equal(await page.locator('#status').textContent(), 'x 32, y 10 of the map: 1.500 px per view');
  }),

  'what e2lf depth writes is shown': ({ url }) => withPage(url('depth.html', 'x=0.5&y=0.5&overlay=1'), {}, async (page) => {
    const [red, blue] = [await rowOf(page, 'canvas.picture', 24, 0), await rowOf(page, 'canvas.picture', 24, 2)];
    assert.ok(Math.max(...red.map((value, i) => Math.abs(value - blue[i]))) > 60, 'colours');
  }),

  'light fields without a map have no controls for one': ({ url }) => withPage(url('light.html', ''), {}, async (page) => {
    assert.equal(await page.locator('input[name=overlay]').count(), 0);
  }),
};
