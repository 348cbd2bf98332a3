/* Labels, axes, scale; what a click reads. */

// ---- Labels ----

let plates = [];  // the labels of the present picture

function toScreen(x) {
  const at = x.clone().project(camera);
  return [((at.x + 1) / 2) * canvas.clientWidth, ((1 - at.y) / 2) * canvas.clientHeight];
}

/* `kind`: classes; "middle" is left out where another label is. */
function label(text, x, kind) {
  const [left, top] = toScreen(x);
  if (left < 0 || top < 0 || left > canvas.clientWidth || top > canvas.clientHeight) return;
  if (text.length > LONGEST_LABEL) text = text.slice(0, LONGEST_LABEL - 1) + "…";
  const wide = 3.6 * text.length + 6;  // half of it
  if (kind === "middle" && plates.some((p) => Math.abs(p.left - left) < p.wide + wide && Math.abs(p.top - top) < 22))
    return;
  // So far to the side that the whole text is seen, beside the bar of colours.
  const bar = find("bar");
  const end = top < bar.offsetTop + bar.offsetHeight + 11 && bar.offsetWidth ? bar.offsetLeft : canvas.clientWidth;
  const aside = kind === "middle" ? 0 : Math.max(0, wide - left) - Math.max(0, left + wide - end);
  plates.push({left: left + aside, top, wide});
  const plate = document.createElement("div");
  plate.className = "view-label " + (kind || "");
  plate.textContent = text;
  plate.style.left = left + "px";
  plate.style.top = top + "px";
  plate.style.setProperty("--aside", aside + "px");
  find("labels").appendChild(plate);
}

/* Where a position (m) of a body is drawn: moved with the nearest point that has a displacement. Those of the
   half-plane lie on the boundary of what is swept. */
function drawnPosition(body, position) {
  const x = toView(position);
  let least = Infinity, move = [0, 0, 0];
  [body, body.inside].forEach((owner) => {
    if (owner === body.inside && state.step !== lastStep) return;
    for (let i = 0; i < owner.X.length; i += 3) {
      const far = (owner.X[i] - x.x) ** 2 + (owner.X[i + 1] - x.y) ** 2 + (owner.X[i + 2] - x.z) ** 2;
      if (far < least) {
        least = far;
        move = owner.U.slice(i, i + 3);
      }
    }
  });
  return {
    x: new THREE.Vector3(x.x + state.factor * move[0], x.y + state.factor * move[1], x.z + state.factor * move[2])
           .add(body.shift),
    onBoundary: Boolean(revolved) || state.field.at === "contact" || nearBoundary(body, x)
  };
}

function nearBoundary(body, x) {
  for (let i = 0; i < body.X.length; i += 3)
    if (Math.abs(body.X[i] - x.x) + Math.abs(body.X[i + 1] - x.y) + Math.abs(body.X[i + 2] - x.z) < 2e-4) return true;
  return false;
}

/* The largest and the smallest value of the field in the bodies that are on: those of the report where it has them. */
function extremesOfField() {
  const found = {min: null, max: null}, field = state.field;
  const better = (kind, value) =>
      !found[kind] || (kind === "max" ? value > found[kind].value : value < found[kind].value);
  seenBodies().forEach((body) => {
    const values = body.geometry.attributes.value.array;
    for (let i = 0; i < values.length; ++i) {
      if (values[i] > 0.9 * NOTHING) continue;
      ["min", "max"].forEach((kind) => {
        if (better(kind, values[i])) found[kind] = {value: values[i], body, point: body.corners[i]};
      });
    }
    const told = (state.step === lastStep && body.extremes[field.id]) || {};
    ["min", "max"].forEach((kind) => {
      if (!told[kind] || (found[kind] && found[kind].body !== body))
        return void (
            told[kind] && better(kind, told[kind].value) &&
            (found[kind] = {value: told[kind].value, body, position: told[kind].at}));
      found[kind] = {value: told[kind].value, body, position: told[kind].at};  // exact where the boundary's is rounded
    });
  });
  return found;
}

function isCutAway(x) {
  const plane = shared.plane.value, above = plane.x * x.x + plane.y * x.y + plane.z * x.z - plane.w;
  return Boolean(state.section) && above > 1e-6;
}

const extremes = () => (state.extremes = state.extremes || extremesOfField());

/* Tells whether something is drawn before a point; while the view turns that is not asked. */
function isBehind(x) {
  if (state.turning) return false;
  const hit = pick(...toScreen(x));
  if (!hit) return false;
  const way = camera.getWorldDirection(new THREE.Vector3());
  return hit.far < x.dot(way) - hit.origin.dot(way) - BEHIND;
}

function labelExtremes() {
  if (!find("extremes").checked || state.field.at === "kind") return;
  [["min", "smallest"], ["max", "largest"]].forEach(([kind, word]) => {
    const most = extremes()[kind];
    if (!most) return;
    const at = most.position ? drawnPosition(most.body, most.position) :
                               {x: movedPoint(most.body, most.point), onBoundary: true};
    const away = most.position ? isCutAway(toView(most.position)) :
                              isCutAway(new THREE.Vector3(...most.body.X.slice(3 * most.point, 3 * most.point + 3)));
    const rounding = ROUNDING * Math.max(Math.abs(state.low), Math.abs(state.high), state.largest);
    const value = Math.abs(most.value) < rounding ? 0 : most.value;
    const remark = away ? ", cut away" : !at.onBoundary ? ", inside" : isBehind(at.x) ? ", behind" : "";
    label(word + " " + shown(plainValue(value), state.field.unit) + remark, at.x, remark ? "point inside" : "point");
  });
}

function labelNames() {
  if (find("names").checked)
    seenBodies().forEach((body) => label(body.name, body.centre.clone().add(body.shift), "middle"));
  if (find("faces").checked)
    data.faces.forEach((face, f) => {
      face.spread = face.spread || spreadPoints(f, 5);
      const {body, points} = face.spread;
      if (body && body.visible && points.length && facesViewer(body, f))
        label(face.name + (face.role === "free" ? "" : ": " + face.text), movedPoint(body, points[0]), "middle");
    });
}

/* Tells whether any triangle of a face does. */
function facesViewer(body, face) {
  const eye = camera.getWorldDirection(new THREE.Vector3()).negate(), normals = body.geometry.attributes.normal.array;
  let sum = 0;
  for (let t = 0; t < body.count; ++t)
    if (body.face[t] === face)
      sum += Math.max(0, eye.x * normals[9 * t] + eye.y * normals[9 * t + 1] + eye.z * normals[9 * t + 2]);
  return sum > 1e-3;
}

function drawTriad() {
  const names = ["x", "y", "z"], colours = ["#d0342c", "#2c9a4b", "#2f6fd0"];
  const axes = names.map((name, k) => {
    const d = new THREE.Vector3(k === 0 ? 1 : 0, k === 1 ? 1 : 0, k === 2 ? 1 : 0)
                  .applyQuaternion(camera.quaternion.clone().inverse());
    return {name, colour: colours[k], x: 24 * d.x, y: -24 * d.y, z: d.z};
  });
  find("triad").innerHTML =
      axes.sort((a, b) => a.z - b.z)
          .map(
              (a) => `<line x1="0" y1="0" x2="${a.x}" y2="${a.y}" stroke="${a.colour}"/>` +
                  (Math.hypot(a.x, a.y) > 3 ? `<text x="${1.42 * a.x}" y="${1.42 * a.y}">${a.name}</text>` : ""))
          .join("");
}

function drawScale() {
  const perPixel = (2 * radius) / camera.zoom / canvas.clientHeight;  // m
  const aim = 0.25 * canvas.clientWidth * perPixel, power = 10 ** Math.floor(Math.log10(aim));
  const length = [5, 2, 1].map((d) => d * power).find((l) => l <= aim) || power;
  find("scale").style.width = length / perPixel + "px";
  find("scale").firstChild.textContent = shown(length, "m");
}

function drawColours() {
  const kind = state.field.at === "kind";
  find("bar").style.display = kind ? "none" : "";
  find("legend").textContent = "";
  if (!kind) return;
  const used = new Set();
  seenBodies().forEach((body) => {
    for (let t = 0; t < body.count; ++t) used.add(kindOf(state.field, body, t));
  });
  const list = kinds(state.field).filter((k, i) => used.has(i)), entries = new Map();
  list.forEach((k) => entries.set(state.field.id === "role" ? k.role : k.name, entries.get(k.role) || k.colour));
  entries.forEach((colour, name) => {
    const line = document.createElement("div"), square = document.createElement("i");
    square.style.background = colour;
    line.append(square, name);
    find("legend").appendChild(line);
  });
}

/* The bar beside the view, from top to bottom. */
function paintBar() {
  const bar = find("colours"), context = bar.getContext("2d"), bytes = bytesOf(data.palette);
  for (let y = 0; y < 256; ++y) {
    let texel = 255 - y;
    if (shared.bands.value)
      texel = Math.round(((Math.floor((texel / 256) * shared.bands.value) + 0.5) / shared.bands.value) * 255);
    context.fillStyle = `rgb(${bytes[3 * texel]}, ${bytes[3 * texel + 1]}, ${bytes[3 * texel + 2]})`;
    context.fillRect(0, y, 1, 1);
  }
}

// ---- Picking ----

/* Where a ray meets triangles: use(distance, triangle, weights). Corners are those of positions moved as drawn. */
function eachHit(origin, way, count, corner, use) {
  const a = [0, 0, 0], b = [0, 0, 0], c = [0, 0, 0], o = origin, d = way;
  for (let t = 0; t < count; ++t) {
    corner(t, 0, a);
    corner(t, 1, b);
    corner(t, 2, c);
    const e1 = [b[0] - a[0], b[1] - a[1], b[2] - a[2]], e2 = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
    const p = [d.y * e2[2] - d.z * e2[1], d.z * e2[0] - d.x * e2[2], d.x * e2[1] - d.y * e2[0]];
    const det = e1[0] * p[0] + e1[1] * p[1] + e1[2] * p[2];
    if (det === 0) continue;
    const s = [o.x - a[0], o.y - a[1], o.z - a[2]], u = (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / det;
    if (u < 0 || u > 1) continue;
    const q = [s[1] * e1[2] - s[2] * e1[1], s[2] * e1[0] - s[0] * e1[2], s[0] * e1[1] - s[1] * e1[0]];
    const v = (d.x * q[0] + d.y * q[1] + d.z * q[2]) / det;
    if (v < 0 || u + v > 1) continue;
    use((e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / det, t, [1 - u - v, u, v]);
  }
}

function pickCopy(body, copy, ray) {
  const inverse = new THREE.Matrix4().getInverse(copy), zero = new THREE.Vector3().applyMatrix4(inverse);
  const origin = ray.origin.clone().applyMatrix4(inverse), way = ray.direction.clone().applyMatrix4(inverse).sub(zero);
  const hits = [], crossings = [], plane = state.section && planeIn(copy),
        shift = [body.shift.x, body.shift.y, body.shift.z];
  const mover = (X, U, index) => (t, k, out) => {
    const i = 3 * index(3 * t + k);
    for (let j = 0; j < 3; ++j) out[j] = X[i + j] + state.factor * U[i + j] + shift[j];
  };
  eachHit(origin, way, body.count, mover(body.X, body.U, (i) => body.corners[i]), (far, triangle, weights) => {
    crossings.push(far);
    const x = [0, 1, 2].map(
        (k) => weights.reduce((sum, w, v) => sum + w * body.X[3 * body.corners[3 * triangle + v] + k], 0));
    if (plane && plane.normal.x * x[0] + plane.normal.y * x[1] + plane.normal.z * x[2] > plane.distance) return;
    const points = weights.map((w, v) => body.from[body.corners[3 * triangle + v]]);
    const position = [0, 1, 2].map((k) => weights.reduce((sum, w, v) => sum + w * body.position[3 * points[v] + k], 0));
    hits.push({far, body, copy, triangle, weights, position, inside: triangle < body.cuts});
  });
  body.caps.filter((cap) => cap.copy === copy).forEach((cap) => {
    eachHit(origin, way, cap.values.length / 3, mover(cap.x, cap.u, (i) => i), (far, triangle, weights) => {
      if (crossings.filter((c) => c > far).length % 2 === 0) return;  // outside of the body
      const first = 9 * triangle;
      const position =
          [0, 1, 2].map((k) => weights.reduce((sum, w, v) => sum + w * cap.positions[first + 3 * v + k], 0));
      hits.push({far, body, copy, cap, triangle, weights, position, inside: true});
    });
  });
  return hits;
}

/* Finds what is seen at a point of the picture (pixels); null: nothing. */
function pick(left, top) {
  const x = (2 * left) / canvas.clientWidth - 1, y = 1 - (2 * top) / canvas.clientHeight;
  camera.updateMatrixWorld();
  const origin = new THREE.Vector3(x, y, -1).unproject(camera);
  const ray = {origin, direction: camera.getWorldDirection(new THREE.Vector3())};
  let best = null;
  seenBodies().forEach((body) => state.copies.forEach((copy) => pickCopy(body, copy, ray).forEach((hit) => {
    const cap = Boolean(hit.cap), bestCap = Boolean(best && best.cap), through = find("transparent").checked;
    if (!best || (through && cap && !bestCap) || ((!through || cap === bestCap) && hit.far < best.far)) best = hit;
  })));
  if (best) best.origin = origin;
  return best;
}

/* Value of a field at a hit. */
function valueAt(field, hit) {
  if (!isOfStep(field)) return NaN;
  const {body, triangle, weights} = hit;
  if (hit.cap) {
    if (field !== state.field) return NaN;
    const value = weights.reduce((sum, w, v) => sum + w * hit.cap.values[3 * triangle + v], 0);
    return value > 0.9 * NOTHING ? NaN : value;
  }
  if (field.at === "cell") return body.error ? body.error[triangle] : NaN;
  if (field.at === "contact" && body.pair[triangle] < 0) return NaN;
  return weights.reduce((sum, w, v) => sum + w * pointValue(field, body, body.from[body.corners[3 * triangle + v]]), 0);
}

function readHit(hit) {
  const field = state.field, face = hit.cap ? null : data.faces[hit.body.face[hit.triangle]];
  const read =
      {body: hit.body.name, face: face ? face.name : "", place: hit.position, inside: hit.inside, field: field.id};
  if (revolved) read.place[revolved.across] = 0;
  if (field.at === "kind") {
    const kind = kinds(field)[hit.cap ? hit.cap.values[3 * hit.triangle] : kindOf(field, hit.body, hit.triangle)];
    read.kind = kind ? (field.id === "role" ? kind.text : kind.name) : "";
  } else {
    const value = valueAt(field, hit);
    read.value = field.logarithmic ? 10 ** value : value;
  }
  return read;
}

/* Other values at the same point, where they are. */
function moreValues(hit) {
  if (hit.cap) return "";
  return ["von_mises", "displacement", "pressure"]
      .map((id) => fields.find((f) => f.id === id))
      .filter((f) => f && f !== state.field)
      .map((f) => [f, valueAt(f, hit)])
      .filter(([, value]) => !isNaN(value))
      .map(([f, value]) => "; " + f.name + " " + shown(value, f.unit))
      .join("");
}

function readAt(left, top) {
  const hit = pick(left, top), box = find("readout");
  state.picked = hit ? readHit(hit) : null;
  state.marker = hit ? {hit} : null;
  box.textContent = "";
  if (!hit) {
    box.textContent = "Nothing there. Click on a body: value, place, face.";
    return ask();
  }
  const read = state.picked, strong = document.createElement("b");
  const value = state.field.at === "kind" ? read.kind :
      isNaN(read.value)                   ? "no value here" :
                                            shown(read.value, state.field.unit, 5);
  strong.textContent = state.field.name + ": " + (value || "none");
  box.append(
      strong,
      ` at ${positionText(read.place)} ` + (read.inside ? `inside ${read.body}` : `on ${read.face || read.body}`) +
          (hit.copy === state.copies[0] ? "" : " (mirrored)") + moreValues(hit));
  ask();
}

function labelMarker() {
  if (!state.marker) return;
  const {hit} = state.marker, x = new THREE.Vector3();
  if (!hit.body.visible || !state.copies.includes(hit.copy) || (hit.cap && !hit.body.caps.includes(hit.cap)))
    return void (state.marker = null);
  hit.weights.forEach((w, v) => {
    const corner = hit.cap ? new THREE
                                 .Vector3(...[0, 1, 2].map(
                                     (k) => hit.cap.x[9 * hit.triangle + 3 * v + k] +
                                         state.factor * hit.cap.u[9 * hit.triangle + 3 * v + k]))
                                 .add(hit.body.shift) :
                             movedPoint(hit.body, hit.body.corners[3 * hit.triangle + v]);
    x.addScaledVector(corner, w);
  });
  const read = readHit(hit);
  label(
      state.field.at === "kind" ? read.kind || "none" :
          isNaN(read.value)     ? "no value" :
                                  shown(read.value, state.field.unit),
      x.applyMatrix4(hit.copy), "point");
}
