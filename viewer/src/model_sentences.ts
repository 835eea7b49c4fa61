// What the facts of `e2lf model info` say about a model, in sentences.

/** Names of facts and their values, as `e2lf model info` prints them. */
export type Facts = [name: string, value: string][];

const counted = (count: number, noun: string): string => `${count} ${noun}${count === 1 ? '' : 's'}`;
const large = (value: string | undefined): string => Math.round(Number(value)).toLocaleString('en');
const decibels = (loss: string): string => (Number(loss) > 0 ? `costs ${Number(loss).toFixed(3)} dB` : 'costs nothing');

const inputs: Record<string, string> = {
  counts: 'the event counts of each change of the pattern',
  cumulative: 'their cumulative sums',
  level: 'these sums with half an event of the last sign',
  intensity: 'the coded intensities that follow from them',
  camera: 'the constants of the camera',
  images: 'an intensity image of each pattern',
  'image-sum': 'one intensity image of all patterns',
  'lens-array': 'the views of a lens array',
};

/** Returns the subjects and the sentences about them. */
export function sentencesOf(all: Facts, isOfDepth: boolean): [subject: string, sentence: string][] {
  const facts = new Map(all);
  const of = (name: string) => facts.get(name);
  const numbered = (name: string) => all.filter(([key]) => new RegExp(`^${name} \\d+ kind$|^${name} kind$`).test(key)).map(([, value]) => inputs[value] ?? value);
  const sentences: [string, string | undefined][] = [
    ['Output', outputOf(of, isOfDepth)],
    ['Patterns', of('num patterns') && `${counted(Number(of('num patterns')), 'pattern')} of ${of('views y')}x${of('views x')} views${of('black first') === 'yes' ? ', of which the first one is black' : ''}. ${patternsOf(of)}`],
    ['Inputs', numbered('input').length > 0 ? `The network receives ${joined(numbered('input'))}.` : undefined],
    ['Camera', cameraOf(of)],
    ['Network', of('network parameters') && `${large(of('network parameters'))} parameters in ${of('network layers')} layers. Each pixel of the sensor takes ${large(of('network macs per pixel'))} multiply-adds and depends on ${of('network receptive field px')} px around it.`],
    ['Precision', of('precision loss bfloat16 db') && `Computing in bfloat16 ${decibels(of('precision loss bfloat16 db')!)}${of('precision loss int16 db') ? `, in int16 it ${decibels(of('precision loss int16 db')!)}` : ''}.`],
    ['Training', of('provenance samples') && `${large(of('provenance samples'))} samples in ${large(of('provenance steps'))} steps.`],
  ];
  return sentences.filter((row): row is [string, string] => Boolean(row[1]));
}

function joined(parts: string[]): string {
  return parts.length < 2 ? parts.join() : `${parts.slice(0, -1).join(', ')} and ${parts.at(-1)}`;
}

type Get = (name: string) => string | undefined;

function outputOf(of: Get, isOfDepth: boolean): string | undefined {
  if (isOfDepth) return 'The disparity of each pixel of the middle view, with its uncertainty.';
  const [rows, columns] = [of('views y'), of('views x')];
  return rows && columns && `A light field of ${rows}x${columns} views at the resolution of the sensor.`;
}

function patternsOf(of: Get): string {
  const open = of('codes light efficiency')?.split(', ').map(Number);
  if (!open) return 'It contains none, because they belong to a camera.';
  const percent = (share: number) => `${(100 * share).toFixed(0)} %`;
  return `They open ${percent(Math.min(...open))} to ${percent(Math.max(...open))} of the aperture${of('codes binary') === 'yes' ? ', and each cell is open or closed' : ''}.`;
}

function cameraOf(of: Get): string | undefined {
  const name = of('camera name');
  if (name) return `It takes the constants of the camera, and was trained around ${name}.`;
  if (!of('constants tau')) return undefined;
  return `It expects the event model ${of('event model')} with a contrast threshold of ${of('constants tau')}, a dark level of ${of('constants eps')}, and noise of ${of('constants sigma w')} (intensity) and ${of('constants sigma z')} (threshold).`;
}
