// Draws src/e2lf/depth/legend_glyphs.png, the characters of legends side by side, and prints their widths for legend.cpp.
// Usage: node scripts/draw_legend_glyphs.mjs (needs viewer/node_modules, chromium and the font DejaVu Sans)
import { writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const { chromium } = createRequire(new URL('../viewer/package.json', import.meta.url))('playwright-core');
const characters = '0123456789-.aefinprstvwx ';
const height = 64, em = 50, baseline = 49;

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'] });
const page = await browser.newPage();
const { widths, png } = await page.evaluate(async ([all, tall, size, base]) => {
  const context = document.createElement('canvas').getContext('2d');
  const font = `${size}px "DejaVu Sans"`;
  context.font = font;
  // A hyphen stands for the minus sign.
  const drawn = [...all].map((one) => (one === '-' ? '\u2212' : one));
  const widths = drawn.map((one) => Math.round(context.measureText(one).width));
  const { canvas } = context;
  [canvas.width, canvas.height] = [widths.reduce((sum, one) => sum + one), tall];
  context.fillStyle = 'black';
  context.fillRect(0, 0, canvas.width, tall);
  context.fillStyle = 'white';
  context.font = font;
  drawn.reduce((left, one, i) => (context.fillText(one, left, base), left + widths[i]), 0);
  return { widths, png: canvas.toDataURL('image/png').split(',')[1] };
}, [characters, height, em, baseline]);
await browser.close();
writeFileSync(new URL('../src/e2lf/depth/legend_glyphs.png', import.meta.url), Buffer.from(png, 'base64'));
console.log(`"${characters}"`, widths.join(', '));
