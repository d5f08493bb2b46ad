// Which samples belong to a selected normal, and to a selected sample.

const NEAR = neighbours.length / count;
const EQUAL = 1e-6; // the rounding of float32, and some of that of sampling

/** Groups of samples that are connected in the graph of neighbours; if `oneKind`, only within one kind. */
function groups(members, oneKind) {
    const left = new Set(members), found = [];
    for (const first of members) {
        if (!left.delete(first)) continue;
        const group = [first];
        for (const i of group) {
            for (let k = 0; k < NEAR; k++) {
                const j = neighbours[NEAR * i + k];
                if (left.has(j) && !(oneKind && kind[i] !== kind[j])) {
                    left.delete(j);
                    group.push(j);
                }
            }
        }
        found.push(group);
    }
    return found;
}

const dot = (i, n) => normals[3 * i] * n[0] + normals[3 * i + 1] * n[1] + normals[3 * i + 2] * n[2];

/** The samples with normals within an angle of n (`members`), and the samples that light up (`best`). These are
 * the samples with exactly the normal n, if it is prescribed or several samples have it; otherwise the sample
 * nearest in normal of each group. */
function preimages(n, degrees) {
    const least = Math.cos(degrees * Math.PI / 180) - 1e-7, members = [];
    for (let i = 0; i < count; i++) if (dot(i, n) >= least) members.push(i);
    const away = (i) => Math.hypot(normals[3 * i] - n[0], normals[3 * i + 1] - n[1], normals[3 * i + 2] - n[2]);
    const equal = members.filter((i) => away(i) < EQUAL);
    if (equal.length > 1 || equal.some((i) => prescribed[i])) return { members, best: equal, exact: true };
    const best = groups(members, true).map((group) => group.reduce((a, b) => (away(b) < away(a) ? b : a)));
    return { members, best, exact: false };
}

function region(sample, radius) {
    const members = [], f = data.aspect_factors;
    const away = (i, k) => (points[3 * i + k] - points[3 * sample + k]) * f[k] / f[0];
    for (let i = 0; i < count; i++) {
        if (Math.hypot(away(i, 0), away(i, 1), away(i, 2)) <= radius) members.push(i);
    }
    return groups([sample, ...members.filter((i) => i !== sample)], false)[0];
}
