// three.js plays the clips of a .glb and has to agree with REFERENCE.animated.f64 on every vertex at every frame there.
//
//     node animation_threejs.mjs FILE.glb REFERENCE

import { readFile } from 'node:fs/promises';

// What three.js takes from a browser; the files carry no pictures.
globalThis.self = globalThis;
const THREE = await import('three');
const { GLTFLoader } = await import('three/addons/loaders/GLTFLoader.js');
const { MeshoptDecoder } = await import('three/addons/libs/meshopt_decoder.module.js');

const TOLERANCE = 1e-5; // metres; three.js keeps single precision
const [file, reference] = process.argv.slice(2);
const bytes = await readFile(file);
await MeshoptDecoder.ready;
const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
const gltf = await loader.parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
const clips = JSON.parse(await readFile(`${reference}.animated.json`, 'utf8'));
const raw = await readFile(`${reference}.animated.f64`);
const expected = new Float64Array(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.length));

let failed = false;
function report(name, good, why) {
  failed ||= !good;
  console.log(good ? `ok three.js: ${name}` : `FAILED three.js: ${name}: ${why}`);
}

// In the file's order, which is the order of the expected positions.
const node = (mesh) => {
  for (let o = mesh; o; o = o.parent) {
    const found = gltf.parser.associations.get(o)?.nodes;
    if (found !== undefined) return found;
  }
  return -1;
};
const meshes = [];
gltf.scene.traverse((object) => {
  if (object.isSkinnedMesh) meshes.push(object);
});
meshes.sort((a, b) => node(a) - node(b));

const names = gltf.animations.map((clip) => clip.name);
report('all clips', JSON.stringify(names) === JSON.stringify(clips.map((clip) => clip.name)), names.join(', '));
const mixer = new THREE.AnimationMixer(gltf.scene);
const point = new THREE.Vector3();
let at = 0;
for (const { name, rate, frames, taken, times } of clips) {
  const clip = THREE.AnimationClip.findByName(gltf.animations, name);
  const length = (frames - 1) / rate;
  report(`${name} lasts ${length.toFixed(3)} s`, Math.abs(clip?.duration - length) <= 1e-4, `${clip?.duration} s`);
  if (!clip) break;
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  let worst = 0;
  for (const time of times) {
    mixer.setTime(time);
    gltf.scene.updateMatrixWorld(true);
    for (const mesh of meshes) {
      mesh.skeleton.update();
      for (let i = 0; i < mesh.geometry.attributes.position.count; i += 1, at += 3) {
        mesh.getVertexPosition(i, point).applyMatrix4(mesh.matrixWorld);
        const off = Math.max(
          Math.abs(point.x - expected[at]), Math.abs(point.y - expected[at + 1]), Math.abs(point.z - expected[at + 2]));
        // A comparison with NaN is false: count it as the worst.
        if (!(off <= worst)) worst = Number.isNaN(off) ? Infinity : off;
      }
    }
  }
  action.stop();
  mixer.uncacheClip(clip);
  const shown = `${(worst * 1000).toFixed(6)} mm`;
  report(`${name} at frames ${taken.join(', ')} (largest difference ${shown})`, worst <= TOLERANCE,
    `${shown}, at most ${TOLERANCE * 1000} mm expected`);
}
report('all vertices compared', at === expected.length, `${at / 3} of ${expected.length / 3}`);
process.exit(failed ? 1 : 0);
