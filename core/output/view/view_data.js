/* Data of the view, which core/output/view/output_view.cpp writes, as bodies and fields. The files of this folder are
   one script, in the order of cmake/View.cmake. Lengths of the scene are made units of its half diagonal; values stay
   in SI. */

const find = (id) => document.getElementById("view-" + id);
const ABOVE = [0.82, 0.12, 0.78];  // colour of values above the bar
const BELOW = [0.1, 0.1, 0.22];    // and below it
const NOTHING = 1e30;              // a value that is none, for the shader
const CODE_NONE = 65535;           // the same, packed
const SMALL_ZONE = 0.2;            // of the scene's diagonal: the view opens on a smaller zone
const BESIDE = 0.05;               // of its extent: a zone so near to a side of the scene reaches it
const BEHIND = 0.01;               // of half the scene's diagonal: a point so far behind what is drawn is not seen
const ROUNDING = 1e-7;             // of what is largest: less is shown as 0
const ALIKE = 1e-4;                // of the larger one: values that differ by less are one colour
const SAME_PLANE = 1e-4;           // of half the scene's diagonal: positions are rounded
const MOST_MIRRORS = 4;            // planes of symmetry: each doubles what is drawn
const LONGEST_LABEL = 60;          // letters
const REST = 150;                  // ms without change, until what takes time is told anew
const DISTANCE = 20;               // of the camera; the scene, also apart and mirrored, is well within
const BESIDE_PLANE = 5e-7;         // fraction of half the diagonal: cuts off the open planes that lie in a section

// ---- Unpacking ----

function bytesOf(text) {
  const letters = atob(text), bytes = new Uint8Array(letters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = letters.charCodeAt(i);
  return bytes;
}

/* Rows of 16-bit numbers as values; NaN where there is none. */
function unpack(packed) {
  if (!packed) return null;
  const bytes = bytesOf(packed.data), columns = packed.low.length, values = new Float64Array(bytes.length / 2);
  for (let i = 0; i < values.length; ++i) {
    const code = bytes[2 * i] + 256 * bytes[2 * i + 1], k = i % columns;
    values[i] = code === CODE_NONE ? NaN : packed.low[k] + packed.step[k] * code;
  }
  return values;
}

function varints(text) {
  const bytes = bytesOf(text), numbers = [];
  for (let i = 0; i < bytes.length; ++i) {
    let number = 0, shift = 0;
    for (; bytes[i] & 128; ++i, shift += 7) number |= (bytes[i] & 127) << shift;
    numbers.push(number | (bytes[i] << shift));
  }
  return numbers;
}

/* Each number is a distance below the lowest point not used before. */
function unpackCorners(text) {
  let next = 0;
  return Uint32Array.from(varints(text), (far) => {
    if (far === 0) return next++;
    return next - far;
  });
}

function unpackAscending(text) {
  let last = 0;
  return varints(text).map((step) => (last += step));
}

// ---- The bodies ----

const data = JSON.parse(find("data").textContent);
const bounds = {
  low: [Infinity, Infinity, Infinity],
  high: [-Infinity, -Infinity, -Infinity]
};

function readBody(packed, index) {
  const body =
      {index: index, name: packed.name, colour: packed.colour, visible: true, extremes: packed.extremes || {}};
  body.position = unpack(packed.position);
  body.displacement = unpack(packed.displacement);
  body.stress = unpack(packed.stress);
  body.read = {corners: unpackCorners(packed.triangles), error: unpack(packed.error)};
  body.read.status = packed.status ? bytesOf(packed.status) : null;
  readGroups(packed, body.read);
  readContact(packed, body);
  body.inside = readInside(packed.inside);
  for (let i = 0; i < body.position.length; ++i) {
    bounds.low[i % 3] = Math.min(bounds.low[i % 3], body.position[i]);
    bounds.high[i % 3] = Math.max(bounds.high[i % 3], body.position[i]);
  }
  return body;
}

function readGroups(packed, read) {
  const count = read.corners.length / 3;
  read.surface = new Int32Array(count);
  read.face = new Int32Array(count);
  read.pair = new Int32Array(count);
  read.closed = new Uint8Array(count);
  let t = 0;
  packed.groups.forEach(([surface, face, pair, closed, count]) => {
    for (const end = t + count; t < end; ++t) {
      read.surface[t] = surface;
      read.face[t] = face;
      read.pair[t] = pair;
      read.closed[t] = closed;
    }
  });
}

/* Of a point of a contact face: gap, pressure, its error; shear, slip, wear. */
const CONTACT_COLUMNS = 6;

function readContact(packed, body) {
  if (!packed.contact) return;
  const points = unpackAscending(packed.contact.points), values = unpack(packed.contact.values);
  const columns = values.length / points.length;  // fewer without friction
  body.contact = new Float64Array(packed.points * CONTACT_COLUMNS).fill(NaN);
  points.forEach((point, i) => {
    for (let k = 0; k < columns; ++k) body.contact[CONTACT_COLUMNS * point + k] = values[columns * i + k];
  });
  if (columns === CONTACT_COLUMNS) body.friction = body.contact;
}

function readInside(packed) {
  const inside = {position: unpack(packed.position), displacement: unpack(packed.displacement)};
  inside.stress = unpack(packed.stress);
  inside.read = {blocks: unpackCorners(packed.blocks), error: unpack(packed.error)};
  inside.read.status = packed.status ? bytesOf(packed.status) : null;
  return inside;
}

/* Coordinates of bodies of revolution about `axis`: the data has their section in the half-plane across = 0,
   radial >= 0 as a thin slab, which is looked at from its `side`. */
const revolved = data.axis < 0 ? null : {
  axis: data.axis,
  radial: (data.axis + 1) % 3,
  across: (data.axis + 2) % 3,
  side: Math.sign(data.eye[(data.axis + 2) % 3]),
  turns: [],
};
const bodies = data.bodies.map(readBody);
if (revolved) {
  const reach = bounds.high[revolved.radial];
  [revolved.radial, revolved.across].forEach((k) => [bounds.low[k], bounds.high[k]] = [-reach, reach]);
}
const middle = [0, 1, 2].map((k) => (bounds.low[k] + bounds.high[k]) / 2);
const extent = [0, 1, 2].map((k) => bounds.high[k] - bounds.low[k]);
const radius = Math.hypot(...extent) / 2 || 1;
const steps = data.steps.map(
    (step) => ({
      number: step.number,
      bodies: step.bodies.map((b) => ({displacement: unpack(b.displacement), stress: unpack(b.stress)})),
    }));
const lastStep = steps.length - 1;

const toView = (x) =>
    new THREE.Vector3((x[0] - middle[0]) / radius, (x[1] - middle[1]) / radius, (x[2] - middle[2]) / radius);

function scaledPositions(positions, moved) {
  const scaled = new Float32Array(positions.length);
  for (let i = 0; i < scaled.length; ++i) scaled[i] = (positions[i] - (moved ? 0 : middle[i % 3])) / radius || 0;
  return scaled;
}

// ---- What is drawn of it ----

/* Makes the drawn points and triangles: those read, or sections swept by an angle. Values stay those of the points
   read: `from` has these by drawn point, `turn` the number of its angle. */
function layOut(angle) {
  if (revolved) setTurns(angle);
  bodies.forEach((body) => {
    const inside = body.inside;
    if (revolved) {
      sweepBoundary(body);
      sweepInside(inside);
    } else
      [body, inside].forEach((owner) => {
        Object.assign(owner, owner.read);
        owner.from = Uint32Array.from({length: owner.position.length / 3}, (_, p) => p);
      });
    body.count = body.corners.length / 3;
    [body, inside].forEach((owner) => {
      owner.X = scaledPositions(drawn(owner.position, owner), false);
      owner.U = drawnMoves(owner.displacement, owner);
    });
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < body.X.length; ++i) {
      low[i % 3] = Math.min(low[i % 3], body.X[i]);
      high[i % 3] = Math.max(high[i % 3], body.X[i]);
    }
    body.centre = new THREE.Vector3(...low.map((l, k) => (l + high[k]) / 2));
  });
}

/* Turns vectors of the points read (positions, displacements) to where the points are drawn. */
function drawn(vectors, owner) {
  if (!revolved) return vectors;
  const {axis, radial, across, turns} = revolved, turned = new Float64Array(3 * owner.from.length);
  for (let i = 0; i < owner.from.length; ++i) {
    const p = 3 * owner.from[i], [cosine, sine] = turns[owner.turn[i]];
    turned[3 * i + axis] = vectors[p + axis];
    turned[3 * i + radial] = cosine * vectors[p + radial];
    turned[3 * i + across] = sine * vectors[p + radial];
  }
  return turned;
}

const drawnMoves = (displacement, owner) =>
    displacement ? scaledPositions(drawn(displacement, owner), true) : new Float32Array(3 * owner.from.length);

bodies.forEach((body) => (body.shift = new THREE.Vector3()));
layOut(SWEPT);

/* Planes of symmetry at which the scene is mirrored: those with all bodies on one side. */
const mirrors = data.symmetry
                    .filter(({point, normal}) => bodies.every((body) => {
                      const origin = toView(point).toArray();
                      for (let i = 0; i < body.X.length; i += 3) {
                        const height = normal.reduce((sum, n, k) => sum + n * (body.X[i + k] - origin[k]), 0);
                        if (height > SAME_PLANE) return false;
                      }
                      return true;
                    }))
                    .slice(0, MOST_MIRRORS);

// ---- Fields ----

function vonMises(s, i) {
  const a = s[i] - s[i + 1], b = s[i + 1] - s[i + 2], c = s[i + 2] - s[i];
  return Math.sqrt((a * a + b * b + c * c) / 2 + 3 * (s[i + 3] ** 2 + s[i + 4] ** 2 + s[i + 5] ** 2));
}

/* Principal stresses, largest first; components xx, yy, zz, xy, yz, zx. */
function principal(s, i) {
  const [xx, yy, zz, xy, yz, zx] = [s[i], s[i + 1], s[i + 2], s[i + 3], s[i + 4], s[i + 5]];
  const mean = (xx + yy + zz) / 3, a = xx - mean, b = yy - mean, c = zz - mean;
  const size = Math.sqrt((a * a + b * b + c * c + 2 * (xy * xy + yz * yz + zx * zx)) / 6);
  if (!(size > 0)) return [mean, mean, mean];
  const det = (a * (b * c - yz * yz) - xy * (xy * c - yz * zx) + zx * (xy * yz - b * zx)) / size ** 3;
  const angle = Math.acos(Math.max(-1, Math.min(1, det / 2))) / 3;
  const first = mean + 2 * size * Math.cos(angle), third = mean + 2 * size * Math.cos(angle + (2 * Math.PI) / 3);
  return [first, 3 * mean - first - third, third];
}

const stressField = (id, name, of) =>
    ({id, name, unit: "Pa", at: "point", needs: "stress", of: (o, p) => of(o.stress, 6 * p)});
const moveField = (id, name, of) =>
    ({id, name, unit: "m", at: "point", needs: "displacement", of: (o, p) => of(o.displacement, 3 * p)});
const contactField = (id, name, unit, k, needs = "contact") =>
    ({id, name, unit, at: "contact", needs, of: (o, p) => o.contact[CONTACT_COLUMNS * p + k]});

/* Components by name: those of a body of revolution are the same at each angle; the others are zero. */
const letters = ["x", "y", "z"];
const stressComponents = ["xx", "yy", "zz", "xy", "yz", "zx"].map((name, k) => ["stress_" + name, "stress " + name, k]);
const moveComponents = letters.map((name, k) => ["displacement_" + name, "displacement " + name, k]);
if (revolved) {
  const {axis, radial, across} = revolved, a = letters[axis];
  stressComponents.splice(
      0, 6, ["stress_rr", "stress rr (radial)", radial], ["stress_tt", "stress tt (around the axis)", across],
      ["stress_" + a + a, `stress ${a}${a} (axial)`, axis], ["stress_r" + a, `stress r${a} (shear)`, 3 + axis]);
  moveComponents.splice(
      0, 3, ["displacement_r", "displacement r (radial)", radial],
      ["displacement_" + a, `displacement ${a} (axial)`, axis]);
}

const withFriction = bodies.some((body) => body.friction);
const fields = [
  stressField("von_mises", "von Mises stress", vonMises),
  stressField(
      "tresca", "Tresca stress",
      (s, i) => {
        const p = principal(s, i);
        return p[0] - p[2];
      }),
  stressField("principal_1", "largest principal stress", (s, i) => principal(s, i)[0]),
  stressField("principal_2", "middle principal stress", (s, i) => principal(s, i)[1]),
  stressField("principal_3", "smallest principal stress", (s, i) => principal(s, i)[2]),
  ...stressComponents.map(([id, name, k]) => stressField(id, name, (s, i) => s[i + k])),
  moveField("displacement", "displacement", (u, i) => Math.hypot(u[i], u[i + 1], u[i + 2])),
  ...moveComponents.map(([id, name, k]) => moveField(id, name, (u, i) => u[i + k])),
  contactField("pressure", "contact pressure", "Pa", 1),
  contactField("gap", "contact gap", "m", 0),
  contactField("pressure_error", "estimated error of the contact pressure", "Pa", 2),
  contactField("shear", "friction: shear", "Pa", 3, "friction"),
  contactField("slip", "friction: slip", "m", 4, "friction"),
  contactField("wear", "friction: wear (pressure times slip)", "J/m²", 5, "friction"),
  {
    id: "error",
    name: "estimated error of the stress (of a cell)",
    unit: "Pa",
    at: "cell",
    needs: "error",
    logarithmic: true
  },
  {id: "status", name: "status of the patches", at: "kind", needs: "status"},
  {id: "closed", name: withFriction ? "contact: closed, slips, open" : "contact: closed, open", at: "kind", needs: "contact"},
  {id: "role", name: "supports, loads, contact", at: "kind"},
  {id: "bodies", name: "bodies", at: "kind"},
].filter((field) => !field.needs || bodies.some((body) => body[field.needs]));

/* Of the contact, and their numbers by what the data say: open, closed, closed and slips. */
const contactKinds = [{name: "closed", colour: "#c8553d"}, {name: "open", colour: "#7fb2d9"}];
if (withFriction) contactKinds.splice(1, 0, {name: "closed, slips", colour: "#e9b44c"});
const kindOfContact = [contactKinds.length - 1, 0, 1];

const kindColours = ["#4e9a51", "#e9b44c", "#c8553d", "#8f5fa8", "#3d7ea6", "#d98cb3", "#7a6a58", "#2f9e94"];

/* Index into kinds() of a triangle, or -1. */
function kindOf(field, body, triangle) {
  if (field.id === "status") return body.status ? body.status[triangle] : -1;
  if (field.id === "closed") return body.pair[triangle] < 0 ? -1 : kindOfContact[body.closed[triangle]];
  if (field.id === "role") return body.face[triangle];
  return body.index;
}

function kinds(field) {
  if (field.id === "status") return data.status_names.map((name, k) => ({name, colour: kindColours[k % 8]}));
  if (field.id === "closed") return contactKinds;
  if (field.id === "role") return data.faces;
  return bodies;
}

/* Steps before the last one have displacements and stresses only. */
const isOfStep = (field) => state.step === lastStep || field.at === "point" || !field.needs;

/* Value of a field at a point read of a boundary (or inside), NaN: none. */
function pointValue(field, owner, p) {
  return owner[field.needs] ? field.of(owner, p) : NaN;
}

/* Values of a boundary's corners (three for each triangle) as the shader gets them. */
function cornerValues(body, field) {
  const values = new Float32Array(3 * body.count).fill(NOTHING);
  if (!isOfStep(field)) return values;
  if (field.at === "point" || field.at === "contact") {
    const points = new Float32Array(body.position.length / 3);
    for (let p = 0; p < points.length; ++p) points[p] = pointValue(field, body, p);
    for (let t = 0; t < body.count; ++t) {
      if (field.at === "contact" && body.pair[t] < 0) continue;
      const three = [0, 1, 2].map((k) => points[body.from[body.corners[3 * t + k]]]);
      if (!three.some(isNaN)) values.set(three, 3 * t);  // a colour between a value and none would be any
    }
    return values;
  }
  for (let t = 0; t < body.count; ++t) {
    const value = field.at === "cell" ? (body.error ? body.error[t] : NaN) : kindOf(field, body, t);
    if (!isNaN(value) && (field.at === "cell" || value >= 0)) values.fill(value, 3 * t, 3 * t + 3);
  }
  return values;
}

// ---- Numbers for people ----

const UNITS = {
  Pa: [[1e9, "GPa"], [1e6, "MPa"], [1e3, "kPa"], [1, "Pa"]],
  m: [[1, "m"], [1e-3, "mm"], [1e-6, "µm"]],
  "J/m²": [[1e6, "MJ/m²"], [1e3, "kJ/m²"], [1, "J/m²"], [1e-3, "mJ/m²"]]
};

function unitFor(kind, size) {
  const list = UNITS[kind];
  return list.find(([factor]) => size >= (kind === "m" && factor === 1 ? 1 : factor)) || list[list.length - 1];
}

function short(value, digits) {
  if (!isFinite(value)) return "-";
  const text = value.toPrecision(digits || 4);
  return text.includes("e") ? String(Number(text)).replace("e+", "e") : String(Number(text));
}

function shown(value, kind, digits) {
  if (!kind) return short(value, digits);
  if (value === 0) return "0";
  const [factor, name] = unitFor(kind, Math.abs(value));
  return short(value / factor, digits) + " " + name;
}

function positionText(x) {
  const size = Math.max(...bounds.low.map(Math.abs), ...bounds.high.map(Math.abs));
  const [factor, name] = unitFor("m", size);
  const told = revolved ? [x[revolved.radial], x[revolved.axis]] : x;
  return (revolved ? `(r, ${letters[revolved.axis]}) = (` : "(") +
      told.map((c) => short(Math.abs(c) < 2e-5 * radius ? 0 : c / factor, positionDigits())).join(", ") + ") " + name;
}

/* As many digits as tell positions in the scene apart, also far from the origin. */
function positionDigits() {
  const size = Math.max(...bounds.low.map(Math.abs), ...bounds.high.map(Math.abs));
  return 5 + Math.max(0, Math.min(10, Math.floor(Math.log10(size / (2 * radius)))));
}
