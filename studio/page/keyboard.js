// The keys of the page; those of a control in focus stay its own.

const is_text = (element) => element.matches('input:not([type="range"]):not([type="checkbox"]), select');

// shape_key(event): whether the shape took the key; commands: by key, with Ctrl or ⌘; actions: by key. `on_space()`: the key was pressed and nothing
// was dragged meanwhile.
export function listen({ editor, stage, shape_key, commands, actions, on_space, on_escape }) {
  let space_used = false;
  document.addEventListener('keydown', (event) => {
    if (document.querySelector('dialog[open]')) return;
    const typing = is_text(event.target);
    if (event.ctrlKey || event.metaKey) {
      const command = typing ? null : commands[(event.shiftKey ? 'shift ' : '') + event.key.toLowerCase()];
      if (command) {
        event.preventDefault();
        command();
      }
      return;
    }
    if ((event.altKey && !event.key.startsWith('Arrow')) || typing) return;
    if (event.key === 'Escape') return on_escape();
    const on_control = event.target.matches('button, input, summary');
    if (event.key === ' ') {
      if (on_control) return;
      event.preventDefault();
      if (!event.repeat) {
        editor.space = true;
        space_used = false;
      }
      return;
    }
    if (!(on_control && event.key.startsWith('Arrow')) && shape_key(event)) return event.preventDefault();
    const act = actions[event.key] ?? actions[event.key.toLowerCase()];
    if (act) {
      event.preventDefault();
      act();
    }
  });
  stage.addEventListener('pointerdown', () => (space_used = true));
  document.addEventListener('keyup', (event) => {
    if (event.key !== ' ' || !editor.space) return;
    editor.space = false;
    if (!space_used) on_space();
  });
  addEventListener('blur', () => (editor.space = false));

  // A group of which one is chosen is one stop of the Tab key; arrows choose within.
  for (const group of document.querySelectorAll('[role="radiogroup"]')) {
    group.addEventListener('keydown', (event) => {
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      event.stopPropagation();
      const buttons = [...group.querySelectorAll('[role="radio"]')];
      const next = buttons[(buttons.indexOf(document.activeElement) + step + buttons.length) % buttons.length];
      next.click();
      next.focus();
    });
  }
}
