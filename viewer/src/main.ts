// Starts the page: the tabs, the current screen and the keys.
import { busy } from './busy';
import { isLivePage, openSource, type Item, type Source } from './document';
import { element, Panel } from './dom';
import { followGrowth } from './growth';
import { showHelp } from './help';
import { Painter } from './painter';
import type { Context, Screen } from './screen';
import { savePictures } from './screenshot';
import { EventsScreen } from './screens/events';
import { LightFieldScreen } from './screens/light_field';
import { LiveFieldScreen } from './screens/live_field';
import { LiveSetupScreen } from './screens/live_setup';
import { ModelScreen } from './screens/model';
import { RecordingScreen } from './screens/recording';
import { State } from './state';
import { applyTheme, themes } from './theme';

interface Tab {
  name: string;
  of: string; // the name of its first item
  isGone?: boolean; // another page has replaced what it shows
  open(context: Context): Screen;
}

const byId = (id: string): HTMLElement => document.getElementById(id)!;

function openItem(context: Context, item: Item): Screen {
  switch (item.kind) {
    case 'live_setup': return new LiveSetupScreen(context, item);
    case 'live_field': return new LiveFieldScreen(context, item);
    case 'light_field': return new LightFieldScreen(context, item);
    case 'event_images': return new EventsScreen(context, item);
    case 'recording': return new RecordingScreen(context, item);
    case 'model': return new ModelScreen(context, item);
  }
}

const numLiveTabs = 2;

/** Lists comparisons first, because they are the purpose of a page with two light fields. */
function makeTabs(document: Source['document']): Tab[] {
  const { items, comparisons } = document;
  const compared = comparisons.map((figures): Tab | null => {
    const [first, second] = [items[figures.first], items[figures.second]];
    if (first?.kind !== 'light_field' || second?.kind !== 'light_field') return null;
    return { name: `${first.name} and ${second.name}`, of: first.name, open: (context) => new LightFieldScreen(context, first, { item: second, figures }) };
  });
  const single = items.map((item): Tab => ({ name: item.name, of: item.name, open: (context) => openItem(context, item) }));
  const live = single.splice(0, isLivePage(document) ? numLiveTabs : 0);
  return [...live, ...compared.filter((tab) => tab !== null), ...single];
}

class Page {
  private readonly state = new State();
  private tabs: Tab[];
  private screen: Screen | null = null;
  private panel: Panel | null = null;
  private opened = -1;
  private wanted = ''; // the item to go to when it comes

  constructor(private readonly source: Source, private readonly painter: Painter) {
    this.tabs = makeTabs(source.document);
    this.addHeader();
    applyTheme(this.state);
    this.state.onChange((key) => {
      if (key === 'theme' || key === 'tab') applyTheme(this.state);
      if (key === 'tab' && this.chosen() !== this.opened) return this.open();
      this.panel?.follow();
      this.screen?.follow(key);
    });
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.screen?.follow('theme'));
    new ResizeObserver(() => this.screen?.layout()).observe(byId('stage'));
    addEventListener('keydown', (event) => this.press(event));
    this.open();
  }

  grow(): void {
    const tabs = makeTabs(this.source.document);
    const isSame = tabs.length === this.tabs.length && tabs.every(({ name }, i) => name === this.tabs[i]!.name);
    if (isSame) this.panel?.follow();
    else this.replaceTabs(tabs);
    this.goTo(this.wanted);
  }

  /** What is open stays, also where another page has replaced it, unless that comes too early for all of its parts. */
  private replaceTabs(tabs: Tab[]): void {
    const open = this.tabs[this.opened]!;
    const place = tabs.findIndex(({ name }) => name === open.name);
    const isLost = place < 0 && this.screen?.isLoading?.() === true;
    this.tabs = place < 0 && !isLost ? [...tabs, { ...open, isGone: true }] : tabs;
    this.opened = isLost ? -1 : place < 0 ? tabs.length : place;
    this.addTabs();
    this.show(isLost ? numLiveTabs - 1 : this.opened);
  }

  private goTo(name: string): void {
    const place = this.tabs.findIndex(({ of, isGone }) => of === name && !isGone);
    this.wanted = place < 0 ? name : '';
    if (place >= 0) this.show(place);
  }

  private show(tab: number): void {
    this.state.set('tab', tab);
    if (tab !== this.opened) this.open();
  }

  private chosen(): number {
    return Math.min(Math.max(Math.round(this.state.get('tab')), 0), this.tabs.length - 1);
  }

  private addTabs(): void {
    byId('tabs').replaceChildren(...this.tabs.map(({ name }, i) => {
      const button = element('button', { type: 'button', role: 'tab', title: name }, name);
      button.addEventListener('click', () => this.show(i));
      return button;
    }));
    this.markTab();
  }

  private markTab(): void {
    [...byId('tabs').children].forEach((button, i) => button.setAttribute('aria-selected', String(i === this.opened)));
    byId('tabs').children[this.opened]?.scrollIntoView({ block: 'nearest', inline: 'nearest' });
  }

  private addHeader(): void {
    this.addTabs();
    const actions: [string, string, () => void][] = [
      ['Save', 'Save the picture as PNG', () => this.save()],
      ['Theme', 'Dark or light', () => this.nextTheme()],
      ['Keys', 'Show the keys', () => showHelp(this.screen?.keys ?? [])],
    ];
    for (const [text, label, action] of actions) {
      const button = element('button', { type: 'button', 'aria-label': label, title: label }, text);
      button.addEventListener('click', action);
      byId('actions').append(button);
    }
  }

  private open(): void {
    this.screen?.close();
    this.opened = this.chosen();
    const tab = this.tabs[this.opened]!;
    document.title = `${tab.name} - e2lf`;
    const stays = this.tabs.filter(({ isGone }) => !isGone || tab.isGone);
    if (stays.length < this.tabs.length) {
      this.tabs = stays;
      this.addTabs();
    }
    this.markTab();
    const stage = byId('stage');
    stage.replaceChildren();
    const end = busy();
    this.panel = new Panel(byId('controls'), this.state);
    const { source, painter, state, panel } = this;
    this.screen = tab.open({ document: source.document, source, painter, state, panel, stage, say, fail, goTo: (name) => this.goTo(name) });
    this.panel.follow();
    this.screen.layout();
    this.screen.follow('tab');
    end();
  }

  private nextTheme(): void {
    const next = (themes.indexOf(this.state.get('theme')) + 1) % themes.length;
    this.state.set('theme', themes[next]!);
    say(`colours: ${themes[next]}`);
  }

  private save(): void {
    const pictures = this.screen?.pictures() ?? [];
    savePictures(this.tabs[this.opened]!.name, pictures).then((count) => say(`${count} saved`)).catch(fail);
  }

  private press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey || document.querySelector('dialog[open]')) return;
    // Sliders and lists handle arrows and letters themselves.
    const isArrow = event.key.startsWith('Arrow');
    if (event.target instanceof HTMLSelectElement || (event.target instanceof HTMLInputElement && isArrow)) return;
    if (event.target instanceof HTMLButtonElement && event.key === ' ') return;
    if (this.screen?.press(event.shiftKey && isArrow ? `Shift+${event.key}` : event.key)) return event.preventDefault();
    if (event.key === '?') showHelp(this.screen?.keys ?? []);
    else if (event.key === 's') this.save();
    else if (event.key === 't') this.nextTheme();
    else if (/^[1-9]$/.test(event.key) && Number(event.key) <= this.tabs.length) this.show(Number(event.key) - 1);
  }
}

function say(text: string): void {
  byId('status').textContent = text;
}

function fail(error: unknown): void {
  const text = error instanceof Error ? error.message : String(error);
  byId('stage').replaceChildren(element('p', { role: 'alert', class: 'error' }, text));
}

async function start(): Promise<void> {
  const source = await openSource();
  const open = () => (source.document.items.length > 0 ? new Page(source, new Painter()) : null);
  let page = open();
  if (!page && !source.document.is_growing) throw new Error('There is nothing to show.');
  if (!page) {
    byId('stage').replaceChildren(element('p', { role: 'status' }, 'Waiting for the first cycle.'));
    document.title = 'waiting - e2lf';
  }
  const grow = () => (page ? page.grow() : (page = open()));
  followGrowth(source, grow).then(() => {
    if (!page) throw new Error('The recording has ended without a cycle.');
  }).catch((error) => (page ? say('Nothing more will come: e2lf has ended.') : fail(error)));
}

start().catch(fail);
