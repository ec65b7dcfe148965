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

const orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/** An axial, a coronal and a sagittal slice as radiologists look at them (directions in LPS). For each: the axes of the
 * grid across and down, whether they are flipped, the axis that is fixed, and what to write left, right, above and below. */
export function viewsOf({ direction, oriented }) {
  const along = (order) => order.reduce((sum, axis, row) => sum + Math.abs(direction[3 * row + axis]), 0);
  const axes = orders.reduce((best, one) => (along(one) > along(best) + 1e-6 ? one : best));
  const ends = oriented ? [["R", "L"], ["A", "P"], ["I", "S"]] : [["", "x"], ["", "y"], ["", "z"]];
  return [[0, 1, 1], [0, 2, -1], [1, 2, -1]].map(([right, down, way]) => ({ // head up
    u: axes[right], v: axes[down], fixed: axes[3 - right - down],
    flipU: direction[3 * right + axes[right]] < 0, flipV: way * direction[3 * down + axes[down]] < 0,
    letters: [...ends[right], ...(way > 0 ? ends[down] : [...ends[down]].reverse())],
  }));
}

/** The samples of a view through a place of the grid, row by row from above. */
export function sliceOf({ size, samples }, { u, v, fixed, flipU, flipV }, at) {
  const stride = [1, size[0], size[0] * size[1]];
  const [right, down] = [flipU ? -stride[u] : stride[u], flipV ? -stride[v] : stride[v]];
  const slice = new Float32Array(size[u] * size[v]);
  const begin = at[fixed] * stride[fixed] + (flipU ? size[u] - 1 : 0) * stride[u] + (flipV ? size[v] - 1 : 0) * stride[v];
  for (let y = 0, to = 0; y < size[v]; ++y) {
    for (let x = 0, from = begin + y * down; x < size[u]; ++x, from += right) slice[to++] = samples[from];
  }
  return slice;
}

export function drawSlices(canvas, volume, scp) {
  const edge = Math.floor((canvas.clientWidth - 8) / 3);
  const { size, spacing, minimum, maximum } = volume;
  const longest = Math.max(...size.map((n, a) => n * spacing[a]));
  const at = indexOf(volume, scp).map((v, a) => Math.max(0, Math.min(size[a] - 1, Math.round(v))));
  const drawn = [edge, volume.number, ...at].join();
  if (canvas.dataset.drawn === drawn) return;
  canvas.dataset.drawn = drawn;
  const [context, w] = sized(canvas, edge);
  canvas.style.height = `${edge}px`;
  const side = Math.floor((w - 8) / 3);
  const margin = 14 * devicePixelRatio; // for letters
  context.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
  [context.textAlign, context.textBaseline] = ["center", "middle"];
  viewsOf(volume).forEach((view, slice) => {
    const { u, v, flipU, flipV, letters } = view;
    const image = context.createImageData(size[u], size[v]);
    sliceOf(volume, view, at).forEach((value, i) => {
      image.data[4 * i] = image.data[4 * i + 1] = image.data[4 * i + 2] = (255 * (value - minimum)) / (maximum - minimum);
      image.data[4 * i + 3] = 255;
    });
    const tile = new OffscreenCanvas(size[u], size[v]);
    tile.getContext("2d").putImageData(image, 0, 0);
    const [wide, tall] = [u, v].map((a) => ((side - 2 * margin) * size[a] * spacing[a]) / longest);
    const [dx, dy] = [slice * (side + 4) + (side - wide) / 2, (side - tall) / 2];
    context.drawImage(tile, dx, dy, wide, tall);
    context.strokeStyle = "#f97316";
    context.beginPath();
    const place = (a, flipped) => ((flipped ? size[a] - 1 - at[a] : at[a]) + 0.5) / size[a];
    context.arc(dx + place(u, flipU) * wide, dy + place(v, flipV) * tall, 4, 0, 7);
    context.stroke();
    context.fillStyle = getComputedStyle(canvas).color;
    const ends = [[dx - margin / 2, dy + tall / 2], [dx + wide + margin / 2, dy + tall / 2], [dx + wide / 2, dy - margin / 2], [dx + wide / 2, dy + tall + margin / 2]];
    ends.forEach(([x, y], i) => context.fillText(letters[i], x, y));
  });
}
