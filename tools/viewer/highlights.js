// Selected samples, drawn over Plotly's pictures, since Plotly takes seconds to change one of many traces.
// Samples are discs, or circles where the surface is seen from behind. Hidden samples are not drawn, except
// the few large samples, which are empty circles if they are hidden.

const canvases = {};
const marks = { surface: { rows: points, parts: [] }, sphere: { rows: normals, parts: [], circle: null } };
let drawn = ""; // for which cameras, sizes and selection
let version = 0;

function highlight(parts, circle) {
    marks.surface.parts = marks.sphere.parts = parts;
    marks.sphere.circle = circle;
    version += 1;
}

/** Draw again whenever a camera has moved. This is polled: Plotly reports only some ways of moving it. */
function watch() {
    const seen = ["surface", "sphere"].map((name) => {
        const plot = byId(name), box = plot.getBoundingClientRect();
        return [camera(plot).join(), box.width, box.height].join();
    }).join() + version + devicePixelRatio;
    if (seen !== drawn) {
        drawn = seen;
        for (const name of ["surface", "sphere"]) paint(name);
    }
    requestAnimationFrame(watch);
}

function paint(name) {
    const plot = byId(name), box = plot.getBoundingClientRect(), matrix = camera(plot);
    const canvas = canvases[name] ??= plot.appendChild(document.createElement("canvas"));
    canvas.className = "over";
    [canvas.width, canvas.height] = [box.width, box.height].map((x) => Math.round(x * devicePixelRatio));
    const pen = canvas.getContext("2d");
    pen.scale(devicePixelRatio, devicePixelRatio);
    const { rows, parts, circle } = marks[name], viewer = towardsViewer(matrix);
    if (circle) paintCircle(pen, matrix, box, viewer, circle);
    const front = name === "surface" && parts.some((x) => x.which.length) ? frontOf(plot) : null;
    for (const { which, size } of parts) {
        for (const i of which) {
            const isHidden = front !== null && !isSeen(front, i, viewer), isLarge = size > 4;
            if (isHidden && !isLarge) continue;
            const [x, y] = onScreen(matrix, box, rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]);
            paintDisc(pen, x, y, size, COLOURS[kind[i]], isLarge, dot(i, viewer) > 0 && !isHidden, isHidden);
        }
    }
}

function paintDisc(pen, x, y, size, colour, isLarge, isFilled, isEmpty) {
    pen.beginPath();
    pen.arc(x, y, size, 0, 2 * Math.PI);
    pen.lineWidth = isLarge ? 2 : 1;
    pen.fillStyle = isFilled ? colour : "white";
    pen.strokeStyle = isFilled ? "white" : colour;
    if (!isEmpty) pen.fill();
    pen.stroke();
}

/** Draw the circle of the normals at an angle `degrees` from `normal`. */
function paintCircle(pen, matrix, box, viewer, { normal, degrees }) {
    const [e, f] = frame(normal), r = degrees * Math.PI / 180;
    pen.strokeStyle = theme.ink;
    let last = null;
    for (let t = 0; t <= 64; t++) {
        const [a, b] = [Math.sin(r) * Math.cos(t * Math.PI / 32), Math.sin(r) * Math.sin(t * Math.PI / 32)];
        const n = normal.map((x, k) => Math.cos(r) * x + a * e[k] + b * f[k]);
        const [x, y] = onScreen(matrix, box, ...n);
        if (last) {
            pen.beginPath();
            pen.lineWidth = n.reduce((sum, value, k) => sum + value * viewer[k], 0) > 0 ? 1.5 : 0.5;
            pen.moveTo(...last);
            pen.lineTo(x, y);
            pen.stroke();
        }
        last = [x, y];
    }
}
