// three.js plays the weights of morph targets and has to agree on every weight and vertex.
//
//     node morph_threejs.mjs FOLDER FILE.glb
//
// FOLDER is what the example `morph_dump` wrote, FILE a name in it.

import { readFile } from 'node:fs/promises';

// What three.js takes from a browser; the files carry no pictures.
globalThis.self = globalThis;
const THREE = await import('three');
const { GLTFLoader } = await import('three/addons/loaders/GLTFLoader.js');
const { MeshoptDecoder } = await import('three/addons/libs/meshopt_decoder.module.js');

const TOLERANCE = 1e-5; // metres; three.js keeps single precision
const WEIGHT_TOLERANCE = 1e-6;
const [folder, file] = process.argv.slice(2);
const bytes = await readFile(`${folder}/${file}`);
await MeshoptDecoder.ready;
const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
const gltf = await loader.parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
const expected = JSON.parse(await readFile(`${folder}/morph.json`, 'utf8'));

let failed = false;
function report(name, good, why) {
  failed ||= !good;
  console.log(good ? `ok three.js, ${file}: ${name}` : `FAILED three.js, ${file}: ${name}: ${why}`);
}

const meshes = new Map();
gltf.scene.traverse((object) => {
  if (object.isMesh && object.morphTargetInfluences) meshes.set(object.name, object);
});
report('meshes', meshes.size === expected.meshes.length, [...meshes.keys()].join(', '));
const mixer = new THREE.AnimationMixer(gltf.scene);
const point = new THREE.Vector3();
for (const [place, { name, frames, rate }] of expected.clips.entries()) {
  const clip = THREE.AnimationClip.findByName(gltf.animations, name);
  if (!clip) {
    report(name, false, 'no such clip');
    continue;
  }
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  for (const mesh of expected.meshes) {
    const object = meshes.get(mesh.name);
    const names = Object.keys(object?.morphTargetDictionary ?? {});
    const wanted = mesh.targets.map((target) => target.name);
    report(`${name}, ${mesh.name}: targets`, JSON.stringify(names) === JSON.stringify(wanted), names.join(', '));
    if (!object) continue;
    // An action that has come to its end stays there.
    action.reset();
    let off = 0;
    for (let frame = 0; frame < frames; frame++) {
      mixer.setTime(frame / rate);
      mesh.targets.forEach((target, i) => {
        const away = Math.abs(object.morphTargetInfluences[i] - target.weights[place][frame]);
        if (!(away <= off)) off = Number.isNaN(away) ? Infinity : away;
      });
    }
    // Key times are in single precision.
    report(`${name}, ${mesh.name}: weights (off by ${off.toExponential(1)})`, off <= 10 * WEIGHT_TOLERANCE, off);
    if (place > 0) continue;
    let far = 0;
    action.reset();
    for (const { frame, positions } of mesh.morphed) {
      mixer.setTime(frame / rate);
      gltf.scene.updateMatrixWorld(true);
      object.skeleton.update();
      positions.forEach((goal, i) => {
        // Morph targets, then the skin.
        object.localToWorld(object.getVertexPosition(i, point));
        const away = Math.max(...goal.map((value, axis) => Math.abs(point.getComponent(axis) - value)));
        if (!(away <= far)) far = Number.isNaN(away) ? Infinity : away;
      });
    }
    report(`${name}, ${mesh.name}: points (off by ${far.toExponential(1)} m)`, far <= TOLERANCE, far);
  }
  action.stop();
}
process.exit(failed ? 1 : 0);
