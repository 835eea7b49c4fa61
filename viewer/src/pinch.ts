// Gestures of two fingers on an element, which a browser reports as two pointers.

interface Place {
  x: number;
  y: number;
}

interface Fingers {
  apart: number; // px
  middle: Place; // shares of the element's size
}

/** Calls `onMove` with the factor by which the distance of the fingers grew since the last call, the position of their
 *  middle, and its motion, both in shares of the element's size. Returns a function that is true during a gesture: from
 *  the touch of the second finger until both are lifted. */
export function followPinch(target: HTMLElement, onMove: (factor: number, middle: Place, moved: Place) => void): () => boolean {
  const places = new Map<number, Place>();
  let last: Fingers | null = null;
  let isPinching = false;
  const measure = (): Fingers | null => {
    const [first, second] = [...places.values()];
    if (!first || !second) return null;
    const box = target.getBoundingClientRect();
    const middle = { x: ((first.x + second.x) / 2 - box.left) / box.width, y: ((first.y + second.y) / 2 - box.top) / box.height };
    return { apart: Math.max(Math.hypot(first.x - second.x, first.y - second.y), 1), middle };
  };
  target.addEventListener('pointerdown', (event) => {
    if (event.pointerType !== 'touch') return;
    places.set(event.pointerId, { x: event.clientX, y: event.clientY });
    isPinching ||= places.size > 1;
    last = measure();
  });
  target.addEventListener('pointermove', (event) => {
    if (!places.has(event.pointerId)) return;
    places.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const now = measure();
    if (now && last) onMove(now.apart / last.apart, now.middle, { x: now.middle.x - last.middle.x, y: now.middle.y - last.middle.y });
    last = now;
  });
  for (const name of ['pointerup', 'pointercancel'] as const) {
    target.addEventListener(name, (event) => {
      places.delete(event.pointerId);
      last = measure();
      if (places.size === 0) isPinching = false;
    });
  }
  return () => isPinching;
}
