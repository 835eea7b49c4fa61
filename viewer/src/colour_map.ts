// Colour maps from numbers to red, green, blue in 0..255.

export type Colour = [number, number, number];

function between(stops: Colour[], share: number): Colour {
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const low = Math.min(Math.floor(place), stops.length - 2);
  return stops[low]!.map((value, i) => value + (place - low) * (stops[low + 1]![i]! - value)) as Colour;
}

const sequentialStops: Colour[] = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

/** Maps 0..1 to colours from dark violet over green to yellow. */
export const sequential = (share: number): Colour => between(sequentialStops, share);

/** Maps disparities from near to far to the colours of e2lf depth. */
export const disparityColour = (share: number): Colour => sequential(1 - share);
export const nearToFar = [...sequentialStops].reverse();

/** Maps event counts `value` in -1..1 to blue (OFF), the background colour of the theme (none) and red (ON). */
export function diverging(value: number, isDark: boolean): Colour {
  const none: Colour = isDark ? [18, 20, 24] : [250, 250, 250];
  const on: Colour[] = isDark ? [none, [230, 70, 50], [255, 220, 150]] : [none, [226, 88, 62], [110, 0, 20]];
  const off: Colour[] = isDark ? [none, [50, 120, 240], [170, 230, 255]] : [none, [70, 125, 210], [5, 20, 110]];
  return value >= 0 ? between(on, value) : between(off, -value);
}

/** Draws a bar of colours; `colourOf` receives the position as a share of the width. */
export function drawColours(bar: HTMLCanvasElement, colourOf: (share: number) => Colour): void {
  bar.width = 256;
  bar.height = 1;
  const context = bar.getContext('2d')!;
  for (let x = 0; x < bar.width; ++x) {
    context.fillStyle = css(colourOf(x / (bar.width - 1)));
    context.fillRect(x, 0, 1, 1);
  }
}

export const css = (colour: Colour): string => `rgb(${colour.map(Math.round).join(' ')})`;
