// The settings of a camera that can change while it runs: a slider for each number, a field for its regions.
import { element } from './dom';
import { command, countText, SettingControl, type CameraControl } from './live';

const rateText = (value: string): string => (value === '0' ? 'no limit' : `${countText(Number(value))} per s`);

export class CameraControls {
  readonly root = element('div');
  private controls = new Map<string, SettingControl<HTMLInputElement>>();

  constructor(private readonly say: (text: string) => void) {}

  /** Shows the settings as the camera has them. */
  show(settings: CameraControl[]): void {
    if (settings.length !== this.controls.size) this.build(settings);
    for (const { name, value } of settings) this.controls.get(name)?.show(value);
  }

  private build(settings: CameraControl[]): void {
    this.controls = new Map(settings.map((setting) => [setting.name, this.control(setting)]));
    this.root.replaceChildren(...settings.map(({ name, least, most }) => {
      const { control } = this.controls.get(name)!;
      const output = element('output');
      const show = (value: string) => (output.textContent = name === 'max-event-rate' ? rateText(value) : value);
      control.addEventListener('input', () => show(control.value));
      this.controls.get(name)!.onShow = show;
      return element('label', { class: least < most ? 'slider' : 'choice' }, element('span', {}, name), control, ...(least < most ? [output] : []));
    }));
  }

  private control({ name, least, most }: CameraControl): SettingControl<HTMLInputElement> {
    const range = { type: 'range', min: String(least), max: String(most), step: String(Math.max(1, Math.round((most - least) / 400))) };
    const input = element('input', { ...(least < most ? range : { type: 'text', size: '16' }), name, 'aria-label': name });
    return new SettingControl(input, (value) => {
      command(`camera?name=${encodeURIComponent(name)}&value=${encodeURIComponent(value)}`).catch((error: Error) => this.say(error.message));
    });
  }
}
