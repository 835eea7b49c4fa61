// A page of the viewer in Debian's chromium, without a screen and with software rendering.
import assert from 'node:assert/strict';
import { chromium } from 'playwright-core';

const flags = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];
const patienceMs = 120_000; // machines of continuous integration are slow

let browser;

export async function startBrowser() {
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: flags, timeout: patienceMs });
}

export async function stopBrowser() {
  await browser.close();
}

/** The browser's processes: [{ type, id, cpuTime in seconds }]. */
export async function processes() {
  const devtools = await browser.newBrowserCDPSession();
  const { processInfo } = await devtools.send('SystemInfo.getProcessInfo');
  await devtools.detach();
  return processInfo;
}

/** Opens an address; `check` gets the page. Whatever the console says is a failure. */
export async function withPage(url, options, check) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, colorScheme: 'dark', ...options });
  context.setDefaultTimeout(patienceMs);
  const page = await context.newPage();
  const complaints = [];
  // The tests read canvases back, and the page waits for each picture of a film: the browser thinks both slow.
  const isOfSpeed = (text) => text.includes('willReadFrequently') || text.includes('GPU stall due to ReadPixels');
  page.on('console', (message) => isOfSpeed(message.text()) || complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(error.message));
  await page.goto(url);
  await settle(page);
  await check(page);
  assert.deepEqual(complaints, [], 'the console is silent');
  await context.close();
}

/** Until everything that was asked for is shown. */
export async function settle(page) {
  const deadline = Date.now() + patienceMs;
  const isAtRest = () => page.evaluate(() => new Promise((resolve) => {
    const look = () => resolve(document.getElementById('stage').getAttribute('aria-busy') === 'false');
    requestAnimationFrame(() => requestAnimationFrame(look));
  }));
  while (!(await isAtRest())) assert.ok(Date.now() < deadline, 'the page comes to rest');
}

/** Sets what the address behind '#' holds. */
export async function look(page, hash) {
  await page.evaluate((text) => new Promise((resolve) => {
    addEventListener('hashchange', resolve, { once: true });
    location.hash = text;
  }), hash);
  await settle(page);
}

/** A phone held upright. */
export const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };

/** Two fingers on an element, from so far apart (px) to so far, around its middle. */
export async function pinch(page, selector, from, to) {
  const box = await page.locator(selector).first().boundingBox();
  const devtools = await page.context().newCDPSession(page);
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const touch = (type, apart) => devtools.send('Input.dispatchTouchEvent',
    { type, touchPoints: apart === null ? [] : [{ x: x - apart / 2, y, id: 0 }, { x: x + apart / 2, y, id: 1 }] });
  await touch('touchStart', from);
  for (const share of [0.5, 1]) await touch('touchMove', from + share * (to - from));
  await touch('touchEnd', null);
  await settle(page);
}

/** One row of a canvas as numbers of one channel (0 red, 1 green, 2 blue). */
export async function rowOf(page, selector, y, channel = 0) {
  return page.evaluate(([where, row, which]) => {
    const canvas = [...document.querySelectorAll(where)].find((one) => one.offsetParent !== null);
    const { data } = canvas.getContext('2d').getImageData(0, row, canvas.width, 1);
    return Array.from({ length: canvas.width }, (_, x) => data[4 * x + which]);
  }, [selector, y, channel]);
}

export async function sizeOf(page, selector) {
  return page.evaluate((where) => {
    const canvas = [...document.querySelectorAll(where)].find((one) => one.offsetParent !== null);
    return [canvas.width, canvas.height];
  }, selector);
}

/** The state in the address, once it has been written there. */
export async function stateOf(page) {
  await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 300)));
  return Object.fromEntries(new URLSearchParams(new URL(page.url()).hash.slice(1)));
}

export function assertNear(got, expected, tolerance, what) {
  assert.equal(got.length, expected.length, `${what}: length`);
  const far = got.findIndex((value, i) => !(Math.abs(value - expected[i]) <= tolerance));
  assert.equal(far, -1, `${what}: ${got[far]} instead of ${expected[far]} at ${far}`);
}
