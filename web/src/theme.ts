// Light or dark: the system's choice until the reader makes one.

type Listener = () => void;
const listeners: Listener[] = [];

export function onThemeChange(listener: Listener): void {
  listeners.push(listener);
}

function apply(dark: boolean): void {
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
  for (const listener of listeners) listener();
}

export function themeButton(button: HTMLButtonElement): void {
  const system = matchMedia('(prefers-color-scheme: dark)');
  let chosen = false;
  const label = () => {
    const dark = document.documentElement.dataset.theme === 'dark';
    button.textContent = dark ? 'Light' : 'Dark';
    button.setAttribute('aria-label', dark ? 'Switch to the light theme' : 'Switch to the dark theme');
  };
  apply(system.matches);
  label();
  system.addEventListener('change', () => {
    if (chosen) return;
    apply(system.matches);
    label();
  });
  button.addEventListener('click', () => {
    chosen = true;
    apply(document.documentElement.dataset.theme !== 'dark');
    label();
  });
}
