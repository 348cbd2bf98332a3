/* Sections of bodies of revolution, swept about their axis: boundary and inside of what is drawn of them. */

const SWEPT = 1.5 * Math.PI;       // angle by which sections of bodies of revolution are turned: a quarter is open
const SLICE = 0.02;                // angle where the half-plane alone is shown
const CHORD = 1 / 2000;            // of the radius, from an arc to its chord: half a pixel of 2000 across the body
const MAX_TRIANGLES = 200000;      // number in all swept boundaries, unless so few sectors are too many:
const MIN_SECTORS = 12;            // number of those of 22.5 degrees, which look round by their normals

/* Turns a vector of the half-plane to an angle, or with `back` one there into the half-plane. */
function turnedVector(vector, [cosine, sine], back) {
  const {radial, across} = revolved, turned = [...vector], s = back ? -sine : sine;
  turned[radial] = cosine * vector[radial] - s * vector[across];
  turned[across] = s * vector[radial] + cosine * vector[across];
  return turned;
}

/* Sets the angles: away from the viewer of the half-plane, a right angle is one of them. */
function setTurns(angle) {
  bodies.forEach(findSection);
  const sum = (of) => bodies.reduce((total, body) => total + of(body.section), 0);
  const few = Math.floor((MAX_TRIANGLES - 2 * sum((s) => s.triangles.length)) / (2 * sum((s) => s.rim.length)));
  const fine = Math.ceil(angle / (2 * Math.acos(1 - CHORD)));
  const sectors = fine < 3 ? fine : 3 * Math.min(Math.ceil(fine / 3), Math.floor(Math.max(few, MIN_SECTORS) / 3));
  const exact = (number) => (Math.abs(number) < 1e-12 ? 0 : number);
  revolved.turns = Array.from({length: sectors + 1}, (_, j) => {
    const turn = (-revolved.side * angle * j) / sectors;
    return [exact(Math.cos(turn)), exact(Math.sin(turn))];
  });
}

/* Finds the triangles of the slab's side towards the viewer, and its rim: edges of the triangles that go across. */
function findSection(body) {
  if (body.section) return;
  const {corners} = body.read, {across, side} = revolved, height = (p) => side * body.position[3 * p + across];
  let low = Infinity, high = -Infinity;
  for (let p = 0; p < body.position.length / 3; ++p) {
    low = Math.min(low, height(p));
    high = Math.max(high, height(p));
  }
  const isFront = (p) => high - height(p) < 0.1 * (high - low);
  body.section = {triangles: [], rim: []};
  for (let t = 0; t < corners.length / 3; ++t) {
    const points = [...corners.subarray(3 * t, 3 * t + 3)], front = points.map(isFront);
    const k = [0, 1, 2].find((i) => front[i] && front[(i + 1) % 3]);
    if (front.every(Boolean))
      body.section.triangles.push(t);
    else if (k !== undefined)
      body.section.rim.push([points[k], points[(k + 1) % 3], t]);
  }
}

/* Makes the boundary of what is swept: the section at both ends, its rim between them. Points on the axis stay one. */
function sweepBoundary(body) {
  const {corners, surface} = body.read, {radial, turns} = revolved, last = turns.length - 1;
  const from = [], turn = [], drawnCorners = [], source = [], onAxis = ROUNDING * radius;
  const numbers = new Int32Array((body.position.length / 3) * turns.length).fill(-1);
  const point = (p, j) => {
    const key = p * turns.length + (Math.abs(body.position[3 * p + radial]) < onAxis ? 0 : j);
    if (numbers[key] < 0) {
      numbers[key] = from.length;
      from.push(p);
      turn.push(key % turns.length);
    }
    return numbers[key];
  };
  const add = (t, a, b, c) => {
    if (a === b || b === c || c === a) return;
    drawnCorners.push(a, b, c);
    source.push(t);
  };
  body.section.triangles.forEach((t) => add(t, ...[0, 1, 2].map((k) => point(corners[3 * t + k], 0))));
  const firstEnd = source.length;
  body.section.triangles.forEach((t) => add(t, ...[0, 2, 1].map((k) => point(corners[3 * t + k], last))));
  const ends = source.length;
  body.section.rim.forEach(([p, q, t]) => {
    for (let j = 0; j < last; ++j) {
      add(t, point(p, j), point(q, j), point(q, j + 1));
      add(t, point(p, j), point(q, j + 1), point(p, j + 1));
    }
  });
  Object.assign(body, {from: Uint32Array.from(from), turn: Uint32Array.from(turn)});
  body.corners = Uint32Array.from(drawnCorners);
  Object.keys(body.read).filter((name) => name !== "corners").forEach((name) => {
    const values = body.read[name];
    body[name] = values && values.constructor.from(source, (t) => values[t]);
  });
  body.cuts = ends;  // the first triangles: those of the two planes
  body.face.fill(-1, 0, ends);
  const surfaces = surface.reduce((most, s) => Math.max(most, s), 0) + 1;
  body.surface.fill(surfaces, 0, firstEnd).fill(surfaces + 1, firstEnd, ends);
}

/* Makes rings of the blocks of the section, sector by sector. */
function sweepInside(inside) {
  const {blocks, error, status} = inside.read, {across, turns} = revolved, sectors = turns.length - 1;
  const points = inside.position.length / 3, numbers = Uint32Array.from({length: points}, (_, p) => p);
  const repeat = (values, times) => {
    const all = values && new values.constructor(values.length * times);
    for (let j = 0; values && j < times; ++j) all.set(values, j * values.length);
    return all;
  };
  inside.from = repeat(numbers, turns.length);
  inside.turn = inside.from.map((_, i) => Math.floor(i / points));
  inside.blocks = repeat(blocks, sectors);
  for (let i = 0; i < inside.blocks.length; ++i) {
    const k = i % blocks.length, corner = i % 8, near = corner & ~(1 << across), j = (i - k) / blocks.length;
    inside.blocks[i] = blocks[k - corner + near] + points * (corner === near ? j : j + 1);
  }
  Object.assign(inside, {error: repeat(error, sectors), status: repeat(status, sectors)});
}
