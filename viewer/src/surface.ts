// The surface that a relief shows: a grid of disparities that is smooth within things, open at jumps and where nothing is
// certain, without outliers, and closed across holes whose sides agree.
import type { DisparityMap } from './disparity_map';

const numSmoothings = 6;
const outlierRadius = 3; // vertices

export interface Surface {
  columns: number;
  rows: number;
  step: number; // px of the map from vertex to vertex; the first one is in the middle of step x step pixels
  disparities: Float32Array; // [row, column], px per view step; NaN where the surface is open
  triangles: Uint32Array; // numbers of vertices, three each
}

/** Returns the surface over the pixels of a map with at least this confidence. */
export function surfaceOf(map: DisparityMap, step: number, leastConfidence: number): Surface {
  const [width, height] = map.size;
  const [columns, rows] = [Math.max(Math.floor(width / step), 1), Math.max(Math.floor(height / step), 1)];
  const range = map.range[1] - map.range[0];
  const jump = Math.max(0.1, 0.05 * range) * Math.sqrt(step / 2); // within a thing, neighbouring vertices differ by less
  const disparities = new Float32Array(columns * rows);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      disparities[row * columns + column] = meanAround(map, column * step, row * step, step, jump, leastConfidence);
    }
  }
  dropOutliers(disparities, columns, rows, jump);
  smooth(disparities, columns, rows, jump);
  closeHoles(disparities, columns, rows, 2 * jump);
  smooth(disparities, columns, rows, jump);
  return { columns, rows, step, disparities, triangles: trianglesOf(disparities, columns, rows, jump) };
}

/** Returns the mean of the certain pixels of a block and of those around it, weighted by their confidence. A block that
 *  two things share has the disparities of that with the most certain pixel of the block. */
function meanAround(map: DisparityMap, left: number, top: number, step: number, jump: number, leastConfidence: number): number {
  const [width, height] = map.size;
  const around = Math.max(step - 1, 1);
  let reference = NaN, most = -1;
  for (let y = top; y < Math.min(top + step, height); ++y) {
    for (let x = left; x < Math.min(left + step, width); ++x) {
      const confidence = map.confidenceAt(x, y);
      const value = confidence < leastConfidence || confidence <= most ? NaN : map.valueAt(x, y);
      if (Number.isNaN(value)) continue;
      [reference, most] = [value, confidence];
    }
  }
  if (Number.isNaN(reference)) return NaN;
  let sum = 0, weights = 0;
  for (let y = Math.max(top - around, 0); y < Math.min(top + step + around, height); ++y) {
    for (let x = Math.max(left - around, 0); x < Math.min(left + step + around, width); ++x) {
      const value = map.valueAt(x, y);
      const confidence = map.confidenceAt(x, y);
      if (!(Math.abs(value - reference) <= jump) || confidence < leastConfidence) continue;
      const weight = confidence + 1e-3;
      sum += weight * value;
      weights += weight;
    }
  }
  return sum / weights;
}

/** Replaces vertices by the mean of those around them that differ by at most `jump`, several times. */
function smooth(disparities: Float32Array, columns: number, rows: number, jump: number): void {
  for (let pass = 0; pass < numSmoothings; ++pass) {
    const before = disparities.slice();
    for (let row = 0; row < rows; ++row) {
      for (let column = 0; column < columns; ++column) {
        const middle = before[row * columns + column]!;
        let sum = 0, count = 0;
        for (let y = Math.max(row - 1, 0); y <= Math.min(row + 1, rows - 1); ++y) {
          for (let x = Math.max(column - 1, 0); x <= Math.min(column + 1, columns - 1); ++x) {
            const value = before[y * columns + x]!;
            if (!(Math.abs(value - middle) <= jump)) continue;
            sum += value;
            ++count;
          }
        }
        disparities[row * columns + column] = sum / count; // NaN where the middle is
      }
    }
  }
}

/** Clears the vertices with which fewer than a third of the known ones around them agree: wrong matches, which would tear
 *  the surface. Twice, because they come in groups. */
function dropOutliers(disparities: Float32Array, columns: number, rows: number, jump: number): void {
  for (let pass = 0; pass < 2; ++pass) {
    const before = disparities.slice();
    for (let row = 0; row < rows; ++row) {
      for (let column = 0; column < columns; ++column) {
        const middle = before[row * columns + column]!;
        let known = 0, agreeing = 0;
        for (let y = Math.max(row - outlierRadius, 0); y <= Math.min(row + outlierRadius, rows - 1); ++y) {
          for (let x = Math.max(column - outlierRadius, 0); x <= Math.min(column + outlierRadius, columns - 1); ++x) {
            const difference = Math.abs(before[y * columns + x]! - middle);
            known += Number(!Number.isNaN(difference));
            agreeing += Number(difference <= jump);
          }
        }
        if (3 * agreeing < known) disparities[row * columns + column] = NaN;
      }
    }
  }
}

/** Fills holes by the lines between opposite sides that agree, which is so within a thing. Of the four lines through a
 *  vertex, two have to: one alone may join two things. */
export function closeHoles(disparities: Float32Array, columns: number, rows: number, jump: number): void {
  const widest = Math.max(Math.round(columns / 6), 2);
  const sums = new Float32Array(disparities.length), weights = new Float32Array(disparities.length);
  const numLines = new Uint8Array(disparities.length);
  const fill = (column: number, row: number, right: number, down: number) => {
    let last = -1, lastValue = NaN, length = 0;
    for (let x = column, y = row; x >= 0 && x < columns && y < rows; x += right, y += down, ++length) {
      const value = disparities[y * columns + x]!;
      if (Number.isNaN(value)) continue;
      const gap = length - last;
      if (last >= 0 && gap > 1 && gap <= widest && Math.abs(value - lastValue) <= jump) {
        for (let k = 1; k < gap; ++k) {
          const at = (y - (gap - k) * down) * columns + x - (gap - k) * right;
          sums[at]! += (lastValue + (k / gap) * (value - lastValue)) / gap;
          weights[at]! += 1 / gap;
          ++numLines[at]!;
        }
      }
      [last, lastValue] = [length, value];
    }
  };
  for (let row = 0; row < rows; ++row) {
    fill(0, row, 1, 0);
    if (row > 0) fill(0, row, 1, 1);
    if (row > 0) fill(columns - 1, row, -1, 1);
  }
  for (let column = 0; column < columns; ++column) for (const right of [0, 1, -1]) fill(column, 0, right, 1);
  for (let i = 0; i < disparities.length; ++i) if (numLines[i]! > 1) disparities[i] = sums[i]! / weights[i]!;
}

/** Returns two triangles for each cell between four vertices, unless the surface is open or jumps there. Pieces of a few
 *  cells, which float before or behind everything, are left out. */
function trianglesOf(disparities: Float32Array, columns: number, rows: number, jump: number): Uint32Array {
  const isCell = new Uint8Array(columns * rows);
  for (let row = 0; row + 1 < rows; ++row) {
    for (let column = 0; column + 1 < columns; ++column) {
      const first = row * columns + column;
      const four = [disparities[first]!, disparities[first + 1]!, disparities[first + columns]!, disparities[first + columns + 1]!];
      isCell[first] = Number(Math.max(...four) - Math.min(...four) <= jump); // never with NaN
    }
  }
  dropPieces(isCell, columns, Math.max(Math.round(isCell.length / 1000), 1));
  const triangles = new Uint32Array(6 * isCell.length);
  let count = 0;
  isCell.forEach((is, first) => {
    if (!is) return;
    const below = first + columns;
    triangles.set([first, below, first + 1, below, below + 1, first + 1], count);
    count += 6;
  });
  return triangles.subarray(0, count);
}

/** Clears the connected pieces of fewer than `fewest` cells. */
function dropPieces(isCell: Uint8Array, columns: number, fewest: number): void {
  const isSeen = new Uint8Array(isCell.length);
  for (let start = 0; start < isCell.length; ++start) {
    if (!isCell[start] || isSeen[start]) continue;
    const piece = [start];
    isSeen[start] = 1;
    for (let i = 0; i < piece.length; ++i) {
      // The last column has no cells, so neighbours never wrap around.
      for (const next of [piece[i]! - 1, piece[i]! + 1, piece[i]! - columns, piece[i]! + columns]) {
        if (!isCell[next] || isSeen[next]) continue;
        isSeen[next] = 1;
        piece.push(next);
      }
    }
    if (piece.length < fewest) for (const cell of piece) isCell[cell] = 0;
  }
}
