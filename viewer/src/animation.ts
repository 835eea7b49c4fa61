// Films of the current view: the viewpoint or the focus moves along a path while frames are recorded.
import { context2d } from './dom';
import { GifWriter } from './gif';

export const framesPerSecond = 20;
export const numFrames = 48;
// The largest number of pixels of a film that a page should hold.
const mostPixels = 2 ** 28;

export interface Place {
  x: number; // viewpoint, in view steps from the middle of the grid
  y: number;
  focus: number; // px per view
}

export const paths: Record<string, string> = {
  orbit: 'around',
  sweep: 'from left to right',
  focus: 'from near to far',
};

/** Returns viewpoint and focus of frame `i` on a closed path. `range` is the range of the focus. */
export function placeOnPath(path: string, i: number, [rows, columns]: [number, number], now: Place, range: [number, number]): Place {
  const angle = (2 * Math.PI * i) / numFrames;
  const [reachX, reachY] = [(columns - 1) / 2, (rows - 1) / 2];
  switch (path) {
    case 'sweep': return { ...now, x: -reachX * Math.cos(angle), y: 0 };
    case 'focus': return { ...now, focus: range[0] + ((range[1] - range[0]) * (1 - Math.cos(angle))) / 2 };
    default: return { ...now, x: reachX * Math.sin(angle), y: -reachY * Math.cos(angle) };
  }
}

/** Paints frame `i` on the canvas that is recorded. */
type PaintFrame = (i: number) => void;

export async function recordGif(picture: HTMLCanvasElement, paint: PaintFrame): Promise<Blob> {
  paint(0);
  const { width, height } = picture;
  if (width * height * numFrames > mostPixels) throw new Error('The pictures are too large for a GIF; choose WebM.');
  const gif = new GifWriter(width, height, framesPerSecond);
  for (let i = 0; i < numFrames; ++i) {
    paint(i);
    gif.add(context2d(picture).getImageData(0, 0, width, height).data);
    await new Promise((resolve) => setTimeout(resolve)); // keeps the page responsive
  }
  return gif.finish();
}

const videoTypes: Record<string, string[]> = {
  webm: ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'],
  mp4: ['video/mp4;codecs=avc1.640028', 'video/mp4;codecs=vp9', 'video/mp4'],
};

/** Returns the first format of this browser for a file extension, webm or mp4. */
const videoType = (ending: string): string | undefined => videoTypes[ending]?.find((name) => window.MediaRecorder?.isTypeSupported(name));

/** Returns the file extensions of the films that this browser can record. */
export const videoEndings = (): string[] => Object.keys(videoTypes).filter(videoType);

/** Records with the recorder of the browser, which takes as long as the film. */
export async function recordVideo(ending: string, picture: HTMLCanvasElement, paint: PaintFrame): Promise<Blob> {
  const type = videoType(ending)!;
  paint(0);
  const stream = picture.captureStream(0);
  const track = stream.getVideoTracks()[0] as CanvasCaptureMediaStreamTrack;
  const recorder = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: 8_000_000 });
  const pieces: Blob[] = [];
  recorder.addEventListener('dataavailable', (event) => pieces.push(event.data));
  const ended = new Promise((resolve, reject) => {
    recorder.addEventListener('stop', resolve);
    recorder.addEventListener('error', () => reject(new Error('The browser stopped recording; choose GIF.')));
  });
  const started = new Promise((resolve) => recorder.addEventListener('start', resolve, { once: true }));
  recorder.start();
  // Frames before the start are lost. Some browsers report the start only with the first frame.
  await Promise.race([started, new Promise((resolve) => setTimeout(resolve, 500))]);
  for (let i = 0; i <= numFrames; ++i) {
    paint(i % numFrames);
    track.requestFrame();
    await new Promise((resolve) => setTimeout(resolve, 1000 / framesPerSecond));
  }
  recorder.stop();
  await ended;
  track.stop();
  return new Blob(pieces, { type: type.split(';')[0]! });
}
