/* Changes by the reader: controls, keys, pointer; the start. */

// ---- Changes ----

function setField(id) {
  const field = fields.find((f) => f.id === id);
  if (!field) return;
  state.field = field;
  find("field").value = id;
  const kind = field.at === "kind";
  if (shared.colours.value && shared.colours.value !== paletteTexture) shared.colours.value.dispose();
  shared.colours.value = kind ? kindTexture(kinds(field)) : paletteTexture;
  shared.texels.value = shared.colours.value.image.width;
  if (kind) shared.range.value.set(0, shared.texels.value - 1);
  shared.bands.value = !kind && find("bands").checked ? 10 : 0;
  refresh();
  if (state.zone >= 0)
    fitRange();
  else
    wholeRange();
}

/* Sets a field that the reader chose; one of the contact opens the bodies, whose faces hide it else. */
function chooseField(id) {
  const field = fields.find((f) => f.id === id);
  const zone = state.zone >= 0 ? state.zone : data.pairs.findIndex((pair) => pair.zone);
  if (field.needs === "contact" && zone >= 0 && !document.querySelector("#view-close .on[data-kind=face]"))
    showFace(zone, id);
  else
    setField(id);
}

/* New values of the field: another field, another step. */
function refresh() {
  state.extremes = null;
  state.largest = largestOf(state.field);
  bodies.forEach((body) => {
    body.geometry.attributes.value.array.set(cornerValues(body, state.field));
    body.geometry.attributes.value.needsUpdate = true;
  });
  build();
  drawColours();
}

function setSection(section) {
  if (section && Math.abs(section.coordinate) < ROUNDING * extent[section.axis]) section.coordinate = 0;
  state.section = section;
  shared.clipped.value = section ? 1 : 0;
  find("axis").value = section ? String(section.axis) : "";
  find("place").disabled = find("flip").disabled = !section;
  if (section) {
    const n = [0, 0, 0], distance = (section.coordinate - middle[section.axis]) / radius;
    n[section.axis] = section.side;
    shared.plane.value.set(...n, section.side * distance - (revolved ? BESIDE_PLANE : 0));
    find("place").value = (1000 * (section.coordinate - bounds.low[section.axis])) / extent[section.axis];
    find("flip").checked = section.side < 0;
    find("section-name").textContent = `${"xyz"[section.axis]} = ${shown(section.coordinate, "m", positionDigits())}`;
  } else
    find("section-name").textContent = "";
  build();
}

function readSection() {
  const axis = find("axis").value;
  if (axis === "") return setSection(null);
  const k = Number(axis), same = state.section && state.section.axis === k;
  const side = state.section && same ? (find("flip").checked ? -1 : 1) : Math.sign(firstEye()[k]) || 1;
  const fraction = same ? Number(find("place").value) / 1000 : 0.5;
  setSection({axis: k, coordinate: bounds.low[k] + fraction * extent[k], side});
}

function setFactor(factor) {
  state.factor = factor;
  shared.factor.value = factor;
  find("factor").value = factor;
  find("factor-name").textContent = factor === 0 ? "not shown" :
      factor === 1                               ? "at true scale" :
                                                   "× " + short(factor, 3);
  addArrows();
  ask();
}

function setStep(k) {
  state.step = k;
  find("step").value = k;
  find("step-name").textContent = steps[k].number + " of " + steps[lastStep].number;
  bodies.forEach((body, b) => {
    const step = steps[k].bodies[b];
    body.stress = step.stress;
    body.displacement = step.displacement;
    if (step.displacement) body.U = drawnMoves(step.displacement, body);
    body.geometry.attributes.moved.array.set(atCorners(body.U, body.corners));
    body.geometry.attributes.moved.needsUpdate = true;
    body.lines.attributes.moved.array.set(atCorners(body.U, body.edges));
    body.lines.attributes.moved.needsUpdate = true;
  });
  refresh();
}

function play() {
  const button = find("play");
  if (state.film) {
    clearInterval(state.film);
    state.film = null;
    button.textContent = "play";
    return;
  }
  button.textContent = "stop";
  state.film = setInterval(() => setStep((state.step + 1) % steps.length), 700);
}

function explode(amount) {
  const centre = centreOfBodies(), along = new THREE.Vector3(...[0, 1, 2].map((k) => (k === largestNormal() ? 1 : 0)));
  bodies.forEach((body, b) => {
    const way = body.centre.clone().sub(centre);
    if (way.length() < 0.05) way.copy(along).multiplyScalar(b - (bodies.length - 1) / 2);  // one inside of the other
    body.shift.copy(way.multiplyScalar(1.5 * amount));
  });
  addArrows();
  ask();
}

const largestNormal = () => {
  if (revolved) return revolved.axis;
  const pair = data.pairs.find((p) => p.zone);
  return pair ? pair.zone.axis : 2;
};
const centreOfBodies = () =>
    bodies.reduce((sum, body) => sum.add(body.centre), new THREE.Vector3()).divideScalar(bodies.length);

/* Mirrored copies: one for each set of planes. */
function mirror(on) {
  state.copies = [new THREE.Matrix4()];
  if (on)
    mirrors.forEach(({point, normal}) => {
      const n = new THREE.Vector3(...normal), d = n.dot(toView(point)), m = new THREE.Matrix4();
      m.set(
          1 - 2 * n.x * n.x, -2 * n.x * n.y, -2 * n.x * n.z, 2 * d * n.x, -2 * n.x * n.y, 1 - 2 * n.y * n.y,
          -2 * n.y * n.z, 2 * d * n.y, -2 * n.x * n.z, -2 * n.y * n.z, 1 - 2 * n.z * n.z, 2 * d * n.z, 0, 0, 0, 1);
      state.copies.push(...state.copies.map((copy) => new THREE.Matrix4().multiplyMatrices(m, copy)));
    });
  build();
}

/* Shows the half-plane of bodies of revolution alone, or what is swept. */
function showHalf(on) {
  layOut(on ? SLICE : SWEPT);
  data.faces.forEach((face) => (face.spread = face.normal = undefined));
  state.marker = null;
  bodies.forEach((body) => {
    body.geometry.dispose();
    body.lines.dispose();
    makeBody(body);
  });
  if (steps.length > 1)
    setStep(state.step);
  else
    refresh();
  explode(Number(find("explode").value));
  firstLook();
}

// ---- Once ----

/* Draws before the next picture of the screen. */
function ask() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    draw();
  });
}

function draw() {
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (!width || !height) return;
  const size = renderer.getSize(new THREE.Vector2());
  if (size.x !== width || size.y !== height) {
    renderer.setSize(width, height, false);
    camera.left = -width / height;
    camera.right = width / height;
    camera.updateProjectionMatrix();
  }
  camera.updateMatrixWorld();
  renderer.render(scene, camera);
  find("labels").textContent = "";
  plates = [];
  labelExtremes();
  labelMarker();
  labelNames();
  drawTriad();
  drawScale();
  clearTimeout(state.teller);
  state.teller = setTimeout(tellAbove, REST);
}

function option(value, text, parent) {
  const made = document.createElement("option");
  made.value = value;
  made.textContent = text;
  parent.appendChild(made);
}

function button(text, parent, use, more) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.addEventListener("click", use);
  Object.assign(made.dataset, more || {});
  parent.appendChild(made);
}

function fillControls() {
  fields.forEach((field) => option(field.id, field.name, find("field")));
  const zones = data.pairs.map((pair, k) => [pair, k]).filter(([pair]) => pair.zone);
  zones.forEach(([pair, k]) => {
    button(
        zones.length > 1 ? pair.name : "contact zone", find("close"), () => showZone(k), {kind: "section", pair: k});
    if (fields.some((f) => f.id === "pressure"))
      button(
          zones.length > 1 ? pair.name + ": pressure" : "its pressure", find("close"), () => showFace(k),
          {kind: "face", pair: k});
  });
  bodies.forEach((body) => {
    const line = document.createElement("label"), box = document.createElement("input"),
          square = document.createElement("i");
    box.type = "checkbox";
    box.checked = true;
    square.style.background = body.colour;
    line.append(box, square, body.name);
    box.addEventListener("change", () => {
      body.visible = box.checked;
      state.extremes = null;
      build();
      drawColours();
    });
    find("bodies").appendChild(line);
  });
  const most = Math.max(1, data.exaggeration);
  Object.assign(find("factor"), {max: most, step: most / 200});
  option(1, "1", find("true"));
  if (most === 1) find("picture").hidden = true;
  if (steps.length > 1) {
    find("steps").hidden = false;
    find("step").max = lastStep;
  }
  find("mirror-label").hidden = mirrors.length === 0;
  find("half-label").hidden = !revolved;
  find("full").hidden = !document.fullscreenEnabled;
  // Browsers would bring back what was set on the page before, without telling the view.
  document.querySelectorAll("#view-box input, #view-box select").forEach((box) => (box.autocomplete = "off"));
}

function listen() {
  const on = (id, event, use) => find(id).addEventListener(event, use);
  on("field", "change", () => chooseField(find("field").value));
  on("from", "change", readRange);
  on("to", "change", readRange);
  on("fit", "click", fitRange);
  on("all", "click", wholeRange);
  on("factor", "input", () => {
    state.ownFactor = true;
    const value = Number(find("factor").value), step = Number(find("factor").step);
    setFactor(value > 0 && Math.abs(value - 1) <= step / 2 ? 1 : value);
  });
  on("axis", "change", readSection);
  on("place", "input", readSection);
  on("flip", "change", readSection);
  on("explode", "input", () => explode(Number(find("explode").value)));
  ["transparent", "edges"].forEach((id) => on(id, "change", build));
  ["extremes", "names", "faces"].forEach((id) => on(id, "change", ask));
  on("arrows", "change", () => {
    addArrows();
    ask();
  });
  on("bands", "change", () => {
    shared.bands.value = find("bands").checked && state.field.at !== "kind" ? 10 : 0;
    paintBar();
    ask();
  });
  on("mirror", "change", () => {
    mirror(find("mirror").checked);
    firstLook();
  });
  on("half", "change", () => showHalf(find("half").checked));
  on("step", "input", () => setStep(Number(find("step").value)));
  on("play", "click", play);
  on("full", "click",
     () => (document.fullscreenElement ? document.exitFullscreen() : find("stage").requestFullscreen()));
  document.querySelectorAll("#view-box [data-factor]").forEach((b) => b.addEventListener("click", () => {
    state.ownFactor = true;
    setFactor(b.dataset.factor === "picture" ? data.exaggeration : Number(b.dataset.factor));
  }));
  document.querySelectorAll("#view-box [data-look]")
      .forEach((b) => b.addEventListener("click", () => goTo(b.dataset.look)));
  addEventListener("resize", ask);
  document.addEventListener("fullscreenchange", ask);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", ask);
  canvas.addEventListener("keydown", onKey);
  canvas.addEventListener("webglcontextrestored", ask);
  listenToPointer();
}

function goTo(name) {
  if (name === "whole") return showWhole();
  lookAlong(new THREE.Vector3(name === "x" ? 1 : 0, name === "y" ? -1 : 0, name === "z" ? 1 : 0));
}

function listenToPointer() {
  let start = null;
  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({preventScroll: true});
    start = event.isPrimary && event.button === 0 ? [event.offsetX, event.offsetY] : null;
  });
  canvas.addEventListener("pointerup", (event) => {
    if (start && Math.hypot(event.offsetX - start[0], event.offsetY - start[1]) < 4)
      readAt(event.offsetX, event.offsetY);
    start = null;
  });
}

/* The wheel zooms about the pointer once the view has been clicked on; before, it moves the page. */
function onWheel(event) {
  event.stopImmediatePropagation();
  if (document.activeElement !== canvas && document.fullscreenElement !== find("stage")) return;
  event.preventDefault();
  zoomBy(
      Math.exp(-0.0015 * event.deltaY * (event.deltaMode ? 16 : 1)), (2 * event.offsetX) / canvas.clientWidth - 1,
      1 - (2 * event.offsetY) / canvas.clientHeight);
}

function onKey(event) {
  const step = Math.PI / 36,
        arrow = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
  const zones = data.pairs.map((pair, k) => k).filter((k) => data.pairs[k].zone);
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (arrow) {
    if (event.shiftKey)
      shiftBy(0.1 * arrow[0], 0.1 * arrow[1]);
    else
      turn(-step * arrow[0], -step * arrow[1]);
  } else if (event.key === "+" || event.key === "=")
    zoomBy(1.2);
  else if (event.key === "-")
    zoomBy(1 / 1.2);
  else if (event.key === "0" || event.key === "Home")
    showWhole();
  else if (["x", "y", "z"].includes(event.key))
    goTo(event.key);
  else if (event.key === "c" && zones.length)
    showZone(zones[(zones.indexOf(state.zone) + 1) % zones.length]);
  else if (event.key === "Enter")
    readAt(canvas.clientWidth / 2, canvas.clientHeight / 2);
  else
    return;
  event.preventDefault();
}

/* False: there is no WebGL. */
function makeRenderer() {
  try {
    renderer = new THREE.WebGLRenderer({canvas, antialias: true, alpha: true, stencil: true});
  } catch (error) {
    return false;
  }
  renderer.setPixelRatio(Math.min(2, devicePixelRatio || 1));
  renderer.setClearColor(0, 0);
  return true;
}

function hasWebGl() {
  const probe = document.createElement("canvas");
  return Boolean(
      window.WebGLRenderingContext && (probe.getContext("webgl") || probe.getContext("experimental-webgl")));
}

function makeScene() {
  scene = new THREE.Scene();
  camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 2 * DISTANCE);
  camera.up.copy(sceneUp());
  camera.position.set(...firstEye()).multiplyScalar(DISTANCE);
  canvas.addEventListener("wheel", onWheel, {passive: false});
  controls = new THREE.OrbitControls(camera, canvas);
  Object.assign(controls, {enableKeys: false, screenSpacePanning: true, rotateSpeed: 0.8});
  controls.addEventListener("change", ask);
  controls.addEventListener("start", () => (state.turning = true));
  controls.addEventListener("end", () => {
    state.turning = false;
    ask();
  });
  paletteTexture = texture(bytesOf(data.palette), THREE.LinearFilter);
  shared.colours.value = paletteTexture;
  bodies.forEach(makeBody);
}

function start() {
  if (!hasWebGl() || !makeRenderer()) return;
  find("none").hidden = true;
  find("box").hidden = false;
  canvas.setAttribute("aria-label", "The bodies in three dimensions: " + data.alternative);
  makeScene();
  fillControls();
  listen();
  paintBar();
  setFactor(data.exaggeration);
  if (steps.length > 1) setStep(lastStep);
  setSection(null);
  setField(fields[0].id);
  firstLook();
  wholeRange();
  openOnZone();
}

/* Opens on the contact where one would see a dot of it else. */
function openOnZone() {
  const zones = data.pairs.map((pair, k) => k).filter((k) => data.pairs[k].zone);
  if (!zones.length || !zones.every((k) => zoneSize(data.pairs[k].zone) < SMALL_ZONE)) return;
  showZone(zones.reduce((a, b) => (zoneSize(data.pairs[b].zone) > zoneSize(data.pairs[a].zone) ? b : a)));
}

start();

/* Finds the lowest and highest coordinates of what is drawn, m. */
function boxOfBodies() {
  const box = bodies.reduce((all, body) => all.union(new THREE.Box3().setFromArray(body.X)), new THREE.Box3());
  return [box.min, box.max].map((x) => x.toArray().map((c, k) => c * radius + middle[k]));
}

/* For tests and for the curious: where a position (m) of a body is in the picture, and what is seen. */
window.cgcontactView = {
  project: (body, position) => toScreen(drawnPosition(bodies.find((b) => b.name === body), position).x),
  picked: () => state.picked,
  state: () => ({
    field: state.field.id,
    factor: state.factor,
    zoom: camera.zoom,
    eye: camera.position.clone().sub(controls.target).normalize().toArray(),
    target: controls.target.toArray(),
    low: plainValue(state.low),
    high: plainValue(state.high),
    section: state.section,
    zone: state.zone,
    step: state.step,
    copies: state.copies.length,
    triangles: bodies.reduce((sum, b) => sum + b.count, 0),
    sectors: revolved ? revolved.turns.length - 1 : 0,
    box: boxOfBodies()
  }),
};
