// The scenes that Plotly draws: the surface with its samples, and the sphere with their normals.

const column = (rows, k) => Float32Array.from({ length: rows.length / 3 }, (_, i) => rows[3 * i + k]);
const lifted = (rows, i, k, lift) => rows[3 * i + k] + lift * normals[3 * i + k] / data.aspect_factors[k];
const placed = (rows, which, lift = 0) => [0, 1, 2].map((k) => Float32Array.from(which, (i) => lifted(rows, i, k, lift)));
const ofKind = (k) => Array.from({ length: count }, (_, i) => i).filter((i) => kind[i] === k);

// A circle is drawn as some thirty triangles, a square as two.
const SYMBOL = count > 10000 ? "square" : "circle";

function markers([x, y, z], size, color) {
    return {
        type: "scatter3d", mode: "markers", x, y, z, hoverinfo: "skip", showlegend: false,
        marker: { size, color, symbol: SYMBOL, line: { width: 0 } },
    };
}

function mesh() {
    const colours = part && { facecolor: Array.from(faceOfTriangle, (f) => part.colours[f]) };
    return {
        ...colours, type: "mesh3d", x: column(vertices, 0), y: column(vertices, 1), z: column(vertices, 2),
        i: column(triangles, 0), j: column(triangles, 1), k: column(triangles, 2),
        color: theme.mesh, flatshading: data.flat, hoverinfo: "skip", showlegend: false,
        lighting: { // without a limit below which triangles have no normal
            ambient: 0.75, diffuse: 0.4, specular: 0.02, roughness: 0.9, facenormalsepsilon: 1e-15,
        },
    };
}

/** The edges of a part: lines with gaps. */
function edges() {
    const rows = decoded(part.edges, Float32Array);
    return { type: "scatter3d", mode: "lines", x: column(rows, 0), y: column(rows, 1), z: column(rows, 2),
        hoverinfo: "skip", showlegend: false, line: { color: "#333333", width: 2 } };
}

function globe() {
    const x = [], y = [], z = [];
    const add = (a, b, c) => { x.push(a); y.push(b); z.push(c); };
    const turn = Array.from({ length: 73 }, (_, k) => k * Math.PI / 36);
    for (let k = 0; k < 6; k++) {
        const [c, s] = [Math.cos(k * Math.PI / 6), Math.sin(k * Math.PI / 6)];
        for (const t of turn) add(c * Math.cos(t), s * Math.cos(t), Math.sin(t));
        add(null, null, null);
    }
    for (let k = -2; k <= 2; k++) {
        const [c, s] = [Math.cos(k * Math.PI / 6), Math.sin(k * Math.PI / 6)];
        for (const t of turn) add(c * Math.cos(t), c * Math.sin(t), s);
        add(null, null, null);
    }
    return { type: "scatter3d", mode: "lines", x, y, z, hoverinfo: "skip", showlegend: false,
        line: { color: theme.lines, width: 1.5 } };
}

function ball() {
    const x = [], y = [], z = [], i = [], j = [], k = [], M = 144, N = 72, r = 0.996; // round, and just inside of its lines
    for (let a = 0; a <= M; a++) {
        for (let b = 0; b <= N; b++) {
            const [t, s] = [2 * Math.PI * a / M, Math.PI * (b / N - 0.5)];
            x.push(r * Math.cos(s) * Math.cos(t)); y.push(r * Math.cos(s) * Math.sin(t)); z.push(r * Math.sin(s));
            if (a < M && b < N) {
                const p = a * (N + 1) + b, q = p + N + 1;
                i.push(p, p); j.push(q, q + 1); k.push(q + 1, p + 1);
            }
        }
    }
    return { type: "mesh3d", x, y, z, i, j, k, color: theme.ball, hoverinfo: "skip", showlegend: false,
        lighting: { ambient: 0.92, diffuse: 0.12, specular: 0 } };
}

const rowsOf = ({ x, y, z }) => x.flatMap((a, i) => [a, y[i], z[i]]);

// The diameter of samples in pixels. All discs together would cover an eighth of the frame.
const side = Math.min(byId("surface").clientWidth, byId("surface").clientHeight);
const size = Math.min(Math.max(side * Math.sqrt(0.5 / (Math.PI * count)), 1.4), 4);
const kinds = EACH.map(ofKind);
// These traces are never changed; selected samples are drawn over them, see highlights.js.
// Samples are lifted above the triangles, which would hide halves of them. Triangles of parts are coarser.
const LIFT = part ? 0.012 : 0.004;
const layers = {
    surface: [mesh(), ...kinds.map((which, k) => markers(placed(points, which, LIFT), size, PALE[k])),
        ...(part ? [edges()] : [])],
    // Markers of the first kind are larger and lie below the others: one normal may have samples of several kinds.
    sphere: [ball(), globe(), ...kinds.map((which, k) =>
        markers(placed(normals, which, k && LIFT), k ? size : 1.4 * size, PALE[k]))],
};

function layout(aspect, range, eye) {
    const axis = (k) => ({ visible: false, range: range[k], autorange: false });
    return {
        margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: "rgba(0,0,0,0)", hovermode: false, uirevision: "same",
        scene: {
            xaxis: axis(0), yaxis: axis(1), zaxis: axis(2), aspectmode: "manual",
            aspectratio: { x: aspect[0], y: aspect[1], z: aspect[2] }, hovermode: false,
            dragmode: "orbit", camera: { eye, projection: { type: "orthographic" } },
        },
    };
}

const EYE = { x: 1.0, y: -1.45, z: 0.95 };
// By default Plotly draws four times as many pixels, which is not needed for many samples.
const config = { displayModeBar: false, responsive: true, scrollZoom: true, plotGlPixelRatio: count > 10000 ? 1 : 2 };
const unit = [[-1.05, 1.05], [-1.05, 1.05], [-1.05, 1.05]];

// A picture fills this part of its frame; its scale is changed only by more than ENOUGH.
const FILLED = 0.94, ENOUGH = 0.01;

/** Scale a scene so that, with the current camera, its points (rows of three numbers) fill the frame. */
function fitted(plot, rows, aspect) {
    const box = plot.getBoundingClientRect(), matrix = camera(plot);
    let low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    for (let i = 0; i < rows.length; i += 3) {
        const at = onScreen(matrix, box, rows[i], rows[i + 1], rows[i + 2]);
        low = low.map((x, k) => Math.min(x, at[k]));
        high = high.map((x, k) => Math.max(x, at[k]));
    }
    // The extent is measured from the middle of the frame, about which the picture is turned.
    const half = [box.width / 2, box.height / 2];
    const reach = half.map((h, k) => Math.max(h - low[k], high[k] - h) / h);
    const factor = FILLED / Math.max(...reach);
    if (!(Math.abs(factor - 1) > ENOUGH) || !isFinite(factor)) return Promise.resolve();
    const [x, y, z] = aspect.map((a) => a * factor);
    return Plotly.relayout(plot, { "scene.aspectratio": { x, y, z } });
}
