// What is in front on the screen: the nearest triangle at each pixel, and which samples are hidden.

/** The depth and the index of the triangle that is in front at each pixel; Infinity and −1 without one. */
function frontOf(plot) {
    const matrix = camera(plot), box = plot.getBoundingClientRect();
    const width = Math.ceil(box.width) + 1, height = Math.ceil(box.height) + 1;
    const depths = new Float32Array(width * height).fill(Infinity);
    const found = new Int32Array(width * height).fill(-1);
    const seen = new Float64Array(vertices.length);
    for (let i = 0; i < vertices.length; i += 3) {
        seen.set(onScreen(matrix, box, vertices[i], vertices[i + 1], vertices[i + 2]), i);
    }
    const ends = (a, b, c, most) => // whole numbers between three
        [Math.max(0, Math.ceil(Math.min(a, b, c))), Math.min(most, Math.floor(Math.max(a, b, c)))];
    for (let t = 0; t < triangles.length; t += 3) {
        const [i, j, k] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
        const x = seen[i], y = seen[i + 1], z = seen[i + 2];
        const bx = seen[j] - x, by = seen[j + 1] - y, cx = seen[k] - x, cy = seen[k + 1] - y;
        const area = bx * cy - by * cx;
        if (!area) continue;
        const [left, right] = ends(x, x + bx, x + cx, width - 1), [top, bottom] = ends(y, y + by, y + cy, height - 1);
        for (let row = top; row <= bottom; row++) for (let column = left; column <= right; column++) {
            const b = ((column - x) * cy - (row - y) * cx) / area, c = (bx * (row - y) - by * (column - x)) / area;
            if (b < -BESIDE || c < -BESIDE || b + c > 1 + BESIDE) continue;
            const depth = z + b * (seen[j + 2] - z) + c * (seen[k + 2] - z), at = row * width + column;
            if (depth < depths[at]) [depths[at], found[at]] = [depth, t / 3];
        }
    }
    return { matrix, box, width, height, depths, found };
}

const BESIDE = 1e-9; // so that a pixel on the common side of two triangles is inside of one of them

/** Whether a sample is visible. It is lifted to the side of the viewer: a thin sheet hides no samples of its own. */
function isSeen(front, i, viewer) {
    const side = dot(i, viewer) < 0 ? -LIFT : LIFT; // it is drawn above the triangles, too
    const [x, y, depth] = onScreen(front.matrix, front.box, lifted(points, i, 0, side), lifted(points, i, 1, side),
        lifted(points, i, 2, side));
    // Between four pixels, a triangle is nowhere deeper than at the deepest of the four.
    const column = Math.floor(x), row = Math.floor(y), { width, height, depths } = front;
    if (column < 0 || row < 0 || column > width - 2 || row > height - 2) return true;
    const at = row * width + column;
    return depth <= Math.max(depths[at], depths[at + 1], depths[at + width], depths[at + width + 1]);
}
