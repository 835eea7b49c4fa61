// The requests to the server of `e2lf live`, which src/e2lf/live/live_requests.h describes.
import { fetchFile } from './document';
import { context2d, element } from './dom';

/** What may be wrong with the rig. */
export interface Finding {
  code: string;
  severity: 'note' | 'warning' | 'error';
  message: string;
  remedy: string;
  option: string; // its name as in "sensor_width"; empty if there is none
}

export interface Statistics {
  network: string;
  size: string;
  size_choice: string;
  average: number;
  fuse: number; // largest number of cycles in the mean of a pixel; 0 = not possible
  is_fusing: boolean;
  fuse_obstacle: string; // why it is not possible
  has_ended: boolean;
  error: string | null;
  cycles: number;
  fields: number;
  skipped_cycles: number;
  late_cycles: number; // of those that were skipped
  latency_s: { median: number; p90: number };
  events: number;
  events_per_s: number;
  on_share: number;
  triggers: Record<string, number>;
  triggers_per_s: Record<string, number>;
  schedule: { patterns: number; cycle_us: number };
  found: string;
  findings: Finding[];
  confidence: number;
  least_confidence: number;
  dropped_cycles: Record<string, number>;
  event_delay_us: number | null;
  silenced_pixels: number;
  left_out: Record<string, number>;
  may_have_lost_events: boolean;
  sensor_dropped_share?: number;
  recording: { can_record: boolean; is_recording: boolean; file: string; bytes: number; error: string };
  camera?: CameraControl[];
  has_depth: boolean; // a network estimates disparities: askForPicture('depth')
  is_refining: boolean;
  refining_error: string;
}

/** A setting of the camera that can change while it runs. */
export interface CameraControl {
  name: string;
  value: string;
  least: number; // range of a number; equal = text
  most: number;
}

/** A JSON header and the grey pixels after it. */
export interface Framed<Header> {
  header: Header;
  pixels: Uint8Array;
}

/** Requests pictures; returns null if there is none yet. */
export async function askForPicture<Header>(path: string): Promise<Framed<Header> | null> {
  const answer = await fetchFile(path);
  if (answer.status === 204) return null;
  const bytes = await answer.arrayBuffer();
  const length = new DataView(bytes).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length))) as Header;
  return { header, pixels: new Uint8Array(bytes, 4 + length) };
}

export async function askForStatistics(): Promise<Statistics> {
  return (await fetchFile('statistics')).json() as Promise<Statistics>;
}

/** Tells the server to do something. Fails with its reason. */
export async function command(path: string): Promise<{ name?: string }> {
  const answer = await fetch(path, { method: 'POST' }).catch(() => null);
  if (!answer) throw new Error('The server does not answer; is e2lf still running?');
  if (!answer.ok) throw new Error(await answer.text());
  return answer.json() as Promise<{ name?: string }>;
}

/** A control of a setting that the server keeps. It takes a value over when that has changed there, so that it does not
 *  move under the hand of whoever uses it. */
export class SettingControl<Control extends HTMLInputElement | HTMLSelectElement> {
  onShow: (value: string) => void = () => {};
  private known: string | null = null;

  constructor(readonly control: Control, tell: (value: string) => void) {
    control.addEventListener('change', () => tell(control.value));
  }

  show(value: string): void {
    if (value === this.known) return;
    this.control.value = this.known = value;
    this.onShow(value);
  }
}

export function drawGrey(canvas: HTMLCanvasElement, width: number, height: number, grey: Uint8Array): void {
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  if (width === 0 || height === 0) return;
  const image = new ImageData(width, height);
  const pixels = new Uint32Array(image.data.buffer);
  for (let i = 0; i < pixels.length; ++i) pixels[i] = 0xff000000 | (grey[i]! * 0x010101);
  context2d(canvas).putImageData(image, 0, 0);
}

/** Draws the pixels that lie in a part of a picture, given in shares of its size. */
export function drawPart(canvas: HTMLCanvasElement, width: number, height: number, grey: Uint8Array, part: { x: number; y: number; width: number; height: number }): void {
  const [left, top] = [Math.floor(part.x * width), Math.floor(part.y * height)];
  const [right, bottom] = [Math.min(Math.ceil((part.x + part.width) * width), width), Math.min(Math.ceil((part.y + part.height) * height), height)];
  const rows = Array.from({ length: bottom - top }, (_, y) => grey.subarray((top + y) * width + left, (top + y) * width + right));
  const pixels = new Uint8Array((right - left) * rows.length);
  rows.forEach((row, y) => pixels.set(row, y * (right - left)));
  drawGrey(canvas, right - left, rows.length, pixels);
}

export const rest = (ms: number): Promise<void> => new Promise((resolve) => setTimeout(resolve, ms));

/** The findings with their remedies, the options spelled as on the command line. */
export class FindingList {
  readonly root = element('ul', { class: 'findings', role: 'status' });
  private shown = '';

  show(findings: Finding[]): void {
    const text = JSON.stringify(findings);
    if (text === this.shown) return; // screen readers announce changes
    this.shown = text;
    this.root.replaceChildren(...findings.map(({ code, severity, message, remedy, option }) => element('li', { class: `is-${severity}` },
      element('b', {}, code), ` ${message}: ${remedy}${option && ` (--${option.replaceAll('_', '-')})`}`)));
  }
}

export function countText(value: number): string {
  if (value >= 1e6) return `${(value / 1e6).toFixed(2)} M`;
  return value >= 1e4 ? `${(value / 1e3).toFixed(1)} k` : value.toFixed(value < 10 && value % 1 !== 0 ? 2 : 0);
}

/** Calls `follow` with the statistics twice a second until `isOver` returns true. */
export async function followStatistics(isOver: () => boolean, follow: (now: Statistics) => void): Promise<void> {
  while (!isOver()) {
    const now = await askForStatistics();
    if (!isOver()) follow(now);
    await rest(500);
  }
}
