// The histogram with the isovalue, and three slices through the proxy, on canvases.

const bins = 160;

export function rangeOf(samples) {
  let [minimum, maximum] = [Infinity, -Infinity];
  for (const v of samples) {
    if (v < minimum) minimum = v;
    if (v > maximum) maximum = v;
  }
  return { minimum, maximum };
}

/** Counts per bin, and Otsu's threshold between dark and bright. */
export function histogramOf({ samples, minimum, maximum }) {
  const counts = new Float64Array(bins);
  const scale = maximum > minimum ? (bins - 1e-9) / (maximum - minimum) : 0;
  for (let i = 0; i < samples.length; ++i) ++counts[Math.floor((samples[i] - minimum) * scale)];
  const all = counts.reduce((sum, n, i) => sum + n * i, 0);
  let [best, otsu, below, sum] = [-1, 0, 0, 0];
  for (let i = 0; i < bins - 1; ++i) {
    below += counts[i];
    sum += counts[i] * i;
    const above = samples.length - below;
    if (below === 0 || above === 0) continue;
    const between = below * above * (sum / below - (all - sum) / above) ** 2;
    if (between > best) [best, otsu] = [between, minimum + (i + 1) / (scale || 1)];
  }
  return { counts, minimum, maximum, otsu };
}

function sized(canvas, height) {
  const [w, h] = [Math.round(canvas.clientWidth * devicePixelRatio), Math.round(height * devicePixelRatio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, w, h);
  return [context, w, h];
}

/** `marks` are levels by name. */
export function drawHistogram(canvas, { counts, minimum, maximum }, level, marks) {
  const drawn = [canvas.clientWidth, minimum, maximum, counts[0], level, Object.values(marks)].join();
  if (canvas.dataset.drawn === drawn) return;
  canvas.dataset.drawn = drawn;
  const [context, w, h] = sized(canvas, 64);
  const top = Math.log1p(counts.reduce((most, n) => Math.max(most, n), 0));
  context.fillStyle = "#8899aa";
  counts.forEach((n, i) => {
    const tall = (h * Math.log1p(n)) / top;
    context.fillRect((i * w) / bins, h - tall, w / bins + 0.5, tall);
  });
  const at = (value) => ((value - minimum) / (maximum - minimum)) * w;
  context.fillStyle = context.strokeStyle = getComputedStyle(canvas).color;
  context.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
  context.setLineDash([3, 3]);
  for (const [name, value] of Object.entries(marks)) {
    context.beginPath();
    context.moveTo(at(value), 0);
    context.lineTo(at(value), h);
    context.stroke();
    context.fillText(name, at(value) + 4 * devicePixelRatio, 12 * devicePixelRatio);
  }
  context.fillStyle = "#f97316";
  context.fillRect(at(level) - 1, 0, 3, h);
}

/** Physical to index. */
function indexOf({ origin, spacing, direction }, point) {
  const d = point.map((v, i) => v - origin[i]);
  return [0, 1, 2].map((a) => (direction[a] * d[0] + direction[3 + a] * d[1] + direction[6 + a] * d[2]) / spacing[a]);
}

export function drawSlices(canvas, volume, scp) {
  const edge = Math.floor((canvas.clientWidth - 8) / 3);
  const { size, spacing, samples, minimum, maximum } = volume;
  const longest = Math.max(...size.map((n, a) => n * spacing[a]));
  const at = indexOf(volume, scp).map((v, a) => Math.max(0, Math.min(size[a] - 1, Math.round(v))));
  const drawn = [edge, volume.number, ...at].join();
  if (canvas.dataset.drawn === drawn) return;
  canvas.dataset.drawn = drawn;
  const [context, w] = sized(canvas, edge);
  canvas.style.height = `${edge}px`;
  const stride = [1, size[0], size[0] * size[1]];
  [[0, 1, 2], [0, 2, 1], [1, 2, 0]].forEach(([u, v, fixed], slice) => {
    const image = context.createImageData(size[u], size[v]);
    for (let y = 0, out = 0; y < size[v]; ++y) {
      const row = v === 2 ? size[v] - 1 - y : y; // head up
      for (let x = 0; x < size[u]; ++x, out += 4) {
        const value = samples[x * stride[u] + row * stride[v] + at[fixed] * stride[fixed]];
        image.data[out] = image.data[out + 1] = image.data[out + 2] = (255 * (value - minimum)) / (maximum - minimum);
        image.data[out + 3] = 255;
      }
    }
    const side = Math.floor((w - 8) / 3);
    const left = slice * (side + 4);
    const tile = new OffscreenCanvas(size[u], size[v]);
    tile.getContext("2d").putImageData(image, 0, 0);
    const [wide, tall] = [u, v].map((a) => (side * size[a] * spacing[a]) / longest);
    const [dx, dy] = [left + (side - wide) / 2, (side - tall) / 2];
    context.drawImage(tile, dx, dy, wide, tall);
    context.strokeStyle = "#f97316";
    context.beginPath();
    const y = ((v === 2 ? size[v] - 1 - at[v] : at[v]) + 0.5) / size[v];
    context.arc(dx + ((at[u] + 0.5) / size[u]) * wide, dy + y * tall, 4, 0, 7);
    context.stroke();
  });
}
