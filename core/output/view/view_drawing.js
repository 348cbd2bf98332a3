/* Bodies, sections and arrows as three.js draws them. */

// ---- Drawing ----

const VERTEX = `
  attribute vec3 moved;
  attribute float value;
  uniform float factor;
  uniform vec3 shift;
  varying vec3 vNormal;
  varying vec3 vPosition;
  varying float vValue;
  void main() {
    vPosition = (modelMatrix * vec4(position, 1.0)).xyz;
    vNormal = normalMatrix * normal;
    vValue = value;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position + factor * moved + shift, 1.0);
  }`;
const FRAGMENT = `
  uniform sampler2D colours;
  uniform vec2 range;
  uniform vec3 plain, above, below;
  uniform vec4 plane;
  uniform float clipped, bands, opacity, flatness, texels;
  varying vec3 vNormal;
  varying vec3 vPosition;
  varying float vValue;
  vec3 colourOf(float value) {
    if (value > 0.9e30) return plain;
    float fraction = (value - range.x) / (range.y - range.x);
    if (fraction > 1.0005) return above;
    if (fraction < -0.0005) return below;
    fraction = clamp(fraction, 0.0, 1.0);
    if (bands > 0.0) fraction = (min(floor(fraction * bands), bands - 1.0) + 0.5) / bands;
    return texture2D(colours, vec2((fraction * (texels - 1.0) + 0.5) / texels, 0.5)).rgb;
  }
  void main() {
    if (clipped > 0.5 && dot(plane.xyz, vPosition) > plane.w) discard;
    vec3 n = normalize(vNormal);
    float light = 0.74 + 0.22 * abs(n.z) + 0.04 * n.y;
    gl_FragColor = vec4(colourOf(vValue) * mix(light, 1.0, flatness), opacity);
  }`;
const LINE_FRAGMENT = `
  uniform vec4 plane;
  uniform float clipped;
  uniform vec3 plain;
  varying vec3 vPosition;
  void main() {
    if (clipped > 0.5 && dot(plane.xyz, vPosition) > plane.w) discard;
    gl_FragColor = vec4(plain, 0.55);
  }`;

const canvas = find("canvas");
const state = {
  field: fields[0],
  factor: 0,
  step: lastStep,
  section: null,
  low: 0,
  high: 1,
  copies: [new THREE.Matrix4()],
  marker: null,
  largest: 0,
  ownFactor: false,
  turning: false,
  zone: -1,
  picked: null
};
let renderer, camera, controls, scene, arrows, paletteTexture, waiting = false;

function texture(bytes, filter) {
  const made = new THREE.DataTexture(bytes, bytes.length / 3, 1, THREE.RGBFormat);
  made.minFilter = made.magFilter = filter;
  made.unpackAlignment = 1;
  made.needsUpdate = true;
  return made;
}

const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.substr(i, 2), 16));

/* Colours of kinds, two at least. */
function kindTexture(list) {
  const bytes = new Uint8Array(3 * Math.max(2, list.length)).fill(200);
  list.forEach((kind, i) => bytes.set(rgb(kind.colour), 3 * i));
  return texture(bytes, THREE.NearestFilter);
}

/* Uniforms that all materials share: a change reaches all of them. */
const shared = {
  factor: {value: 0},
  range: {value: new THREE.Vector2(0, 1)},
  colours: {value: null},
  texels: {value: 256},
  bands: {value: 0},
  above: {value: new THREE.Vector3(...ABOVE)},
  below: {value: new THREE.Vector3(...BELOW)},
  clipped: {value: 0},
  plane: {value: new THREE.Vector4()},
  opacity: {value: 1},
};

function material(body, more, options) {
  const uniforms = Object.assign(
      {shift: {value: body.shift}, flatness: {value: 0}, plain: {value: new THREE.Vector3(0.76, 0.77, 0.79)}}, shared,
      more || {});
  return new THREE.ShaderMaterial(Object.assign(
      {vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms, side: THREE.DoubleSide}, options || {}));
}

/* Normals: means over the triangles of one surface around a point, so that edges between surfaces stay sharp. */
function normalsOf(body) {
  const normals = new Float32Array(9 * body.count), sums = new Map(), X = body.X, n = body.X.length / 3;
  const key = (t, k) => body.surface[t] * n + body.corners[3 * t + k];
  for (let t = 0; t < body.count; ++t) {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * body.corners[3 * t + k]);
    const p = [X[b] - X[a], X[b + 1] - X[a + 1], X[b + 2] - X[a + 2]],
          q = [X[c] - X[a], X[c + 1] - X[a + 1], X[c + 2] - X[a + 2]];
    const cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    for (let k = 0; k < 3; ++k) {
      const sum = sums.get(key(t, k));
      if (sum)
        sum.forEach((s, i) => (sum[i] = s + cross[i]));
      else
        sums.set(key(t, k), cross.slice());
    }
  }
  for (let t = 0; t < body.count; ++t)
    for (let k = 0; k < 3; ++k) {
      const sum = sums.get(key(t, k)), size = Math.hypot(...sum) || 1;
      for (let i = 0; i < 3; ++i) normals[9 * t + 3 * k + i] = sum[i] / size;
    }
  return normals;
}

/* Values of points at the corners. */
function atCorners(values, corners) {
  const spread = new Float32Array(3 * corners.length);
  for (let i = 0; i < corners.length; ++i)
    for (let k = 0; k < 3; ++k) spread[3 * i + k] = values[3 * corners[i] + k];
  return spread;
}

function geometryOf(X, U, values, normals) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(X, 3));
  geometry.setAttribute("moved", new THREE.BufferAttribute(U, 3));
  if (values) geometry.setAttribute("value", new THREE.BufferAttribute(values, 1));
  if (normals) geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
  return geometry;
}

/* Edges between two surfaces. */
function edgesOf(body) {
  const first = new Map(), n = body.X.length / 3, ends = [];
  for (let t = 0; t < body.count; ++t)
    for (let k = 0; k < 3; ++k) {
      const a = body.corners[3 * t + k], b = body.corners[3 * t + ((k + 1) % 3)],
            key = Math.min(a, b) * n + Math.max(a, b);
      if (!first.has(key))
        first.set(key, body.surface[t]);
      else if (first.get(key) !== body.surface[t])
        ends.push(a, b);
    }
  return Uint32Array.from(ends);
}

function makeBody(body) {
  body.geometry = geometryOf(
      atCorners(body.X, body.corners), atCorners(body.U, body.corners), cornerValues(body, state.field),
      normalsOf(body));
  body.edges = edgesOf(body);
  body.lines = geometryOf(atCorners(body.X, body.edges), atCorners(body.U, body.edges));
  body.meshes = body.meshes || [];
}

const dark = () => matchMedia("(prefers-color-scheme: dark)").matches;

/* Turns the section's plane into a mirrored copy's own axes. */
function planeIn(copy) {
  const plane = shared.plane.value, n = new THREE.Vector3(plane.x, plane.y, plane.z);
  const inverse = new THREE.Matrix4().getInverse(copy), origin = new THREE.Vector3().applyMatrix4(inverse);
  const point = n.clone().multiplyScalar(plane.w).applyMatrix4(inverse);
  const normal = n.clone().applyMatrix4(inverse).sub(origin);
  return {normal, distance: normal.dot(point)};
}

/* All meshes anew: bodies, copies, sections. */
function build() {
  bodies.forEach((body) => {
    body.meshes.forEach((mesh) => scene.remove(mesh));
    body.meshes = [];
    body.caps = [];
  });
  let order = 1;
  const transparent = find("transparent").checked;
  shared.opacity.value = transparent ? 0.3 : 1;
  bodies.filter((body) => body.visible).forEach((body) => state.copies.forEach((copy) => {
    const add = (object) => {
      object.matrixAutoUpdate = false;
      object.matrix.copy(copy);
      object.frustumCulled = false;
      body.meshes.push(object);
      scene.add(object);
      return object;
    };
    if (state.section) order = addCap(body, copy, order, add);
    const options =
        {transparent, depthWrite: !transparent, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1};
    add(new THREE.Mesh(body.geometry, material(body, {}, options))).renderOrder = 10000;
    if (find("edges").checked)
      add(new THREE.LineSegments(body.lines, new THREE.ShaderMaterial({
        vertexShader: VERTEX,
        fragmentShader: LINE_FRAGMENT,
        transparent: true,
        uniforms:
            Object.assign({shift: {value: body.shift}, plain: {value: new THREE.Vector3(0.08, 0.1, 0.14)}}, shared)
      }))).renderOrder = 20000;
  }));
  addArrows();
  ask();
}

/* The section fills the pixels behind which more of the body's back than of its front is left. */
function addCap(body, copy, order, add) {
  const cap = capOf(body, planeIn(copy));
  cap.copy = copy;
  body.caps.push(cap);
  const count = (side, operation) => material(body, {}, {
    side,
    colorWrite: false,
    depthWrite: false,
    depthTest: false,
    stencilWrite: true,
    stencilFunc: THREE.AlwaysStencilFunc,
    stencilZPass: operation,
    stencilFail: operation,
    stencilZFail: operation
  });
  add(new THREE.Mesh(body.geometry, count(THREE.BackSide, THREE.IncrementWrapStencilOp))).renderOrder = order;
  add(new THREE.Mesh(body.geometry, count(THREE.FrontSide, THREE.DecrementWrapStencilOp))).renderOrder = order + 1;
  const fill = material(
      body, {clipped: {value: 0}, opacity: {value: 1}, flatness: {value: 1}},
      {stencilWrite: true, stencilRef: 0, stencilFunc: THREE.NotEqualStencilFunc});
  const mesh = add(new THREE.Mesh(cap.geometry, fill));
  mesh.renderOrder = order + 2;
  mesh.onAfterRender = () => renderer.clearStencil();
  return order + 3;
}

const TETRAHEDRA = [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]];

/* Where a plane cuts the blocks of a body, with the field there. */
function capOf(body, plane) {
  const {X, U, blocks, position, from} = body.inside, n = plane.normal;
  const heights = new Float32Array(X.length / 3), x = [], u = [], positions = [], values = [];
  for (let p = 0; p < heights.length; ++p)
    heights[p] = n.x * X[3 * p] + n.y * X[3 * p + 1] + n.z * X[3 * p + 2] - plane.distance;
  const value = insideValues(body);
  const cut = (a, b, block) => {
    const t = heights[a] / (heights[a] - heights[b]), p = from[a], q = from[b];
    for (let i = 0; i < 3; ++i) {
      x.push((1 - t) * X[3 * a + i] + t * X[3 * b + i]);
      u.push((1 - t) * U[3 * a + i] + t * U[3 * b + i]);
      positions.push((1 - t) * position[3 * p + i] + t * position[3 * q + i]);
    }
    values.push(
        value.byPoint     ? (1 - t) * value.byPoint[p] + t * value.byPoint[q] :
            value.byBlock ? value.byBlock[block] :
                            NOTHING);
  };
  const corners = new Array(8);
  for (let block = 0; block < blocks.length / 8; ++block) {
    let low = 0;
    for (let c = 0; c < 8; ++c) {
      corners[c] = blocks[8 * block + c];
      if (heights[corners[c]] < 0) ++low;
    }
    if (low === 0 || low === 8) continue;
    TETRAHEDRA.forEach((tetrahedron) => {
      const under = [], over = [];
      tetrahedron.forEach((c) => (heights[corners[c]] < 0 ? under : over).push(corners[c]));
      if (!under.length || !over.length) return;
      if (under.length === 2)
        [[0, 0], [0, 1], [1, 1], [0, 0], [1, 1], [1, 0]].forEach(([i, j]) => cut(under[i], over[j], block));
      else
        under.forEach((a) => over.forEach((b) => cut(a, b, block)));
    });
  }
  const normals = new Float32Array(x.length);
  for (let i = 0; i < normals.length; i += 3) normals.set([n.x, n.y, n.z], i);
  const cap = {x: new Float32Array(x), u: new Float32Array(u), values: new Float32Array(values), positions};
  return {...cap, geometry: geometryOf(cap.x, cap.u, cap.values, normals)};
}

/* Values inside of a body, by point or by block; neither: the field is one of the boundary, or of another step. */
function insideValues(body) {
  const field = state.field, inside = body.inside;
  if (field.at === "kind" && field.id === "bodies")
    return {byBlock: new Array(inside.blocks.length / 8).fill(body.index)};
  if (field.id === "status" && inside.status) return {byBlock: inside.status};
  if (field.at === "cell" && inside.error) return {byBlock: inside.error.map((v) => (isNaN(v) ? NOTHING : v))};
  if (field.at !== "point" || !inside[field.needs] || state.step !== lastStep) return {};
  const byPoint = new Float32Array(inside.position.length / 3);
  for (let p = 0; p < byPoint.length; ++p) {
    const value = pointValue(field, inside, p);
    byPoint[p] = isNaN(value) ? NOTHING : value;
  }
  return {byPoint};
}

// ---- Loads and motions ----

/* Points of a face that lie apart from each other, the first next to its centroid. */
function spreadPoints(face, most) {
  const body = bodies.find((b) => b.face.includes(face));
  if (!body) return {body, points: []};
  const points =
      [...new Set(Array.from(body.face.keys()).filter((t) => body.face[t] === face).map((t) => body.corners[3 * t]))];
  const at = (p) => new THREE.Vector3(body.X[3 * p], body.X[3 * p + 1], body.X[3 * p + 2]);
  const far = points.map(() => Infinity), chosen = [];
  const centre = toView(data.faces[face].at);
  let next =
      points.reduce((best, p, i) => (at(p).distanceTo(centre) < at(points[best]).distanceTo(centre) ? i : best), 0);
  while (chosen.length < most && chosen.length < points.length) {
    chosen.push(points[next]);
    const last = at(points[next]);
    points.forEach((p, i) => (far[i] = Math.min(far[i], at(p).distanceTo(last))));
    next = far.indexOf(Math.max(...far.slice(0, 20000)));
  }
  return {body, points: chosen};
}

function movedPoint(body, p) {
  const i = 3 * p;
  return new THREE.Vector3(
      body.X[i] + state.factor * body.U[i] + body.shift.x, body.X[i + 1] + state.factor * body.U[i + 1] + body.shift.y,
      body.X[i + 2] + state.factor * body.U[i + 2] + body.shift.z);
}

/* Turns a vector at a drawn point into the half-plane, or one of the half-plane to the point. */
const atFirst = (body, p, v) => (revolved ? turnedVector(v, revolved.turns[body.turn[p]], true) : v);
const atPoint = (body, p, v) => (revolved ? turnedVector(v, revolved.turns[body.turn[p]], false) : v);

/* Tells whether a direction leads out of the body: arrows start on the face then, else they end there. */
function pulls(face, f, direction) {
  if (face.normal === undefined) {
    const body = face.spread.body, normals = body.geometry.attributes.normal.array;
    face.normal = new THREE.Vector3();
    for (let t = 0; t < body.count; ++t)
      if (body.face[t] === f)
        face.normal.add(new THREE.Vector3(...atFirst(body, body.corners[3 * t], normals.slice(9 * t, 9 * t + 3))));
    face.normal.normalize();
  }
  return face.normal.dot(direction) > 0.3;
}

function addArrows() {
  if (arrows) scene.remove(arrows);
  arrows = new THREE.Group();
  scene.add(arrows);
  if (!find("arrows").checked) return;
  const size = 0.16 / Math.max(1, camera.zoom / baseZoom());
  data.faces.forEach((face, f) => [["force", 0xa00010], ["motion", 0x2050c0]].forEach(([what, colour]) => {
    const direction = new THREE.Vector3(...face[what]);
    if (!(direction.length() > 0)) return;
    face.spread = face.spread || spreadPoints(f, 5);
    if (!face.spread.body || !face.spread.body.visible) return;
    direction.normalize();
    face.spread.points.forEach((p) => {
      const way = new THREE.Vector3(...atPoint(face.spread.body, p, direction.toArray()));
      const tip = movedPoint(face.spread.body, p),
            tail = tip.clone().addScaledVector(way, pulls(face, f, direction) ? 0 : -size);
      const arrow = new THREE.ArrowHelper(way, tail, size, colour, 0.35 * size, 0.2 * size);
      arrow.traverse((child) => {
        child.renderOrder = 30000;
        if (child.material) Object.assign(child.material, {depthTest: false, transparent: true});
      });
      arrows.add(arrow);
    });
  }));
}
