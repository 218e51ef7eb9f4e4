// How much every triangle is distorted, and its colour.

/**
 * Per triangle: angle (the ratio of the singular values, 1 where angles are kept), area (the ratio of the areas to the mean one,
 * 1 where they keep their proportions), stretch (√((1/s₁² + 1/s₂²) / 2) at the mean scale: above 1 where the layout is smaller than the
 * surface, 1 for an isometry). NaN where a triangle has no area.
 */
export function distortion({ positions, indices }, result, page) {
  const uv = result.uvs ?? result.uv;
  const corners = result.indices ?? indices;
  const count = indices.length / 3;
  const [angle, area, stretch] = [0, 1, 2].map(() => new Float32Array(count).fill(NaN));
  const [larger, smaller] = [new Float64Array(count), new Float64Array(count)];
  let [surface, flat] = [0, 0];
  for (let f = 0; f < count; ++f) {
    const at = (k) => 3 * indices[3 * f + k];
    const side = (k) => [0, 1, 2].map((x) => positions[at(k) + x] - positions[at(0) + x]);
    const [a, b] = [side(1), side(2)];
    const length = Math.hypot(...a);
    const along = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / length;
    const up = Math.sqrt(Math.max(b[0] ** 2 + b[1] ** 2 + b[2] ** 2 - along ** 2, 0));
    const texel = (k, x) => (uv[2 * corners[3 * f + k] + x] - uv[2 * corners[3 * f] + x]) * page[x];
    // The Jacobian from the plane of the triangle to the texture.
    const j = [texel(1, 0) / length, texel(1, 1) / length];
    const i = [(texel(2, 0) - j[0] * along) / up, (texel(2, 1) - j[1] * along) / up];
    const [sum, product] = [j[0] ** 2 + j[1] ** 2 + i[0] ** 2 + i[1] ** 2, Math.abs(j[0] * i[1] - j[1] * i[0])];
    if (!(length > 0 && up > 0)) continue;
    const root = Math.sqrt(Math.max(sum ** 2 / 4 - product ** 2, 0));
    larger[f] = Math.sqrt(sum / 2 + root);
    smaller[f] = product / larger[f];
    const own = (length * up) / 2;
    surface += own;
    flat += product * own;
  }
  const scale = Math.sqrt(surface / flat);
  for (let f = 0; f < count; ++f) {
    if (!(larger[f] > 0)) continue;
    angle[f] = larger[f] / smaller[f];
    area[f] = larger[f] * smaller[f] * scale ** 2;
    stretch[f] = Math.sqrt((1 / larger[f] ** 2 + 1 / smaller[f] ** 2) / 2) / scale;
  }
  return { angle, area, stretch };
}

/** From what to what the colours run. Area and stretch run over a middle. */
export const RANGES = { angle: [1, 2], area: [0.5, 2], stretch: [0.5, 2] };

/** A colour in [0, 1]³: blue below, light in the middle, red above, by the logarithm. */
export function colour(kind, value) {
  if (!Number.isFinite(value)) return [0.5, 0.5, 0.5];
  const [low, high] = RANGES[kind];
  const t = Math.min(Math.max(Math.log(value / low) / Math.log(high / low), 0), 1);
  const side = kind === "angle" ? t : 2 * t - 1;
  const [light, red, blue] = [[0.93, 0.93, 0.9], [0.75, 0.15, 0.12], [0.12, 0.35, 0.72]];
  const end = side >= 0 ? red : blue;
  return light.map((x, k) => x + (end[k] - x) * Math.abs(side));
}

/** A colour of its own for every chart. */
export function chartColour(chart) {
  if (chart === 0xffffffff) return [0.5, 0.5, 0.5];
  const hue = (chart * 0.61803398875) % 1;
  return [0, 1 / 3, 2 / 3].map((shift) => 0.55 + 0.35 * Math.cos(2 * Math.PI * (hue - shift)));
}
