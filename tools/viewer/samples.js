// The data of samples and their normals. These scripts handle clicks themselves: Plotly reports clicks in
// three dimensions when a button goes down, before it is known whether the user turns the picture, and not
// at all on touch screens.
const data = JSON.parse(document.getElementById("data").textContent);
const byId = (name) => document.getElementById(name);

function decoded(text, Type) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    return new Type(bytes.buffer);
}

const points = decoded(data.points, Float32Array); // scaled to a diameter of 1
const normals = decoded(data.normals, Float32Array);
const prescribed = decoded(data.prescribed, Uint8Array); // samples at prescribed normals
const neighbours = decoded(data.neighbours, Int32Array);
const kind = decoded(data.kind, Uint8Array); // an index of KINDS for each sample
const count = kind.length;
const COLOURS = data.colours, PALE = data.pale;
const KINDS = ["elliptic", "hyperbolic", "parabolic"], EACH = [0, 1, 2];
const vertices = decoded(data.vertices, Float32Array), triangles = decoded(data.triangles, Int32Array);
const part = data.part; // of samples of a CAD part
const faceOfTriangle = part && decoded(part.of_triangles, Int32Array);
const faceOfSample = part && decoded(part.of_samples, Int32Array);
