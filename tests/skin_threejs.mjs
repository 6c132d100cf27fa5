// three.js skins the library's arrays and has to agree on every position and normal.
//
//     node skin_threejs.mjs FOLDER
//
// FOLDER is what the example `skin_dump` wrote. three.js knows four influences and linear blending.

import { readFile } from 'node:fs/promises';

globalThis.self = globalThis;
const THREE = await import('three');

const TOLERANCE = 1e-5; // metres, and the length of a normal; three.js keeps single precision
const folder = process.argv[2];
const about = JSON.parse(await readFile(`${folder}/skin.json`, 'utf8'));
async function numbers(name, Kind) {
  const raw = await readFile(`${folder}/${name}`);
  return new Kind(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.length));
}

let failed = false;
function report(name, good, why) {
  failed ||= !good;
  console.log(good ? `ok three.js skins: ${name}` : `FAILED three.js skins: ${name}: ${why}`);
}

const positions = await numbers('positions.f32', Float32Array);
const normals = await numbers('normals.f32', Float32Array);
const geometry = new THREE.BufferGeometry();
geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
geometry.setAttribute('skinIndex', new THREE.BufferAttribute(await numbers('joints4.u16', Uint16Array), 4));
geometry.setAttribute('skinWeight', new THREE.BufferAttribute(await numbers('weights4.f32', Float32Array), 4));
const mesh = new THREE.SkinnedMesh(geometry);
const bones = about.names.map(() => new THREE.Bone());
mesh.add(...bones);

/** Seven numbers a joint: where it is, in model space. */
function place(joints) {
  bones.forEach((bone, j) => {
    bone.quaternion.fromArray(joints, 7 * j);
    bone.position.fromArray(joints, 7 * j + 4);
  });
  mesh.updateMatrixWorld(true);
}

place(await numbers('bind.f32', Float32Array));
mesh.bind(new THREE.Skeleton(bones));
const [point, start, normal] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
const distance = (vector, array, at) =>
  Math.max(Math.abs(vector.x - array[at]), Math.abs(vector.y - array[at + 1]), Math.abs(vector.z - array[at + 2]));
for (let p = 0; p < about.poses; p++) {
  place(await numbers(`pose${p}.f32`, Float32Array));
  mesh.skeleton.update();
  const expected = await numbers(`linear_4_pose${p}_positions.f32`, Float32Array);
  const expectedNormals = await numbers(`linear_4_pose${p}_normals.f32`, Float32Array);
  const worst = { positions: 0, normals: 0 };
  for (let i = 0, at = 0; at < positions.length; i++, at += 3) {
    mesh.applyBoneTransform(i, point.fromArray(positions, at));
    // The linear part, as the vertex shader has it: what it makes of a direction.
    mesh.applyBoneTransform(i, start.set(0, 0, 0));
    mesh.applyBoneTransform(i, normal.fromArray(normals, at));
    const offs = { positions: distance(point, expected, at), normals: distance(normal.sub(start).normalize(), expectedNormals, at) };
    for (const [what, off] of Object.entries(offs)) {
      // A comparison with NaN is false: count it as the worst.
      if (!(off <= worst[what])) worst[what] = Number.isNaN(off) ? Infinity : off;
    }
  }
  for (const [what, off] of Object.entries(worst)) {
    report(`${what} of pose${p} (largest difference ${(off * 1000).toFixed(6)} mm)`, off <= TOLERANCE, `at most ${TOLERANCE} expected`);
  }
}
process.exit(failed ? 1 : 0);
