// three-vrm loads a .vrm: meta, humanoid bones, a normalised pose that moves the right joints.
//
//     node vrm.mjs FILE.vrm

import { readFile } from 'node:fs/promises';

// What three.js takes from a browser; the files carry no pictures.
globalThis.self = globalThis;
const THREE = await import('three');
const { GLTFLoader } = await import('three/addons/loaders/GLTFLoader.js');
const { VRMLoaderPlugin, VRMRequiredHumanBoneName, VRMHumanBoneParentMap } = await import('@pixiv/three-vrm');

let failed = false;
function report(name, good, why) {
  failed ||= !good;
  console.log(good ? `ok three-vrm: ${name}` : `FAILED three-vrm: ${name}: ${why}`);
}

const bytes = await readFile(process.argv[2]);
const loader = new GLTFLoader();
loader.register((parser) => new VRMLoaderPlugin(parser));
const gltf = await loader.parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
const vrm = gltf.userData.vrm;
report('is a VRM 1.0 model', vrm?.meta?.metaVersion === '1', JSON.stringify(vrm?.meta));
if (!vrm) process.exit(1);
const { name, authors, licenseUrl } = vrm.meta;
report('has a name, authors and the licence', name && authors?.[0] && licenseUrl === 'https://vrm.dev/licenses/1.0/',
  JSON.stringify(vrm.meta));

const bones = Object.keys(vrm.humanoid.humanBones);
const missing = Object.values(VRMRequiredHumanBoneName).filter((bone) => !bones.includes(bone));
report(`all required bones, ${bones.length} in all`, missing.length === 0, missing.join(', '));
const nodes = bones.map((bone) => vrm.humanoid.getRawBoneNode(bone));
report('every bone is a node of its own',
  new Set(nodes).size === bones.length && nodes.every((n) => n?.isBone), 'shared or none');
const astray = bones.filter((bone) => {
  let parent = VRMHumanBoneParentMap[bone];
  while (parent && !bones.includes(parent)) parent = VRMHumanBoneParentMap[parent];
  if (!parent) return false;
  let above = vrm.humanoid.getRawBoneNode(bone).parent;
  while (above && above !== vrm.humanoid.getRawBoneNode(parent)) above = above.parent;
  return !above;
});
report('every bone hangs below its parent bone', astray.length === 0, astray.join(', '));

const place = (bone) => vrm.humanoid.getRawBoneNode(bone).getWorldPosition(new THREE.Vector3());
vrm.scene.updateMatrixWorld(true);
const arm = place('leftHand').sub(place('leftUpperArm'));
report('T-pose: the left arm points along +X', arm.x / arm.length() > 0.9999, arm.toArray().join(' '));
const foot = place('leftToes').sub(place('leftFoot'));
report('faces +Z', foot.z > 0 && Math.abs(foot.z) > Math.abs(foot.x), foot.toArray().join(' '));

// In the normalised pose all axes are those of the world: a quarter turn about Z lifts the left arm.
const length = place('leftHand').distanceTo(place('leftUpperArm'));
const shoulder = place('leftUpperArm');
vrm.humanoid.getNormalizedBoneNode('leftUpperArm').rotation.set(0, 0, Math.PI / 2);
vrm.humanoid.update();
vrm.scene.updateMatrixWorld(true);
const lifted = place('leftHand').sub(shoulder);
report('a normalised pose lifts the left arm', Math.abs(lifted.y - length) < 1e-5, lifted.toArray().join(' '));
process.exit(failed ? 1 : 0);
