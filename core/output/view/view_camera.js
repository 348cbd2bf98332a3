/* From where one looks, close-ups of contact zones, and the range of the colours. */

// ---- Camera ----

const aspect = () => canvas.clientWidth / canvas.clientHeight || 1;
const baseZoom = () => Math.min(1, aspect());

/* `size`: half of what is to be seen across, at least. */
function look(target, direction, size) {
  const way = direction.clone().normalize();
  if (Math.abs(camera.up.dot(way)) > 0.9999) way.addScaledVector(otherUp(camera.up), 1e-3);  // decides what is up
  controls.target.copy(target);
  camera.position.copy(target).addScaledVector(way.normalize(), DISTANCE);
  camera.zoom = baseZoom() / (1.08 * size);
  camera.updateProjectionMatrix();
  camera.lookAt(target);
  controls.update();
  addArrows();
  ask();
}

const otherUp = (up) => (Math.abs(up.y) < 0.9 ? new THREE.Vector3(0, -1, 0) : new THREE.Vector3(0, 0, 1));
const sceneUp = () => (data.flat === 2 ? new THREE.Vector3(0, 1, 0) : new THREE.Vector3(0, 0, 1));

/* Half of the picture's height that bodies need, seen from a direction. */
function sizeFrom(direction, seen) {
  const eye = direction.clone().normalize(), up = sceneUp();
  const right = new THREE.Vector3().crossVectors(up, eye);
  if (right.length() < 1e-3) right.crossVectors(otherUp(up), eye);
  right.normalize();
  const top = new THREE.Vector3().crossVectors(eye, right);
  let wide = 0, high = 0;
  const centre = centreOf(seen);
  eachCorner(seen, (x) => {
    x.sub(centre);
    wide = Math.max(wide, Math.abs(x.dot(right)));
    high = Math.max(high, Math.abs(x.dot(top)));
  });
  return {centre, size: Math.max(high, wide / aspect(), 1e-9) * baseZoom()};
}

function eachCorner(seen, use) {
  seen.forEach((body) => state.copies.forEach((copy) => {
    for (let p = 0; p < body.X.length / 3; p += Math.max(1, Math.floor(body.X.length / 60000)))
      use(movedPoint(body, p).applyMatrix4(copy));
  }));
}

function centreOf(seen) {
  const box = new THREE.Box3();
  eachCorner(seen, (x) => box.expandByPoint(x));
  return box.getCenter(new THREE.Vector3());
}

const seenBodies = () => bodies.filter((body) => body.visible);

function lookAlong(direction) {
  const {centre, size} = sizeFrom(direction, seenBodies().length ? seenBodies() : bodies);
  look(centre, direction, size);
}

/* Leads to the viewer at first, out of the open quarter of swept bodies. */
const firstEye = () => (revolved && !find("half").checked ? data.eye.map((e) => e || 0.6) : data.eye);

const firstLook = () => lookAlong(new THREE.Vector3(...firstEye()));

function turn(right, up) {
  const away = camera.position.clone().sub(controls.target), axis = camera.up.clone();
  const toZ = new THREE.Quaternion().setFromUnitVectors(axis, new THREE.Vector3(0, 1, 0));
  const sphere = new THREE.Spherical().setFromVector3(away.applyQuaternion(toZ));
  sphere.theta += right;
  sphere.phi = Math.max(0.01, Math.min(Math.PI - 0.01, sphere.phi + up));
  camera.position.setFromSpherical(sphere).applyQuaternion(toZ.inverse()).add(controls.target);
  camera.lookAt(controls.target);
  controls.update();
  ask();
}

function shiftBy(right, up) {
  const step = 1 / camera.zoom, way = new THREE.Vector3(right * step, up * step, 0).applyQuaternion(camera.quaternion);
  controls.target.add(way);
  camera.position.add(way);
  controls.update();
  ask();
}

/* Zooms so that a point of the picture (in [-1, 1]) stays. */
function zoomBy(factor, x, y) {
  const half = {x: (aspect() / camera.zoom) * (1 - 1 / factor), y: (1 / camera.zoom) * (1 - 1 / factor)};
  const way = new THREE.Vector3((x || 0) * half.x, (y || 0) * half.y, 0).applyQuaternion(camera.quaternion);
  controls.target.add(way);
  camera.position.add(way);
  camera.zoom *= factor;
  camera.updateProjectionMatrix();
  controls.update();
  addArrows();
  ask();
}

// ---- Contact zones ----

const zoneCentre = (zone) => [0, 1, 2].map((k) => (zone.low[k] + zone.high[k]) / 2);
const zoneSize = (zone) => Math.hypot(...zone.low.map((l, k) => zone.high[k] - l)) / 2 / radius;

/* Looks at a zone: opened in its middle, or from the side of the scene that it reaches. */
function showZone(index) {
  const zone = data.pairs[index].zone, eye = [...data.eye], across = [0, 1, 2].filter((k) => k !== zone.axis);
  showBodies(() => true);
  if (!state.ownFactor) setFactor(Math.min(1, data.exaggeration));
  const centre = toView(zoneCentre(zone)), size = Math.max(2.2 * zoneSize(zone), 1e-6);
  let reached = -1;
  across.forEach((k) => {
    const near = BESIDE * (zone.high[k] - zone.low[k]);
    const low = zone.low[k] - bounds.low[k] <= near, high = bounds.high[k] - zone.high[k] <= near;
    if (low !== high) eye[k] = (low ? -1 : 1) * Math.abs(eye[k] || 0.5);
    if (low || high) reached = reached < 0 ? k : reached;
  });
  if (data.flat >= 0) {
    setSection(null);
    look(centre, new THREE.Vector3(...firstEye()), size);
  } else {
    const axis = reached >= 0 ? reached : Math.abs(eye[across[0]]) > Math.abs(eye[across[1]]) ? across[0] : across[1];
    const side = eye[axis] < 0 ? -1 : 1;
    setSection(reached >= 0 ? null : {axis, coordinate: zoneCentre(zone)[axis], side});
    const direction = eye.map((e, k) => (k === axis ? side : 0.35 * Math.sign(e || 1)));
    look(centre, new THREE.Vector3(...direction), size);
  }
  afterZone(index, "section");
}

/* The face of the first body alone, seen from outside. */
function showFace(index, id = "pressure") {
  const pair = data.pairs[index], zone = pair.zone, normal = zone.normal.some((n) => n) ? zone.normal : data.eye;
  setSection(null);
  showBodies((body) => body.name === pair.bodies[0]);
  const {centre, direction, size} = revolved ? lookAtRing(zone, normal) :
                                               {centre: zoneCentre(zone), direction: normal, size: zoneSize(zone)};
  look(toView(centre), new THREE.Vector3(...direction), Math.max(1.15 * size, 1e-6));
  setField(id);
  afterZone(index, "face");
}

/* Finds the look at a zone all round, of a narrow one at a sector: opposite the open quarter, so bores are seen too. */
function lookAtRing(zone, normal) {
  const {axis, radial, turns} = revolved, opposite = turns[turns.length >> 1], ring = zone.high[radial] / radius;
  const narrow = {
    centre: turnedVector(zoneCentre(zone), opposite),
    direction: turnedVector(normal, opposite),
    size: zoneSize(zone)
  };
  if (narrow.size < SMALL_ZONE * ring || find("half").checked) return narrow;
  const size = Math.hypot(ring, (zone.high[axis] - zone.low[axis]) / 2 / radius);
  return {...narrow, centre: narrow.centre.map((c, k) => (k === axis ? c : 0)), size};
}

function afterZone(index, kind) {
  state.zone = index;
  document.querySelectorAll("#view-close button")
      .forEach((b) => b.classList.toggle("on", b.dataset.kind === kind && b.dataset.pair === String(index)));
  fitRange();
}

function showWhole() {
  showBodies(() => true);
  setSection(null);
  if (!state.ownFactor) setFactor(data.exaggeration);
  firstLook();
  state.zone = -1;
  document.querySelectorAll("#view-close button").forEach((b) => b.classList.remove("on"));
  wholeRange();
}

function showBodies(keep) {
  state.extremes = null;
  bodies.forEach((body) => (body.visible = keep(body)));
  document.querySelectorAll("#view-bodies input").forEach((box, b) => (box.checked = bodies[b].visible));
}

// ---- Ranges of colours ----

/* use(value, is in the picture) for what is drawn: visible bodies, sections, not what is cut away. Sections reach
   beyond the bodies, where values may be anything: those beyond the field's largest and smallest are not counted. */
function eachSeen(use) {
  const {min, max} = extremes();
  const x = new THREE.Vector3();
  const take = (positions, moves, value, i, body, copy, clipped) => {
    if (value > 0.9 * NOTHING) return;
    if (clipped) {
      x.set(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]).applyMatrix4(copy);
      const plane = shared.plane.value;
      if (plane.x * x.x + plane.y * x.y + plane.z * x.z > plane.w) return;
    }
    x.set(
         positions[3 * i] + state.factor * moves[3 * i] + body.shift.x,
         positions[3 * i + 1] + state.factor * moves[3 * i + 1] + body.shift.y,
         positions[3 * i + 2] + state.factor * moves[3 * i + 2] + body.shift.z)
        .applyMatrix4(copy);
    x.project(camera);
    use(value, Math.abs(x.x) <= 1 && Math.abs(x.y) <= 1);
  };
  seenBodies().forEach((body) => state.copies.forEach((copy) => {
    const positions = body.geometry.attributes.position.array, moves = body.geometry.attributes.moved.array;
    const values = body.geometry.attributes.value.array;
    for (let i = 0; i < values.length; ++i) take(positions, moves, values[i], i, body, copy, Boolean(state.section));
    body.caps.filter((cap) => cap.copy === copy).forEach((cap) => {
      for (let i = 0; i < cap.values.length; ++i)
        if (min && cap.values[i] >= min.value && cap.values[i] <= max.value)
          take(cap.x, cap.u, cap.values[i], i, body, copy, false);
    });
  }));
}

function rangeOf(onlySeen) {
  camera.updateMatrixWorld();
  let low = Infinity, high = -Infinity;
  eachSeen((value, seen) => {
    if (onlySeen && !seen) return;
    low = Math.min(low, value);
    high = Math.max(high, value);
  });
  return low <= high ? [low, high] : null;
}

/* The largest component of what a field is made of: beside it, less than its rounding is none. */
function largestOf(field) {
  if (field.at !== "point") return 0;
  return bodies.reduce(
      (largest, body) => (body[field.needs] || []).reduce((most, v) => Math.max(most, Math.abs(v) || 0), largest), 0);
}

function setRange(range) {
  let [low, high] = range || [0, 1];
  if (state.field.logarithmic) {
    low = Math.max(low, high - 4);  // four decades
    if (!(high > low)) high = low + 1;
  } else {
    const rounding = ROUNDING * state.largest;
    [low, high] = [low, high].map((end) => (Math.abs(end) <= rounding ? 0 : end));
    if (high - low <= ALIKE * Math.max(-low, high)) [low, high] = [Math.min(low, 0), Math.max(high, 0)];
    if (low > 0 && low < 0.3 * high) low = 0;
    if (!(high > low)) high = state.largest || 1;
  }
  state.low = low;
  state.high = high;
  shared.range.value.set(low, high);
  showRange();
  ask();
}

const fitRange = () => state.field.at !== "kind" && setRange(rangeOf(true) || rangeOf(false));
const wholeRange = () => state.field.at !== "kind" && setRange(rangeOf(false));
const plainValue = (value) => (state.field.logarithmic ? 10 ** value : value);

function showRange() {
  const low = plainValue(state.low), high = plainValue(state.high), size = Math.max(Math.abs(low), Math.abs(high));
  const [factor, name] = state.field.unit ? unitFor(state.field.unit, size) : [1, ""];
  state.unit = factor;
  find("from").value = short(low / factor);
  find("to").value = short(high / factor);
  find("unit").textContent = name;
  find("high").textContent = short(high / factor) + " " + name;
  find("low").textContent = low === 0 ? "0" : short(low / factor) + " " + name;
}

function readRange() {
  const read = (id) => Number(find(id).value.replace(",", ".")) * state.unit;
  let [low, high] = [read("from"), read("to")];
  if (state.field.logarithmic) [low, high] = [Math.log10(low), Math.log10(high)];
  if (!(isFinite(low) && isFinite(high) && high > low)) return showRange();
  state.low = low;
  state.high = high;
  shared.range.value.set(low, high);
  showRange();
  ask();
}

/* Says what lies above the bar. */
function tellAbove() {
  const box = find("above");
  if (state.field.at === "kind") return void (box.textContent = "");
  let count = 0, above = 0, most = -Infinity;
  const limit = state.high + 0.0005 * (state.high - state.low);
  eachSeen((value, seen) => {
    if (!seen) return;
    ++count;
    if (value > limit) ++above;
    most = Math.max(most, value);
  });
  box.textContent = above ? "above the bar: up to " + shown(plainValue(most), state.field.unit) + " (" +
          short((100 * above) / count, 2) + " % of the points seen)" :
                            "";
}
