// The sample or the normal at a position in pixels.

function sampleAt(plot, x, y) {
    const front = frontOf(plot), viewer = towardsViewer(front.matrix);
    let least = 16, found = -1;
    for (let i = 0; i < count; i++) {
        const at = onScreen(front.matrix, front.box, points[3 * i], points[3 * i + 1], points[3 * i + 2]);
        const distance = Math.hypot(at[0] - x, at[1] - y);
        if (distance < least && isSeen(front, i, viewer)) [least, found] = [distance, i];
    }
    return found;
}

/** The index of the face of a part that is in front at the position x, y in pixels; −1 for none. */
function faceAt(plot, x, y) {
    const { width, found } = frontOf(plot), at = found[Math.round(y) * width + Math.round(x)];
    return at >= 0 ? faceOfTriangle[at] : -1;
}

function normalAt(plot, x, y) {
    // Newton's method for the point on the front of the sphere that is drawn at the position x, y in pixels.
    const matrix = camera(plot), box = plot.getBoundingClientRect();
    let best = null, least = Infinity, front = null;
    for (let a = 0; a < 72; a++) for (let b = 1; b < 36; b++) {
        const [t, s] = [a * Math.PI / 36, Math.PI * (b / 36 - 0.5)];
        const n = [Math.cos(s) * Math.cos(t), Math.cos(s) * Math.sin(t), Math.sin(s)];
        const at = onScreen(matrix, box, ...n), centre = onScreen(matrix, box, 0, 0, 0);
        if (at[2] > centre[2]) continue;
        const distance = Math.hypot(at[0] - x, at[1] - y);
        if (distance < least) [least, best, front] = [distance, n, at];
    }
    if (best === null) return null;
    for (let step = 0; step < 8; step++) {
        const at = onScreen(matrix, box, ...best);
        const [e, f] = frame(best), h = 1e-4;
        const [p, q] = [e, f].map((d) => onScreen(matrix, box, ...best.map((c, k) => c + h * d[k])));
        const [a, b, c, d] = [p[0] - at[0], q[0] - at[0], p[1] - at[1], q[1] - at[1]].map((v) => v / h);
        const determinant = a * d - b * c;
        if (Math.abs(determinant) < 1e-3 * (a * a + b * b + c * c + d * d)) break; // at the rim
        const [dx, dy] = [x - at[0], y - at[1]];
        const [u, v] = [(d * dx - b * dy) / determinant, (a * dy - c * dx) / determinant];
        best = unitVector(best.map((value, k) => value + u * e[k] + v * f[k]));
    }
    const at = onScreen(matrix, box, ...best);
    return Math.hypot(at[0] - x, at[1] - y) < 14 ? best : null;
}

const SNAP = 7; // pixels

/** The normal drawn within SNAP pixels of x, y; else, if all normals are prescribed, the nearest to n; else n. */
function snapped(plot, n, x, y) {
    const matrix = camera(plot), box = plot.getBoundingClientRect();
    let least = SNAP, highest = -2, drawn = null, nearest = null;
    for (let i = 0; i < count; i++) {
        const cosine = dot(i, n);
        if (cosine > highest) [highest, nearest] = [cosine, i];
        if (cosine < 0.9) continue;
        const at = onScreen(matrix, box, normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
        const distance = Math.hypot(at[0] - x, at[1] - y);
        if (distance < least) [least, drawn] = [distance, i];
    }
    const found = drawn ?? (prescribed.every((x) => x) ? nearest : null);
    return found === null ? n : [normals[3 * found], normals[3 * found + 1], normals[3 * found + 2]];
}
