// The synthetic aperture: the weights of the views. Positions are in view steps from the middle of the grid.

import { clamp } from './dom';

export interface ApertureShape {
  x: number;
  y: number;
  size: number; // radius; 0 = one view, interpolated between its neighbours
  shape: string;
}

export const shapes: Record<string, string> = {
  round: 'round',
  square: 'square',
  ring: 'ring',
  row: 'row of views',
  column: 'column of views',
};

/** Returns the distance of a view from the middle of the shape, whose rim at `size` is one view step wide. */
function distance(shape: string, size: number, dx: number, dy: number): number {
  const far = 1e3;
  switch (shape) {
    case 'square': return Math.max(Math.abs(dx), Math.abs(dy));
    case 'ring': return size - 0.5 + Math.abs(Math.hypot(dx, dy) - size);
    case 'row': return Math.abs(dy) < 0.5 ? Math.abs(dx) : far;
    case 'column': return Math.abs(dx) < 0.5 ? Math.abs(dy) : far;
    default: return Math.hypot(dx, dy);
  }
}

const tent = (offset: number): number => Math.max(0, 1 - Math.abs(offset));

/** Returns the weight of each view, in view order; the sum is positive. A round aperture of at least one view step has
 *  the weights of lightfield::round_aperture; smaller ones blend continuously into a single view. */
export function apertureWeights([rows, columns]: [number, number], aperture: ApertureShape): Float32Array {
  const weights = new Float32Array(rows * columns);
  const share = Math.min(1, aperture.size);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const dx = column - (columns - 1) / 2 - aperture.x;
      const dy = row - (rows - 1) / 2 - aperture.y;
      const rim = aperture.size + 0.5 - distance(aperture.shape, aperture.size, dx, dy);
      const open = Math.min(Math.max(rim, 0), 1);
      weights[row * columns + column] = share * open + (1 - share) * tent(dx) * tent(dy);
    }
  }
  if (weights.every((weight) => weight === 0)) weights[nearestView([rows, columns], aperture)] = 1;
  return weights;
}

const stepsBeyond = 2; // viewpoints that a disparity map extrapolates

/** Returns the viewpoint nearest to `value` on an axis of `count` views. With a map, there are also single views from outside
 *  the grid. */
export function nearestViewpoint(value: number, count: number, size: number, hasMap: boolean): number {
  const reach = (count - 1) / 2 + (hasMap && size === 0 ? stepsBeyond : 0);
  return clamp(value, -reach, reach);
}

/** Returns the number of the view nearest to a position. */
export function nearestView([rows, columns]: [number, number], place: { x: number; y: number }): number {
  const near = (offset: number, count: number) => Math.min(Math.max(Math.round(offset + (count - 1) / 2), 0), count - 1);
  return near(place.y, rows) * columns + near(place.x, columns);
}

/** Returns the table of the picture shader: number, offset from the middle (x, y) and weight of each view used. */
export function apertureTaps([rows, columns]: [number, number], weights: Float32Array): Float32Array {
  const taps: number[] = [];
  weights.forEach((weight, number) => {
    if (weight === 0) return;
    taps.push(number, (number % columns) - (columns - 1) / 2, Math.floor(number / columns) - (rows - 1) / 2, weight);
  });
  return new Float32Array(taps);
}
