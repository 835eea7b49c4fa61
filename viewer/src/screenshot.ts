// Saves the displayed pictures as PNG files, pixel for pixel, and films.

/** Lets the browser save a file. */
export function saveBlob(title: string, ending: string, blob: Blob): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = `${title.replace(/[^\w.-]+/g, '_')}-${ending}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

export async function pngOf(picture: HTMLCanvasElement): Promise<Blob> {
  const blob = await new Promise<Blob | null>((resolve) => picture.toBlob(resolve));
  if (!blob) throw new Error('The browser could not make a picture of this size.');
  return blob;
}

export async function savePictures(title: string, pictures: { name: string; canvas: HTMLCanvasElement }[]): Promise<number> {
  for (const { name, canvas } of pictures) {
    saveBlob(title, `${name}.png`, await pngOf(canvas));
  }
  return pictures.length;
}
