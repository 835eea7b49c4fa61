// Marks the stage (aria-busy) while it does not yet show the requested content.

let pending = 0;

function announce(): void {
  document.getElementById('stage')!.setAttribute('aria-busy', String(pending > 0));
}

/** Declares that work begins. Returns a function that declares its end, which may be called more than once. */
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
