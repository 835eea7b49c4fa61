// Films that the page saves: their frames against the views they must show.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { assertNear, settle, stateOf, withPage } from './browser.mjs';

const row = 20;

/** Presses a button and gives what the page saves: its name and what is in it, as a data URL. */
async function saved(page, button, type) {
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: button }).click()]);
  const bytes = readFileSync(await download.path());
  return { name: download.suggestedFilename(), data: `data:${type};base64,${bytes.toString('base64')}` };
}

/** Rows of frames of a GIF, red, green and blue in turn, as the browser's own decoder reads them. */
const gifRows = (page, data, frames, which = [row]) => page.evaluate(async ([source, numbers, ys]) => {
  const decoder = new ImageDecoder({ data: await (await fetch(source)).arrayBuffer(), type: 'image/gif' });
  await decoder.tracks.ready;
  const rows = [];
  for (const frameIndex of numbers) {
    const { image } = await decoder.decode({ frameIndex });
    const canvas = new OffscreenCanvas(image.displayWidth, image.displayHeight);
    canvas.getContext('2d').drawImage(image, 0, 0);
    rows.push(ys.flatMap((y) => {
      const pixels = canvas.getContext('2d').getImageData(0, y, canvas.width, 1).data;
      return Array.from({ length: 3 * canvas.width }, (_, i) => pixels[4 * Math.floor(i / 3) + (i % 3)]);
    }));
  }
  return { count: decoder.tracks.selectedTrack.frameCount, durationUs: (await decoder.decode({ frameIndex: 0 })).image.duration, rows };
}, [data, frames, which]);

const grey = (row) => row.filter((_, i) => i % 3 === 0);
const mean = (one, other) => one.map((value, i) => (value + other[i]) / 2);

export const tests = {
  'a GIF goes from left to right, grey for grey': ({ url, expected }) => withPage(url('light.html', 'path=sweep&x=1&y=1'), {}, async (page) => {
    const { name, data } = await saved(page, 'Save GIF', 'image/gif');
    assert.match(name, /light\.npy-sweep\.gif$/);
    const { count, durationUs, rows } = await gifRows(page, data, [0, 24]);
    assert.equal(count, 48);
    assert.equal(durationUs, 50_000);
    // In the middle between the rows of views 3 and 4.
    assertNear(grey(rows[0]), mean(expected.views[3][0], expected.views[4][0]), 1, 'the first frame');
    assertNear(grey(rows[1]), mean(expected.views[3][7], expected.views[4][7]), 1, 'the frame in the middle');
    await settle(page);
    const { x, y } = await stateOf(page);
    assert.deepEqual([x, y], ['1', '1'], 'all is as before');
  }),

  'colour is mixed of 252 colours': ({ url }) => withPage(url('colour.html', 'path=focus'), {}, async (page) => {
    const { data } = await saved(page, 'Save GIF', 'image/gif');
    const { rows } = await gifRows(page, data, [7], [0, 1, 2, 3]);
    assert.equal(rows[0].length, 4 * 3 * 24);
    for (const [channel, value] of [[0, 255], [1, 128], [2, 64]]) {
      const values = rows[0].filter((_, i) => i % 3 === channel);
      const average = values.reduce((sum, each) => sum + each, 0) / values.length;
      assert.ok(Math.abs(average - value) <= 4, `channel ${channel}: ${average} instead of ${value}`);
    }
  }),

  ...Object.fromEntries(['WebM', 'MP4'].map((format) => [`a ${format} shows the same`, ({ url, expected }) => withPage(url('light.html', 'path=sweep'), {}, async (page) => {
    const ending = format.toLowerCase();
    const isRecorded = await page.evaluate((type) => MediaRecorder.isTypeSupported(type), `video/${ending}`);
    assert.equal(await page.getByRole('button', { name: `Save ${format}` }).count(), Number(isRecorded), 'a button where the browser can');
    if (!isRecorded) return;
    const { name, data } = await saved(page, `Save ${format}`, `video/${ending}`);
    assert.ok(name.endsWith(`light.npy-sweep.${ending}`), name);
    const bytes = Buffer.from(data.split(',')[1], 'base64');
    assert.equal(format === 'MP4' ? bytes.toString('latin1', 4, 8) : bytes.toString('hex', 0, 4), format === 'MP4' ? 'ftyp' : '1a45dfa3');
    const { width, height, pixels } = await page.evaluate(async ([source, y]) => {
      const video = document.createElement('video');
      video.muted = true;
      video.src = URL.createObjectURL(await (await fetch(source)).blob());
      await new Promise((resolve, reject) => {
        video.requestVideoFrameCallback(resolve);
        video.addEventListener('error', () => reject(new Error('the film cannot be read')));
      });
      const canvas = new OffscreenCanvas(video.videoWidth, video.videoHeight);
      canvas.getContext('2d').drawImage(video, 0, 0);
      const { data: rgba } = canvas.getContext('2d').getImageData(0, y, canvas.width, 1);
      return { width: video.videoWidth, height: video.videoHeight, pixels: Array.from({ length: canvas.width }, (_, x) => rgba[4 * x]) };
    }, [data, row]);
    assert.deepEqual([width, height], [64, 48]);
    const first = mean(expected.views[3][0], expected.views[4][0]);
    const far = (other) => pixels.reduce((sum, value, i) => sum + Math.abs(value - other[i]), 0) / pixels.length;
    assert.ok(far(first) < 10, `the first frame differs by ${far(first)}`);
    assert.ok(far(mean(expected.views[3][7], expected.views[4][7])) > 2 * far(first), 'and not by as much as another one');
  })])),
};
