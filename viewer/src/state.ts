// The state of the page, which is stored in the URL after '#', so that a link shows the same.

const initial = {
  tab: 0,
  theme: 'system',
  // Light fields
  x: NaN, // viewpoint, in view steps from the middle of the grid, to the right; NaN until start() sets it
  y: NaN, // and downwards
  zoom: 1, // magnification of the whole picture
  panx: 0.5, // the middle of what is seen of it, shares of its size
  pany: 0.5,
  focus: 0, // disparity of the plane in focus, px per view step, in the middle of the picture
  tiltx: 0, // its change from the left edge to the right edge
  tilty: 0, // its change from the top edge to the bottom edge
  size: 0, // radius of the synthetic aperture, in view steps; 0 = one view
  shape: 'round',
  show: 'picture',
  turn: 0.4, // of the relief around the vertical axis, in radians
  tip: -0.3, // and around the horizontal one
  depth: 0.6, // of the relief, shares of its width
  gain: 1,
  gamma: 1,
  cycle: 0,
  row: -1, // position of the EPIs, px; -1 = in the middle
  column: -1,
  compare: 'side',
  split: 0.5, // of swipe, share of the width
  boost: 4, // of differences
  tone: 'stored', // of the second light field
  overlay: 0.5, // opacity of the disparity map
  sure: 0.05, // its pixels of a smaller confidence are left out
  path: 'orbit', // of films
  // Events
  image: 0, // transition
  limit: 0, // number of events with the full colour; 0 = automatic
  frame: 0,
  from: 0, // the displayed interval of time, in shares of the recording
  to: 1,
};

export type Values = typeof initial;
export type Key = keyof Values;

type Listener = (changed: Key) => void;

export class State {
  private defaults: Values = { ...initial };
  private values: Values = { ...initial };
  private listeners: Listener[] = [];
  private hashTimer = 0;

  constructor() {
    this.readHash();
    addEventListener('hashchange', () => {
      if (location.hash === this.hash()) return;
      this.values = { ...this.defaults };
      this.readHash();
      this.announce('tab');
    });
  }

  /** Sets defaults that depend on what is shown. What was changed or stands in the address stays. */
  start(defaults: Partial<Values>): void {
    const unchanged = Object.entries(defaults).filter(([key]) => Object.is(this.values[key as Key], this.defaults[key as Key]));
    Object.assign(this.defaults, defaults);
    Object.assign(this.values, Object.fromEntries(unchanged));
  }

  get<K extends Key>(key: K): Values[K] {
    return this.values[key];
  }

  set<K extends Key>(key: K, value: Values[K]): void {
    if (this.values[key] === value) return;
    this.values[key] = value;
    this.announce(key);
    // Browsers reject addresses that change too often.
    clearTimeout(this.hashTimer);
    this.hashTimer = window.setTimeout(() => history.replaceState(null, '', this.hash()), 200);
  }

  /** Resets everything to the defaults except for the tab and the theme. */
  reset(): void {
    const { tab, theme } = this.values;
    this.values = { ...this.defaults, tab, theme };
    history.replaceState(null, '', this.hash());
    this.announce('tab');
  }

  onChange(listener: Listener): void {
    this.listeners.push(listener);
  }

  private announce(key: Key): void {
    for (const listener of this.listeners) listener(key);
  }

  private hash(): string {
    const parts: string[] = [];
    for (const [key, value] of Object.entries(this.values)) {
      if (Object.is(value, this.defaults[key as Key])) continue;
      parts.push(`${key}=${typeof value === 'number' ? +value.toFixed(4) : value}`);
    }
    return `#${parts.join('&')}`;
  }

  /** Reads known keys with values of the right type. The code that uses a value limits it to its range. */
  private readHash(): void {
    for (const [key, text] of new URLSearchParams(location.hash.slice(1))) {
      if (!(key in initial)) continue;
      const isNumber = typeof initial[key as Key] === 'number';
      if (isNumber && (text === '' || !Number.isFinite(Number(text)))) continue;
      Object.assign(this.values, { [key]: isNumber ? Number(text) : text });
    }
  }
}
