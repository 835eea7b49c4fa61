// The content of the page: a description in JSON, and numbered parts (pictures, counts) that it refers to. Both are
// embedded in an exported page; a served page fetches them from the server. src/e2lf/view/document.h writes them.

export interface Codes {
  views: [number, number]; // rows, columns
  patterns: number[][]; // [pattern][view number], transmittance in 0..1
}

export interface LightFieldCycle {
  label: string;
  note?: string; // shown beside the label
  views: number[]; // the part of each view, in view order: an 8-bit PNG
}

export interface LightFieldItem {
  kind: 'light_field';
  name: string;
  views: [number, number]; // rows, columns
  height: number;
  width: number;
  channels: 1 | 3;
  cycles: LightFieldCycle[];
  disparity?: Disparity;
}

export interface Disparity {
  view: [number, number]; // row, column: the view whose pixels they are
  range: [number, number]; // nearest and farthest, px per view
  maps: number[]; // the part of each cycle, or one for all: int16 [y, x], deflated, in thousandths of a px per view; -32768 = unknown
  confidences?: number[]; // the parts of the confidences of the same pixels: int16 [y, x], deflated, in thousandths
}

export interface EventImagesItem {
  kind: 'event_images';
  name: string;
  transitions: number;
  height: number;
  width: number;
  cycles: { label: string; counts: number }[]; // the part with int16 [transition, y, x], deflated
  codes?: Codes;
}

export interface RecordingItem {
  kind: 'recording';
  name: string;
  format: string;
  height: number;
  width: number;
  events: number;
  origin_us: number; // of all times below, in the recording's clock
  frames: { begin_us: number; end_us: number; counts: number }[]; // the part with int16 [y, x], deflated
  rate: { begin_us: number; bin_us: number; on: number[]; off: number[] };
  triggers: [time_us: number, polarity: number, input: number][];
  cycles: { number: number; confidence: number; slices: [begin_us: number, end_us: number][] }[];
}

export interface ModelItem {
  kind: 'model';
  name: string;
  facts: [string, string][]; // the rows of `e2lf model info`
  is_of_depth: boolean; // its output is the disparity of one view
  codes?: Codes;
}

/** The tabs of `e2lf live`: the light fields, and the figures of the source. */
export interface LiveItem {
  kind: 'live_setup' | 'live_field';
  name: string;
  views: [number, number]; // rows, columns
  height: number; // of the sensor, px
  width: number;
}

export type Item = LiveItem | LightFieldItem | EventImagesItem | RecordingItem | ModelItem;

export interface Comparison {
  first: number; // the truth, and the reconstruction: numbers of items
  second: number;
  cycles: Quality[];
}

/** The figures of a reconstruction, as `e2lf eval` computes them. */
export interface Quality {
  psnr_db: (number | null)[]; // of each view; null = equal
  tone: [gain: number, black: number]; // (value - black) * gain is most similar to the truth
  toned_psnr_db: (number | null)[]; // with this tone
  disparity?: DisparityError;
}

export interface DisparityError {
  source: string; // of the true disparities
  bad_07_percent: number; // off by more than 0.07 px per view
  bad_20_percent: number; // off by more than 0.2 px per view
  mean_absolute_px: number;
  slope: number; // of the regression on the truth
}

export interface ViewDocument {
  format: 'e2lf-view';
  version: 1;
  items: Item[];
  comparisons: Comparison[];
  is_growing?: boolean | undefined; // of e2lf live: items may be added, growth.ts
}

/** Returns true for the page of `e2lf live`. */
export const isLivePage = ({ items }: ViewDocument): boolean => items[0]?.kind === 'live_setup';

/** The origin of the description and the parts. */
export interface Source {
  document: ViewDocument;
  part(number: number): Promise<Blob>;
}

export async function openSource(): Promise<Source> {
  const embedded = document.getElementById('e2lf-document');
  const text = embedded ? embedded.textContent! : await (await fetchFile('document.json')).text();
  return { document: checked(JSON.parse(text)), part: embedded ? embeddedPart : servedPart };
}

function checked(description: ViewDocument): ViewDocument {
  if (description.format !== 'e2lf-view' || description.version !== 1) {
    throw new Error('The data have a version that this page cannot read; make the page again with e2lf view.');
  }
  return description;
}

export async function fetchFile(path: string): Promise<Response> {
  const answer = await fetch(path).catch(() => null);
  if (!answer) throw new Error('The server does not answer; is e2lf still running?');
  if (!answer.ok) throw new Error(await answer.text());
  return answer;
}

async function servedPart(number: number): Promise<Blob> {
  return (await fetchFile(`part/${number}`)).blob();
}

async function embeddedPart(number: number): Promise<Blob> {
  const text = document.getElementById(`e2lf-part-${number}`)?.textContent;
  if (!text) throw new Error(`Part ${number} of the page is missing; make the page again with e2lf view.`);
  return (await fetch(`data:application/octet-stream;base64,${text}`)).blob();
}

/** Returns the int16 numbers of a deflated part. */
export async function inflateCounts(part: Blob): Promise<Int16Array> {
  const stream = part.stream().pipeThrough(new DecompressionStream('deflate'));
  return new Int16Array(await new Response(stream).arrayBuffer());
}
