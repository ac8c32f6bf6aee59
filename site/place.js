// SPDX-License-Identifier: Apache-2.0
// Scene for steering: a paved court on a lawn, a colonnade at its far side, cypresses, planters and benches that
// occlude the performer, hills and sky around. Triangles for the viewer's `scene`: x, y, z, r, g, b per corner. Shadows
// darken the corners of the ground.

/** Radius at which the performer turns back; occluders on the court stand further inwards. */
export const COURT_M = 11;

const RIM_M = 12.4;
const FIELD_M = 0.75;  // spacing of the ground's corners, on which shadows are sampled
const SKY_M = 70;     // below the viewer's far plane at 100 m
const TO_SUN = [-0.62, 0.66, -0.42];
const STONE = [0.87, 0.83, 0.77], PAVING = [0.83, 0.785, 0.715], LAWN = [0.6, 0.655, 0.45], LEAF = [0.36, 0.46, 0.33], BARK = [0.45, 0.37, 0.3], CLAY = [0.76, 0.52, 0.4];
const HAZE = [0.93, 0.89, 0.84], ZENITH = [0.5, 0.66, 0.82];

const mix = (a, b, t) => a.map((value, i) => value + (b[i] - value) * t);
const smooth = (low, high, x) => { const t = Math.min(1, Math.max(0, (x - low) / (high - low))); return t * t * (3 - 2 * t); };
const polar = (radius, degrees, y = 0) => [radius * Math.sin(degrees * Math.PI / 180), y, radius * Math.cos(degrees * Math.PI / 180)];
const hazy = (color, metres) => mix(color, HAZE, smooth(12, 62, metres));
// Deterministic pseudo-random number 0…1.
const chance = (n) => { const x = Math.sin(n * 127.1 + 11.7) * 43758.5453; return x - Math.floor(x); };

function litColor(color, normal) {
  const length = Math.hypot(...normal) || 1, sun = Math.max(0, normal.reduce((sum, value, i) => sum + value * TO_SUN[i], 0) / length);
  return color.map((value, i) => value * (0.66 + 0.08 * normal[1] / length + sun * [0.34, 0.31, 0.26][i]));
}

class Shape {
  #numbers = [];
  get corners() { return Float32Array.from(this.#numbers); }
  /** shades: colour per corner. */
  quad(points, shades) {
    for (const i of [0, 1, 2, 0, 2, 3]) this.#numbers.push(...points[i], ...shades[i]);
  }
  /** Flat-shaded face, lit by the sun and, less, from above. */
  lit(points, color) {
    const [u, v] = [1, 3].map((i) => points[i].map((value, axis) => value - points[0][axis]));
    const shade = litColor(color, [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]);
    this.quad(points, [shade, shade, shade, shade]);
  }
  /** Smooth-shaded surface of revolution about a vertical axis: [radius, height] from below. */
  turned([x, , z], profile, color, sides = 12) {
    for (let i = 1; i < profile.length; ++i) {
      const [[low, y0], [high, y1]] = [profile[i - 1], profile[i]];
      const corner = (radius, y, side) => { const [dx, , dz] = polar(radius, 360 * side / sides); return [x + dx, y, z + dz]; };
      const shade = (side) => litColor(color, polar(y1 - y0, 360 * side / sides, low - high));
      for (let side = 0; side < sides; ++side) {
        const [s, t] = [shade(side), shade(side + 1)];
        this.quad([corner(low, y0, side), corner(low, y0, side + 1), corner(high, y1, side + 1), corner(high, y1, side)], [s, t, t, s]);
      }
    }
  }
  /** Bar along an arc about the origin: radii, heights, angles in degrees. */
  arc([inner, outer], [low, high], [from, to], color, steps) {
    for (let i = 0; i < steps; ++i) {
      const [a, b] = [i, i + 1].map((k) => from + (to - from) * k / steps), p = (r, angle, y) => polar(r, angle, y);
      this.lit([p(inner, a, high), p(outer, a, high), p(outer, b, high), p(inner, b, high)], color);
      this.lit([p(inner, b, low), p(inner, a, low), p(inner, a, high), p(inner, b, high)], color);
      this.lit([p(outer, a, low), p(outer, b, low), p(outer, b, high), p(outer, a, high)], color);
    }
    if (to - from >= 360) return;
    for (const [angle, first, second] of [[from, inner, outer], [to, outer, inner]]) {
      this.lit([polar(first, angle, low), polar(second, angle, low), polar(second, angle, high), polar(first, angle, high)], color);
    }
  }
}

// --- objects: [x, 0, z], radius and height of the cast shadow ---

const COLUMNS = Array.from({ length: 11 }, (_, i) => polar(14.2, -75 + 15 * i));
const CYPRESSES = [...Array.from({ length: 12 }, (_, i) => polar(17.5 + 3 * chance(i), -88 + 16 * i + 5 * chance(i + 40))),
  ...Array.from({ length: 9 }, (_, i) => polar(19 + 6 * chance(i + 60), 112 + 17 * i))];
const PLANTERS = [[-4.2, 0, 4.4], [4.2, 0, 4.4], [-6.6, 0, -3.2], [6.6, 0, -3.2]];
const SHADOWS = [...COLUMNS.map((at) => [at, 0.3, 3.6]), ...CYPRESSES.map((at) => [at, 0.75, 4.5]), ...PLANTERS.map((at) => [at, 0.6, 1.5])];

// Light factor of the ground from cast shadows, 0.72…1.
function lightAt([x, , z]) {
  let light = 1;
  for (const [[px, , pz], radius, height] of SHADOWS) {
    if (Math.abs(x - px) > 8 || Math.abs(z - pz) > 8) continue;
    const reach = height / TO_SUN[1], [dx, dz] = [-TO_SUN[0] * reach, -TO_SUN[2] * reach];
    const along = Math.min(1, Math.max(0, ((x - px) * dx + (z - pz) * dz) / (dx * dx + dz * dz)));
    const away = Math.hypot(x - px - along * dx, z - pz - along * dz);
    light = Math.min(light, 0.72 + 0.28 * smooth(0.5 * radius, 1.5 * radius + 0.5 * along, away));
  }
  return light;
}

// Ring of the ground, divided into fields with a colour each.
function ring(shape, inner, outer, fields, fieldColor) {
  const cuts = Math.max(1, Math.round(2 * Math.PI * outer / fields / FIELD_M), Math.ceil(40 / fields)), bands = Math.max(1, Math.round((outer - inner) / FIELD_M));
  for (let field = 0; field < fields * cuts; ++field) {
    for (let band = 0; band < bands; ++band) {
      const [near, far] = [band, band + 1].map((k) => inner + (outer - inner) * k / bands), [a, b] = [field, field + 1].map((k) => 360 * k / (fields * cuts));
      const points = [polar(near, a, -0.004), polar(far, a, -0.004), polar(far, b, -0.004), polar(near, b, -0.004)];
      shape.quad(points, points.map((at) => hazy(fieldColor(Math.floor(field / cuts)), Math.hypot(at[0], at[2])).map((value) => value * lightAt(at))));
    }
  }
}

function ground() {
  const shape = new Shape();
  shape.turned([0, 0, 0], [[13, -0.03], [0, -0.03]], PAVING, 96); // covers gaps between rings with different corners
  for (let i = 0; i < 12; ++i) {
    const fields = i ? 8 * Math.round(2 * Math.PI * (i + 0.5) / 8) : 8, accent = i === 3 || i === 8;
    ring(shape, i, i + 1, fields, (field) => mix(accent ? CLAY : PAVING, STONE, 0.5 * chance(17 * i + field) + (accent ? 0.1 : 0)));
  }
  for (let i = 0; i < 5; ++i) ring(shape, 12 + 2.5 * i, 14.5 + 2.5 * i, 60, (field) => mix(LAWN, LEAF, 0.12 * chance(i * 90 + field)));
  const edges = [24.5, 34, 46, SKY_M];
  for (let i = 0; i < 3; ++i) {
    for (let side = 0; side < 48; ++side) {
      const points = [[edges[i], side], [edges[i + 1], side], [edges[i + 1], side + 1], [edges[i], side + 1]].map(([radius, k]) => polar(radius, 7.5 * k, -0.004));
      shape.quad(points, points.map((at) => hazy(LAWN, Math.hypot(at[0], at[2]))));
    }
  }
  return shape.corners;
}

function buildings() {
  const shape = new Shape();
  shape.arc([12, RIM_M], [-0.1, 0.16], [0, 360], STONE, 72);
  for (const at of COLUMNS) shape.turned(at, [[0.42, 0], [0.42, 0.18], [0.3, 0.3], [0.26, 3.3], [0.4, 3.45], [0.4, 3.6]], STONE, 18);
  shape.arc([13.8, 14.6], [3.6, 4.05], [-79, 79], STONE, 40);
  shape.arc([13.7, 14.7], [4.05, 4.2], [-80, 80], CLAY, 40);
  for (const [from, to] of [[-52, -18], [18, 52], [150, 210]]) {
    shape.arc([8.7, 9.2], [0.34, 0.46], [from, to], STONE, 12);
    shape.arc([8.8, 9.1], [0, 0.34], [from + 1, to - 1], mix(STONE, CLAY, 0.3), 12);
  }
  return shape.corners;
}

function plants() {
  const shape = new Shape();
  CYPRESSES.forEach((at, i) => {
    const tall = 4.6 + 2.4 * chance(i + 80), wide = 0.6 + 0.2 * chance(i + 7), color = hazy(mix(LEAF, LAWN, 0.25 * chance(i + 3)), Math.hypot(at[0], at[2]));
    shape.turned(at, [[0.12, 0], [0.12, 0.5]], BARK, 6);
    shape.turned(at, [[0.3, 0.35], [0.85 * wide, 0.8], [wide, 0.3 * tall], [0.88 * wide, 0.55 * tall], [0.55 * wide, 0.8 * tall], [0.25 * wide, 0.93 * tall], [0, tall]], color, 12);
  });
  for (const at of PLANTERS) {
    shape.turned(at, [[0.4, 0], [0.5, 0.55], [0.56, 0.55], [0.56, 0.65], [0.4, 0.62]], CLAY, 14);
    shape.turned(at, [[0.3, 0.6], [0.56, 0.85], [0.62, 1.1], [0.5, 1.4], [0.25, 1.56], [0, 1.6]], LEAF, 16);
  }
  return shape.corners;
}

// Two rows of hills, the nearer ones lower and more saturated, and the sky behind them.
function surroundings() {
  const shape = new Shape(), sides = 72;
  for (const [row, [radius, height, color]] of [[64, 7, mix(HAZE, ZENITH, 0.32)], [54, 4, mix(HAZE, mix(LAWN, ZENITH, 0.4), 0.42)]].entries()) {
    const top = (k) => height * (0.5 + 0.28 * Math.sin(k * 2 * Math.PI / sides * (5 + row) + row) + 0.22 * Math.sin(k * 2 * Math.PI / sides * (13 - row)));
    for (let side = 0; side < sides; ++side) {
      shape.quad([polar(radius, 5 * side, -0.1), polar(radius, 5 * side + 5, -0.1), polar(radius, 5 * side + 5, top(side + 1)), polar(radius, 5 * side, top(side))], [HAZE, HAZE, color, color]);
    }
  }
  const tone = (elevation) => mix(mix(HAZE, [0.97, 0.92, 0.85], smooth(12, 2, elevation)), ZENITH, smooth(2, 60, elevation));
  for (let elevation = 0; elevation < 90; elevation += 6) {
    for (let side = 0; side < 36; ++side) {
      const at = (e, k) => polar(SKY_M * Math.cos(e * Math.PI / 180), 10 * k, SKY_M * Math.sin(e * Math.PI / 180) - 0.2);
      const [low, high] = [tone(elevation), tone(elevation + 6)];
      shape.quad([at(elevation, side), at(elevation, side + 1), at(elevation + 6, side + 1), at(elevation + 6, side)], [low, low, high, high]);
    }
  }
  return shape.corners;
}

/** Meshes for the viewer's `scene`. */
export const makePlace = () => [surroundings, ground, buildings, plants].map((make) => ({ corners: make() }));
