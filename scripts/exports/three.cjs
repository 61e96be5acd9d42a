// three.js in headless Chromium loads a tree's GLB: the counts are those written, the picture is not blank.
const fs = require("fs");
const path = require("path");
const { PNG } = require("pngjs");
const { fail, show } = require("./browser.cjs");

const [name, three, picture] = process.argv.slice(2);
const parts = JSON.parse(fs.readFileSync(`${name}.stats.json`)).parts;
const expected = Object.values(parts).reduce((sum, part) => sum + part.triangles, 0);

const page = `<!doctype html><body style="margin:0"><script type="importmap">
{"imports": {"three": "/three/build/three.module.js"}}</script><script type="module">
import * as THREE from "three";
import { GLTFLoader } from "/three/examples/jsm/loaders/GLTFLoader.js";
const report = (text) => fetch("/report", { method: "POST", body: text });
try {
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setSize(600, 600);
  document.body.append(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xf4f4f0);
  scene.add(new THREE.HemisphereLight(0xffffff, 0x888877, 2));
  const sun = new THREE.DirectionalLight(0xffffff, 3);
  sun.position.set(-5, 9, 6);
  scene.add(sun);
  const model = (await new GLTFLoader().loadAsync("/tree.glb")).scene;
  scene.add(model);
  let triangles = 0;
  model.traverse((object) => {
    if (object.isMesh) triangles += object.geometry.index.count / 3 * (object.isInstancedMesh ? object.count : 1);
  });
  const camera = new THREE.PerspectiveCamera(35, 1, 0.1, 200);
  camera.position.set(0, 6, 26);
  camera.lookAt(0, 5, 0);
  renderer.render(scene, camera);
  await report(JSON.stringify({ triangles, picture: renderer.domElement.toDataURL() }));
} catch (error) {
  await report(JSON.stringify({ error: String(error) }));
}
</script>`;

show({
  page,
  file: (url) => url === "/tree.glb" ? `${name}.glb` : path.join(three, url.slice("/three".length)),
  minutes: 2,
  finish({ triangles, picture: url }) {
    const png = Buffer.from(url.split(",")[1], "base64");
    fs.writeFileSync(picture, png);
    const { data } = PNG.sync.read(png);
    let dark = 0;
    for (let i = 0; i < data.length; i += 4) dark += data[i] < 160;
    const share = dark / (data.length / 4);
    console.log(`${triangles} triangles of ${expected}; ${Math.round(share * 100)}% of ${picture} is tree`);
    if (triangles !== expected || share < 0.03 || share > 0.9) fail("not what was written");
  },
});
