// Saves what is shown as PNG files, pixel for pixel.
export async function savePictures(title: string, pictures: { name: string; canvas: HTMLCanvasElement }[]): Promise<number> {
  for (const { name, canvas } of pictures) {
    const blob = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve));
    if (!blob) throw new Error('The browser could not make a picture of this size.');
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = `${title.replace(/[^\w.-]+/g, '_')}-${name}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  }
  return pictures.length;
}
