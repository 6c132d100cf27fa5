// three.js reads a .glb, takes the pose of FILE.posed.json and has to agree with FILE.posed.f64 on every vertex.
//
//     node threejs.mjs FILE.glb

import { readFile } from 'node:fs/promises';

// What three.js takes from a browser; the files carry no pictures.
globalThis.self = globalThis;
const THREE = await import('three');
const { GLTFLoader } = await import('three/addons/loaders/GLTFLoader.js');

const TOLERANCE = 1e-5; // metres; three.js keeps single precision
const file = process.argv[2];
const bytes = await readFile(file);
const gltf = await new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
const { rotations } = JSON.parse(await readFile(`${file}.posed.json`, 'utf8'));
const raw = await readFile(`${file}.posed.f64`);
const expected = new Float64Array(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.length));

let failed = false;
function report(name, good, why) {
  failed ||= !good;
  console.log(good ? `ok three.js: ${name}` : `FAILED three.js: ${name}: ${why}`);
}

for (const [name, turn] of Object.entries(rotations)) {
  const joint = gltf.scene.getObjectByName(name);
  report(`has joint ${name}`, joint?.isBone, 'no bone of that name');
  joint?.quaternion.multiply(new THREE.Quaternion(...turn));
}
gltf.scene.updateMatrixWorld(true);

// In the file's order, which is the order of the expected positions.
const meshes = [];
gltf.scene.traverse((object) => {
  if (object.isSkinnedMesh) meshes.push([gltf.parser.associations.get(object), object]);
});
const node = (mesh) => {
  for (let o = mesh; o; o = o.parent) {
    const found = gltf.parser.associations.get(o)?.nodes;
    if (found !== undefined) return found;
  }
  return -1;
};
meshes.sort(([a, x], [b, y]) => node(x) - node(y) || a.primitives - b.primitives);
let at = 0;
const point = new THREE.Vector3();
for (const [, mesh] of meshes) {
  mesh.skeleton.update();
  let worst = 0;
  const count = mesh.geometry.attributes.position.count;
  for (let i = 0; i < count; i++, at += 3) {
    mesh.getVertexPosition(i, point).applyMatrix4(mesh.matrixWorld);
    const off = Math.max(
      Math.abs(point.x - expected[at]), Math.abs(point.y - expected[at + 1]), Math.abs(point.z - expected[at + 2]));
    // A comparison with NaN is false: count it as the worst.
    if (!(off <= worst)) worst = Number.isNaN(off) ? Infinity : off;
  }
  const shown = `${(worst * 1000).toFixed(6)} mm`;
  report(`${mesh.name} posed (largest difference ${shown})`, worst <= TOLERANCE, `at most ${TOLERANCE * 1000} mm expected`);
}
report('all vertices compared', at === expected.length, `${at / 3} of ${expected.length / 3}`);
process.exit(failed ? 1 : 0);
