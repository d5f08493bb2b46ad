// The projection of points of the scene to pixels.

function product(a, b) { // of matrices by columns
    const c = new Float64Array(16);
    for (let i = 0; i < 4; i++) for (let j = 0; j < 4; j++)
        for (let k = 0; k < 4; k++) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
    return c;
}

function camera(plot) {
    // Plotly's matrices. They are not documented; tests of this page click on points at known positions.
    const scene = plot._fullLayout.scene._scene;
    const { model, view, projection } = scene.glplot.cameraParams;
    const scale = Float64Array.of(
        scene.dataScale[0], 0, 0, 0, 0, scene.dataScale[1], 0, 0, 0, 0, scene.dataScale[2], 0, 0, 0, 0, 1);
    return product(product(projection, view), product(model, scale));
}

function onScreen(matrix, box, x, y, z) {
    const at = (i) => matrix[i] * x + matrix[4 + i] * y + matrix[8 + i] * z + matrix[12 + i];
    const w = at(3);
    return [box.width * (1 + at(0) / w) / 2, box.height * (1 - at(1) / w) / 2, at(2) / w];
}

/** The direction towards the viewer, in the coordinates of the scene. */
function towardsViewer(matrix) {
    const row = (i) => [matrix[i], matrix[4 + i], matrix[8 + i]];
    const direction = cross(row(0), row(1)); // along it nothing moves on the screen
    const depth = row(2).reduce((sum, x, k) => sum + x * direction[k], 0);
    return direction.map((x) => (depth < 0 ? x : -x));
}

const unitVector = (v) => v.map((x) => x / Math.hypot(...v));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
function frame(n) {
    const e = unitVector(cross(n, Math.abs(n[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
    return [e, cross(n, e)];
}
