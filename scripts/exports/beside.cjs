// three.js in headless Chromium draws a tree's GLB beside "Oak Medium" of ez-tree (npm @dgreenheck/ez-tree), in the same light and at
// the same height: from far and from near.
//
//     node scripts/exports/beside.cjs TREE.glb NODE_MODULES PICTURE.png
const fs = require("fs");
const path = require("path");
const { fail, show } = require("./browser.cjs");

const [glb, modules, picture] = process.argv.slice(2);

const page = `<!doctype html><body style="margin:0"><script type="importmap">
{"imports": {"three": "/modules/three/build/three.module.js", "ez-tree": "/modules/@dgreenheck/ez-tree/build/ez-tree.es.js"}}
</script><script type="module">
import * as THREE from "three";
import { GLTFLoader } from "/modules/three/examples/jsm/loaders/GLTFLoader.js";
import { Tree } from "ez-tree";
const report = (text) => fetch("/report", { method: "POST", body: text });
const count = (model) => {
  let triangles = 0;
  model.traverse((object) => {
    if (object.isMesh) triangles += object.geometry.index.count / 3;
  });
  return triangles;
};
// Stands at x, 10 high.
const placed = (model, x) => {
  model.updateMatrixWorld(true);
  const box = new THREE.Box3().setFromObject(model);
  const holder = new THREE.Group();
  holder.add(model);
  const scale = 10 / (box.max.y - box.min.y);
  holder.scale.setScalar(scale);
  holder.position.set(x, -box.min.y * scale, 0);
  return holder;
};
try {
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setSize(1600, 1200);
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = THREE.PCFSoftShadowMap;
  document.body.append(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xdfe6ea);
  scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8a70, 1.6));
  const sun = new THREE.DirectionalLight(0xfff4e0, 3);
  sun.position.set(-12, 20, 14);
  sun.castShadow = true;
  sun.shadow.mapSize.set(4096, 4096);
  Object.assign(sun.shadow.camera, { left: -16, right: 16, top: 16, bottom: -16, far: 60 });
  sun.shadow.bias = -0.002;
  scene.add(sun);
  const ground = new THREE.Mesh(new THREE.PlaneGeometry(200, 200), new THREE.MeshStandardMaterial({ color: 0x8d9a78 }));
  ground.rotation.x = -Math.PI / 2;
  ground.receiveShadow = true;
  scene.add(ground);
  const gltf = await new GLTFLoader().loadAsync("/tree.glb");
  // Of levels the finest is shown.
  const ours = gltf.scene.children[0];
  const theirs = new Tree();
  theirs.loadPreset("Oak Medium");
  theirs.generate();
  const counts = [count(ours), count(theirs)];
  for (const model of [ours, theirs]) {
    model.traverse((object) => {
      if (object.isMesh) object.castShadow = object.receiveShadow = true;
    });
  }
  scene.add(placed(ours, -6), placed(theirs, 6));
  // Its images come by themselves.
  await new Promise((done) => setTimeout(done, 6000));
  const camera = new THREE.PerspectiveCamera(30, 1600 / 760, 0.1, 300);
  renderer.setScissorTest(true);
  const draw = (x, y, width, height, at, to) => {
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    camera.position.set(...at);
    camera.lookAt(...to);
    renderer.setViewport(x, y, width, height);
    renderer.setScissor(x, y, width, height);
    renderer.render(scene, camera);
  };
  draw(0, 440, 1600, 760, [0, 4, 24], [0, 5, 0]);
  draw(0, 0, 800, 438, [-6, 2.2, 6.5], [-6, 2.9, 0]);
  draw(802, 0, 798, 438, [6, 2.2, 6.5], [6, 2.9, 0]);
  await report(JSON.stringify({ counts, picture: renderer.domElement.toDataURL() }));
} catch (error) {
  await report(JSON.stringify({ error: String(error) + error.stack }));
}
</script>`;

show({
  page,
  file: (url) => url === "/tree.glb" ? glb : path.join(modules, url.slice("/modules".length)),
  minutes: 5,
  finish({ counts, picture: url }) {
    fs.writeFileSync(picture, Buffer.from(url.split(",")[1], "base64"));
    console.log(`ours has ${counts[0]} triangles, theirs ${counts[1]}: ${picture}`);
    if (counts[0] > counts[1]) fail("ours has more");
  },
});
