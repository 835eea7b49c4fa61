// Says on the stage (aria-busy) that what is shown is not yet what was asked for.

let pending = 0;

function announce(): void {
  document.getElementById('stage')!.setAttribute('aria-busy', String(pending > 0));
}

/** To be called when work begins; what it returns is called when it ends, and may be called more than once. */
export function busy(): () => void {
  let isOver = false;
  ++pending;
  announce();
  return () => {
    if (isOver) return;
    isOver = true;
    --pending;
    announce();
  };
}
