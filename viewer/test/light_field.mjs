// Light fields: every picture against numbers that inputs.py computes.
import assert from 'node:assert/strict';
import { assertNear, look, phone, pinch, rowOf, settle, sizeOf, stateOf, withPage } from './browser.mjs';

const row = 20, column = 30;

export const tests = {
  'a viewpoint on a view shows that view': ({ url, expected }) => withPage(url('light.html', 'x=0.5&y=0.5'), {}, async (page) => {
    assert.deepEqual(await sizeOf(page, 'canvas.picture'), [64, 48]);
    assertNear(await rowOf(page, 'canvas.picture', row), expected.views[4][4], 0, 'view 4, 4');
    await look(page, 'x=-3.5&y=3.5');
    assertNear(await rowOf(page, 'canvas.picture', row), expected.views[7][0], 0, 'view 7, 0');
    await look(page, 'x=1&y=0.5');
    const between = expected.views[4][4].map((value, i) => (value + expected.views[4][5][i]) / 2);
    assertNear(await rowOf(page, 'canvas.picture', row), between, 1, 'between two views');
  }),

  'the first picture is that of the middle view': ({ url, expected }) => withPage(url('light.html', ''), {}, async (page) => {
    assertNear(await rowOf(page, 'canvas.picture', row), expected.views[4][4], 0, 'view 4, 4');
  }),

  'the wheel zooms where the cursor is, keys move the part, and the value under the cursor is said': ({ url, expected }) => withPage(url('light.html', ''), {}, async (page) => {
    const box = await page.locator('.frame').boundingBox();
    const place = { x: box.x + ((column + 0.5) / 64) * box.width, y: box.y + ((row + 0.5) / 48) * box.height };
    await page.mouse.move(place.x, place.y);
    await settle(page);
    const value = (expected.views[4][4][column] / 255).toFixed(3);
    assert.equal(await page.locator('#status').textContent(), `x ${column}, y ${row}: ${value}`);
    for (let i = 0; i < 20; ++i) await page.mouse.wheel(0, -100);
    await page.waitForFunction((least) => document.querySelector('canvas.picture').clientWidth / 64 >= least, 47);
    await page.mouse.move(place.x + 1, place.y);
    await settle(page);
    assert.equal(await page.locator('#status').textContent(), `x ${column}, y ${row}: ${value}`, 'still the same pixel');
    assert.ok((await page.locator('canvas.picture').boundingBox()).width / 64 < 49, 'not more than 48 px for a pixel');
    // The EPI shows the same columns.
    const epi = await rowOf(page, '.pane > canvas:last-child', 4);
    const under = Math.floor(((place.x - box.x) / box.width) * epi.length);
    assert.ok(Math.abs(epi[under] - expected.views[4][4][column]) <= 1, `${epi[under]} at ${under}`);
    const before = Number((await stateOf(page)).panx);
    await page.keyboard.press('Shift+ArrowRight');
    assert.ok(Number((await stateOf(page)).panx) > before, 'to the right');
  }),

  'focus and aperture are those of lightfield::refocus': ({ url, expected }) => withPage(url('light.html', 'x=0&y=0&focus=2&size=3'), {}, async (page) => {
    assertNear(await rowOf(page, 'canvas.picture', row), expected.focused, 1, 'in focus');
    await look(page, 'x=0&y=0&focus=0&size=3');
    assertNear(await rowOf(page, 'canvas.picture', row), expected.defocused, 1, 'out of focus');
    await look(page, 'size=1&x=1.5&y=-0.5');
    assertNear(await rowOf(page, 'canvas.picture', row), expected.moved, 1, 'a small aperture off the middle');
    await look(page, 'x=0&size=4&shape=row&y=0.5');
    const mean = expected.views[4][0].map((_, x) => expected.views[4].reduce((sum, view) => sum + view[x], 0) / 8);
    assertNear(await rowOf(page, 'canvas.picture', row), mean, 1, 'a row of views');
  }),

  'a tilted plane is in focus where it should be': ({ url, expected }) => withPage(url('light.html', 'x=0&y=0&focus=2&size=3&tiltx=4'), {}, async (page) => {
    const got = await rowOf(page, 'canvas.picture', row);
    assertNear(got.slice(31, 33), expected.focused.slice(31, 33), 6, 'in the middle');
    const far = got.reduce((sum, value, i) => sum + Math.abs(value - expected.focused[i]), 0) / got.length;
    assert.ok(far > 8, `blurred elsewhere, ${far}`);
  }),

  'gain and gamma': ({ url, expected }) => withPage(url('light.html', 'x=0.5&y=0.5&gain=0.5&gamma=2'), {}, async (page) => {
    const wanted = expected.views[4][4].map((value) => 255 * Math.sqrt((0.5 * value) / 255));
    assertNear(await rowOf(page, 'canvas.picture', row), wanted, 1, 'tones');
  }),

  'EPIs follow the cursor': ({ url, expected }) => withPage(url('light.html', 'x=0.5&y=0.5'), {}, async (page) => {
    const box = await page.locator('canvas.picture').boundingBox();
    await page.mouse.move(box.x + ((column + 0.5) / 64) * box.width, box.y + ((row + 0.5) / 48) * box.height);
    await settle(page);
    assert.deepEqual(await sizeOf(page, '.pane > canvas:last-child'), [64, 8]);
    for (const view of [0, 3, 7]) assertNear(await rowOf(page, '.pane > canvas:last-child', view), expected.views[4][view], 0, `row EPI, view ${view}`);
    assert.deepEqual(await sizeOf(page, '.frame + canvas'), [8, 48]);
    const across = expected.view_columns[0].map((_, view) => expected.view_columns[view][4][row]);
    assertNear(await rowOf(page, '.frame + canvas', row), across, 0, 'column EPI');
  }),

  'a click focuses on the point': ({ url }) => withPage(url('light.html', ''), {}, async (page) => {
    await page.locator('canvas.picture').click({ position: { x: 120, y: 90 } });
    await settle(page);
    const { focus } = await stateOf(page);
    assert.ok(Math.abs(Number(focus) - 2) < 0.05, `disparity 2, found ${focus}`);
  }),

  'dragging moves the viewpoint, the wheel with shift the focus': ({ url, expected }) => withPage(url('light.html', ''), {}, async (page) => {
    const box = await page.locator('canvas.picture').boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width, box.y + box.height / 2, { steps: 4 });
    await page.mouse.up();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.keyboard.down('Shift');
    await page.mouse.wheel(0, -100);
    await page.keyboard.up('Shift');
    await page.waitForFunction(() => Number(document.querySelector('input[name=focus]').value) !== 0);
    const state = await stateOf(page);
    assert.equal(Number(state.x), 3.5);
    assert.equal(Number(state.focus), 0.05);
    await look(page, 'x=3.5&y=0.5');
    assertNear(await rowOf(page, 'canvas.picture', row), expected.views[4][7], 0, 'the last view of its row');
  }),

  'two fingers zoom, and nothing else': ({ url }) => withPage(url('light.html', ''), phone, async (page) => {
    await pinch(page, '.frame', 50, 100);
    // Twice as far apart. The point in their middle is not clicked, the viewpoint stays.
    const { zoom, panx = '0.5', pany = '0.5', ...others } = await stateOf(page);
    assertNear([Number(zoom), Number(panx), Number(pany)], [2, 0.5, 0.5], 0.01, 'the middle, twice as large');
    assert.deepEqual(others, {});
    await pinch(page, '.frame', 100, 50);
    assert.ok(Math.abs(Number((await stateOf(page)).zoom ?? 1) - 1) < 1e-3, 'and back');
  }),

  'pictures that take long have fewer pixels while something moves': ({ url }) => withPage(url('light.html', ''), {}, async (page) => {
    const widths = await page.evaluate(async () => {
      // A slow graphics card: pictures take long, and frames of the screen come seldom.
      const { readPixels } = WebGL2RenderingContext.prototype;
      const nextFrame = window.requestAnimationFrame;
      WebGL2RenderingContext.prototype.readPixels = function (...all) {
        for (const end = performance.now() + 60; performance.now() < end;);
        readPixels.apply(this, all);
      };
      window.requestAnimationFrame = (paint) => setTimeout(() => nextFrame(paint), 250);
      const slider = document.querySelector('input[name=focus]');
      const seen = [];
      for (let i = 0; i < 12; ++i) {
        slider.value = String(0.05 * i);
        slider.dispatchEvent(new Event('input'));
        await new Promise((done) => window.requestAnimationFrame(done));
        seen.push(document.querySelector('canvas.picture').width);
      }
      WebGL2RenderingContext.prototype.readPixels = readPixels;
      window.requestAnimationFrame = nextFrame;
      return seen;
    });
    // A busy machine takes more moves to get there.
    assert.deepEqual(widths.slice(-5), new Array(5).fill(16), 'a quarter of the width');
    await settle(page);
    assert.deepEqual(await sizeOf(page, 'canvas.picture'), [64, 48], 'all pixels at rest');
  }),

  'a finger drags the viewpoint': ({ url }) => withPage(url('light.html', ''), phone, async (page) => {
    const box = await page.locator('canvas.picture').boundingBox();
    const devtools = await page.context().newCDPSession(page);
    const touch = (type, ...touchPoints) => devtools.send('Input.dispatchTouchEvent', { type, touchPoints });
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await touch('touchStart', { x, y });
    for (const share of [0.1, 0.25]) await touch('touchMove', { x: x + share * box.width, y });
    await touch('touchEnd');
    await settle(page);
    assert.ok(Math.abs(Number((await stateOf(page)).x) - 3.5) < 0.05);
  }),

  'small views are averaged and not thinned out, with a line between them': ({ url }) => withPage(url('fine.html', 'show=grid'), {}, async (page) => {
    const [width] = await sizeOf(page, 'canvas.sheet');
    assert.ok(width < 600 && width > 300, `smaller than the views, ${width} px`);
    const got = await rowOf(page, 'canvas.sheet', 40);
    const dark = got.flatMap((value, x) => (value < 30 ? [x] : []));
    assert.ok(dark.length <= 4 && dark.every((x) => x < 2 || Math.abs(x - width / 2) < 2), `lines at ${dark}`);
    const inside = got.filter((value) => value >= 30);
    assert.ok(Math.min(...inside) > 100 && Math.max(...inside) < 155, `${Math.min(...inside)} to ${Math.max(...inside)}`);
  }),

  'all views, and one of them by a click': ({ url }) => withPage(url('light.html', 'show=grid'), {}, async (page) => {
    const box = await page.locator('canvas.sheet').boundingBox();
    await page.mouse.click(box.x + (2.5 / 8) * box.width, box.y + (5.5 / 8) * box.height);
    await settle(page);
    const state = await stateOf(page);
    assert.deepEqual([Number(state.x), Number(state.y), state.show], [-1.5, 1.5, undefined]);
  }),

  'pressing on the map of views goes there': ({ url, expected }) => withPage(url('light.html', ''), {}, async (page) => {
    const box = await page.locator('canvas.map').boundingBox();
    await page.mouse.click(box.x + (1.5 / 8) * box.width, box.y + (6.5 / 8) * box.height);
    await settle(page);
    assertNear(await rowOf(page, 'canvas.picture', row), expected.views[6][1], 0, 'view 6, 1');
  }),

  'colour stays colour': ({ url }) => withPage(url('colour.html', ''), {}, async (page) => {
    for (const [channel, value] of [[0, 255], [1, 128], [2, 64]]) {
      assertNear(await rowOf(page, 'canvas.picture', 5, channel), new Array(24).fill(value), 0, `channel ${channel}`);
    }
  }),

  'the time slider shows another cycle': ({ url, expected }) => withPage(url('cycles.html', 'x=0.5&y=0.5'), {}, async (page) => {
    assertNear(await rowOf(page, 'canvas.picture', row), expected.views[4][4], 0, 'cycle 0');
    await page.locator('input[name=cycle]').fill('1');
    await settle(page);
    assertNear(await rowOf(page, 'canvas.picture', row), expected.other, 0, 'cycle 1');
  }),
};
