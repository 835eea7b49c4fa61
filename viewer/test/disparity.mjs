// Disparity maps over light fields.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { assertNear, look, rowOf, settle, sizeOf, stateOf, withPage } from './browser.mjs';

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

  'a viewpoint between views is interpolated along the map': ({ url, expected }) => withPage(url('between.html', 'x=1&y=0.5&overlay=0'), {}, async (page) => {
    // Half a view to the right of view 4, 4: one pixel.
    assertNear((await rowOf(page, 'canvas.picture', row)).slice(2, -1), expected.views[4][4].slice(1, -2), 1, 'sharp');
  }),

  'a viewpoint outside the grid is extrapolated along the map': ({ url, expected }) => withPage(url('between.html', 'x=4.5&y=0.5&overlay=0'), {}, async (page) => {
    // Four views to the right of view 4, 4, where the last view is three to the right: eight pixels, of which the last view shows six.
    assertNear((await rowOf(page, 'canvas.picture', row)).slice(9, -1), expected.views[4][4].slice(1, -9), 1, 'the plane has moved on');
    await page.keyboard.press('ArrowRight');
    assert.equal((await stateOf(page)).x, '5');
    await look(page, 'x=9&y=0.5&overlay=0&size=1');
    const atEdge = await rowOf(page, 'canvas.picture', row);
    await look(page, 'x=3.5&y=0.5&overlay=0&size=1');
    assertNear(await rowOf(page, 'canvas.picture', row), atEdge, 0, 'an aperture stays in the grid');
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
    assert.match(await page.locator('#status').textContent(), /^x 32, y 10: 0\.\d{3}; disparity 1\.500 px per view$/);
  }),

  'what e2lf depth writes is shown': ({ url }) => withPage(url('depth.html', 'x=0.5&y=0.5&overlay=1'), {}, async (page) => {
    const [red, blue] = [await rowOf(page, 'canvas.picture', 24, 0), await rowOf(page, 'canvas.picture', 24, 2)];
    assert.ok(Math.max(...red.map((value, i) => Math.abs(value - blue[i]))) > 60, 'colours');
  }),

  'pixels of a low confidence have no colour': ({ url }) => withPage(url('depth.html', 'x=0.5&y=0.5&show=disparity&sure=0'), {}, async (page) => {
    const numGrey = async () => {
      const [red, green, blue] = [await rowOf(page, 'canvas.picture', 24, 0), await rowOf(page, 'canvas.picture', 24, 1), await rowOf(page, 'canvas.picture', 24, 2)];
      return red.filter((value, x) => value === green[x] && value === blue[x]).length;
    };
    assert.equal(await numGrey(), 0, 'all have one');
    await look(page, 'x=0.5&y=0.5&show=disparity&sure=1');
    assert.equal(await numGrey(), 64, 'none has one');
  }),

  'a relief leaves out uncertain points and outliers, closes holes whose sides agree, and is saved as glTF': async ({ url }) => {
    const { disparity, isOpen } = JSON.parse(readFileSync('surface.json', 'utf8'));
    await withPage(url('surface.html', 'show=relief&turn=0&tip=0&depth=0.5&overlay=0'), {}, async (page) => {
      const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Save GLB' }).click()]);
      const file = readFileSync(await download.path());
      assert.deepEqual([file.readUInt32LE(0), file.readUInt32LE(4), file.readUInt32LE(8)], [0x46546c67, 2, file.length]);
      const length = file.readUInt32LE(12);
      const { accessors, bufferViews, meshes } = JSON.parse(file.subarray(20, 20 + length));
      const bytesOf = (view) => file.subarray(28 + length + bufferViews[view].byteOffset).subarray(0, bufferViews[view].byteLength);
      const { attributes: { POSITION, TEXCOORD_0 }, indices } = meshes[0].primitives[0];
      const places = bytesOf(accessors[TEXCOORD_0].bufferView), positions = bytesOf(accessors[POSITION].bufferView);
      assert.deepEqual([...bytesOf(3).subarray(1, 4)], [...Buffer.from('PNG')], 'the picture');
      const found = new Map();
      for (let i = 0; i < accessors[POSITION].count; ++i) {
        const [x, y] = [Math.floor(64 * places.readFloatLE(8 * i)), Math.floor(48 * places.readFloatLE(8 * i + 4))];
        found.set(`${x} ${y}`, positions.readFloatLE(12 * i + 8));
        assert.ok(Math.abs(positions.readFloatLE(12 * i) - ((2 * (x + 0.5)) / 64 - 1)) < 1e-5, 'x in half widths');
      }
      for (let i = 0; i < accessors[indices].count; ++i) assert.ok(bytesOf(accessors[indices].bufferView).readUInt32LE(4 * i) < accessors[POSITION].count);
      // Two planes at -1 and 1: half of the depth before and behind the middle.
      for (const [y, row] of isOpen.entries()) {
        for (const [x, open] of row.entries()) {
          assert.equal(found.has(`${x} ${y}`), !open, `x ${x}, y ${y}`);
          if (!open) assert.ok(Math.abs(found.get(`${x} ${y}`) + disparity[y][x] / 2) < 0.01, `x ${x}, y ${y}: ${found.get(`${x} ${y}`)}`);
        }
      }
    });
  },

  'the folder of e2lf depth alone shows the light field with its map, or the map where that is gone': async ({ url }) => {
    await withPage(url('depth_alone.html', ''), {}, async (page) => {
      assert.equal(await page.locator('canvas.map').count(), 1, 'the views are there');
      assert.equal(await page.locator('input[name=overlay]').count(), 1);
    });
    await withPage(url('map_alone.html', ''), {}, async (page) => {
      assert.equal(await page.locator('canvas.map').count(), 0, 'a single picture');
      const [red, blue] = [await rowOf(page, 'canvas.picture', 24, 0), await rowOf(page, 'canvas.picture', 24, 2)];
      assert.ok(Math.max(...red.map((value, i) => Math.abs(value - blue[i]))) > 60, 'colours');
    });
  },

  'a relief is turned by dragging, is open where nothing is known, and has the picture on it': ({ url, expected }) =>
    withPage(url('disparity.html', 'show=relief&turn=0&tip=0&depth=0&overlay=0'), {}, async (page) => {
      const [width, height] = await sizeOf(page, 'canvas.picture');
      const y = Math.floor((0.5 + 0.85 * ((row + 0.5) / 48 - 0.5)) * height);
      const middle = await rowOf(page, 'canvas.picture', y);
      const ground = middle[0];
      const seen = middle.flatMap((value, x) => (value === ground ? [] : [x]));
      // A flat relief: 85 % of the width, without the last columns, which are not known.
      assert.ok(Math.abs(seen[0] / width - 0.075) < 0.03 && Math.abs(seen.at(-1) / width - (0.075 + (0.85 * 59.5) / 64)) < 0.03, `${seen[0]} to ${seen.at(-1)} of ${width}`);
      const at = Math.round((0.075 + (0.85 * 30.5) / 64) * width);
      assert.ok(Math.abs(middle[at] - expected.views[4][4][30]) < 60, 'the picture of the view');
      const box = await page.locator('canvas.picture').boundingBox();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      await page.mouse.down();
      await page.mouse.move(box.x + 0.7 * box.width, box.y + box.height / 2, { steps: 3 });
      await page.mouse.up();
      await settle(page);
      const { turn, x } = await stateOf(page);
      assert.ok(Math.abs(Number(turn) - 0.6) < 0.02, turn);
      assert.equal(x, undefined, 'the viewpoint stays');
      const turned = await rowOf(page, 'canvas.picture', y);
      const last = turned.flatMap((value, i) => (value === ground ? [] : [i])).at(-1);
      assert.ok(last < seen.at(-1) - 5, 'narrower');
    }),

  'a relief is within the picture however it is turned': ({ url }) =>
    withPage(url('surface.html', 'show=relief&turn=0.9&tip=-0.4&depth=1&overlay=0'), {}, async (page) => {
      for (const hash of ['', 'show=relief&turn=-0.9&tip=0.5&depth=1&overlay=0']) {
        if (hash !== '') await look(page, hash);
        const [atBorder, shown] = await page.evaluate(() => {
          const canvas = document.querySelector('canvas.picture');
          const { width, height } = canvas;
          const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
          let border = 0, all = 0;
          for (let i = 0; i < width * height; ++i) {
            if (data[4 * i] === data[0]) continue; // the ground
            const [x, y] = [i % width, Math.floor(i / width)];
            border += Number(Math.min(x, y, width - 1 - x, height - 1 - y) < 2);
            ++all;
          }
          return [border, all / (width * height)];
        });
        assert.equal(atBorder, 0, `${hash}: it is cut`);
        assert.ok(shown > 0.05, `${hash}: ${shown} of the picture`);
      }
    }),

  'true and reconstructed disparities are side by side in the same colours, with the figures of e2lf eval': ({ url }) =>
    withPage(url('truth.html', 'show=disparity'), {}, async (page) => {
      const { disparity, psnr_db: psnr } = JSON.parse(readFileSync('quality.json', 'utf8'));
      const fitted = JSON.parse(readFileSync('fitted.json', 'utf8')).psnr_db;
      const figures = await page.evaluate(() => Object.fromEntries([...document.querySelectorAll('dl dt')].map((name) => [name.textContent, name.nextSibling.textContent])));
      assert.deepEqual(Object.values(figures).filter((_, i) => i !== 2), [`${psnr.toFixed(2)} dB`, `${fitted.toFixed(2)} dB`, `${disparity.bad_07_percent.toFixed(1)} %`,
        `${disparity.bad_20_percent.toFixed(1)} %`, `${disparity.mean_absolute_px.toFixed(3)} px`, disparity.slope.toFixed(2)]);
      assert.equal(await page.locator('.pane:visible').count(), 2);
      const numbers = (await page.locator('.bar + .ends').first().locator('span').allTextContents()).map(Number);
      assert.equal(numbers.length, 5);
      assert.ok(numbers.every((value, i) => i === 0 || value > numbers[i - 1]), 'a legend with numbers');
      for (const pane of [1, 2]) {
        const [red, blue] = [await rowOf(page, `.pane:nth-of-type(${pane}) canvas.picture`, 24, 0), await rowOf(page, `.pane:nth-of-type(${pane}) canvas.picture`, 24, 2)];
        assert.ok(Math.max(...red.map((value, i) => Math.abs(value - blue[i]))) > 60, `colours of ${pane}`);
      }
    }),

  'light fields without a map have no controls for one': ({ url }) => withPage(url('light.html', ''), {}, async (page) => {
    assert.equal(await page.locator('input[name=overlay]').count(), 0);
  }),
};
