// The page: a selection on the surface lights up on the sphere, and a selection on the sphere
// lights up on the surface.

const MANY = 60; // the largest number of points with large dots
let state = null; // what is picked: {normal}, {sample} or {face}
const number = (x) => (Math.abs(x) < 5e-7 ? 0 : x).toPrecision(4).replace(/^-/, "−");
const triple = (x) => `(${x.map(number).join(", ")})`;
const many = (n, what) => `${n.toLocaleString("en")} ${what}${n === 1 ? "" : "s"}`;
const angle = () => Number(byId("angle").value);
const radius = () => Number(byId("radius").value) / 100;

function counted(which) {
    const numbers = EACH.map((k) => which.reduce((sum, i) => sum + (kind[i] === k), 0));
    return EACH.filter((k) => numbers[k]).map((k) => `${numbers[k].toLocaleString("en")} ${KINDS[k]}`).join(", ");
}

function show(members, best, circle) {
    const few = best.length > MANY ? [] : best; // as on planes
    highlight([{ which: members, size: Math.max(2, size) }, { which: few, size: 6 }], circle);
    window.picked = { members, best, face: state?.face, normal: circle && circle.normal }; // for tests
}

function update() {
    byId("angle-text").textContent = `normals within ${angle().toFixed(1)}°`;
    byId("radius-text").textContent = `radius ${number(radius() * data.diameter)}`;
    const result = byId("result");
    if (state === null) {
        result.textContent = `Pick a normal on the sphere, or a ${part ? "face of the part" : "place on the surface"}.`;
        show([], [], null);
    } else if (state.normal) {
        const { members, best, exact } = preimages(state.normal, angle());
        const within = `within ${angle().toFixed(1)}°`, have = best.length === 1 ? "has" : "have";
        result.textContent = `Normal ${triple(state.normal)}: ` + (!best.length
            ? `no sample has a normal ${within}.`
            : exact
                ? `${many(best.length, "sample")} ${have} exactly this normal: ${counted(best)}.`
                : `${many(best.length, "point")} ${have} this normal: ${counted(best)} `
                    + `(groups of the ${many(members.length, "sample")} ${within}).`);
        show(members, best, { normal: state.normal, degrees: angle() });
    } else if (state.face !== undefined) {
        const members = Array.from(faceOfSample.keys()).filter((i) => faceOfSample[i] === state.face);
        result.textContent = `${part.labels[state.face]}: ${many(members.length, "sample")}`
            + (members.length ? ` (${counted(members)}).` : ".");
        show(members, [], null);
    } else {
        const members = region(state.sample, radius());
        const place = [0, 1, 2].map((k) => data.centre[k] + data.diameter * points[3 * state.sample + k]);
        result.textContent = `Place ${triple(place)}: the Gaussian image of ${many(members.length, "sample")} `
            + `around it (${counted(members)}).`;
        show(members, [state.sample], null);
    }
}

function pickFace(x, y) {
    const face = faceAt(byId("surface"), x, y);
    state = face < 0 ? null : { face };
    soon();
}

function pickSample(x, y) {
    const sample = sampleAt(byId("surface"), x, y);
    state = sample < 0 ? null : { sample };
    soon();
}

function pickNormal(x, y) {
    const normal = normalAt(byId("sphere"), x, y);
    state = normal === null ? null : { normal: snapped(byId("sphere"), normal, x, y) };
    soon();
}

/** Call `action` for clicks and taps; with the brush or the shift key also while the pointer moves. */
function onPick(plot, action) {
    let down = null;
    const isBrush = (e) => byId("brush").checked || e.shiftKey;
    const at = (e) => { const box = plot.getBoundingClientRect(); action(e.clientX - box.left, e.clientY - box.top); };
    const stop = (e) => { e.stopPropagation(); e.preventDefault(); }; // Plotly would turn the picture
    plot.addEventListener("pointerdown", (e) => {
        down = e.isPrimary ? { x: e.clientX, y: e.clientY, brush: isBrush(e) } : null;
        if (down && down.brush) { stop(e); plot.setPointerCapture(e.pointerId); at(e); }
    }, true);
    plot.addEventListener("pointermove", (e) => { if (down && down.brush) { stop(e); at(e); } }, true);
    for (const kind of ["mousedown", "mousemove", "touchstart", "touchmove"]) {
        plot.addEventListener(kind, (e) => { if (down && down.brush) stop(e); }, { capture: true, passive: false });
    }
    window.addEventListener("pointerup", (e) => {
        if (down && e.isPrimary && !down.brush && Math.hypot(e.clientX - down.x, e.clientY - down.y) < 6) at(e);
        down = null;
    }, true);
}

const ROUND = [1.75, 1.75, 1.75];
let waiting = false;
function soon() { // at most once a frame
    if (!waiting) requestAnimationFrame(() => { waiting = false; update(); });
    waiting = true;
}

byId("region").hidden = Boolean(part); // a click takes a face
byId("angle").value = data.angle;
byId("radius").value = data.radius;
byId("angle").addEventListener("input", soon);
byId("radius").addEventListener("input", soon);
byId("clear").addEventListener("click", () => { state = null; update(); });
Promise.all([
    Plotly.newPlot("surface", layers.surface, layout(data.aspect, data.range, EYE), config),
    Plotly.newPlot("sphere", layers.sphere, layout(ROUND, unit, EYE), config),
]).then(() => Promise.all([
    fitted(byId("surface"), vertices, data.aspect),
    fitted(byId("sphere"), rowsOf(layers.sphere[0]), ROUND), // all of the sphere, whatever its normals
])).then(() => {
    onTheme(() => {
        Plotly.restyle("surface", { color: theme.mesh }, [0]);
        Plotly.restyle("sphere", { color: theme.ball }, [0]);
        Plotly.restyle("sphere", { "line.color": theme.lines }, [1]);
        version += 1;
    });
    onPick(byId("surface"), part ? pickFace : pickSample);
    onPick(byId("sphere"), pickNormal);
    update();
    watch();
    document.documentElement.dataset.ready = "yes";
});
