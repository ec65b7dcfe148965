// Unpacks with what the browser has. Bytes in, bytes out.

/** `format` as DecompressionStream names it; more than `most` bytes are refused. */
export async function inflated(bytes, format, most = 2 ** 30) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format)).getReader();
  const parts = [];
  for (let size = 0; ;) {
    const { done, value } = await reader.read().catch(() => {
      throw new Error("the compressed data is damaged, or has several parts; copy it again, or unpack it first");
    });
    if (done) return new Uint8Array(await new Blob(parts).arrayBuffer());
    parts.push(value);
    size += value.length;
    if (size > most) {
      reader.cancel().catch(() => {});
      throw new Error(`data unpack to more than the ${most} bytes that were expected: the file is damaged, or too large for a page`);
    }
  }
}
