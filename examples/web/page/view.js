// The picture: a tree of a GLB file on its ground, in sun and shadow, in the wind.

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";

// As in docs/wind.md.
const WIND = `
  uniform float windTime;
  uniform vec3 windGust;
  attribute vec3 _wind_trunk, _wind_limb, _wind_twig, _wind_limb_axis, _wind_twig_axis;
  attribute float _wind_flutter;
  vec3 windPush(vec3 axis, vec3 moment, float cycles, float part) {
    float a = 6.2831853 * fract(cycles * part) + dot(axis, vec3(11.0, 17.0, 13.0));
    vec3 f = windGust * (0.6 + 0.4 * sin(a)) + vec3(0.0, length(windGust) * 0.2 * cos(a), 0.0);
    return f * dot(axis, moment) - axis * dot(f, moment);
  }
  vec3 windMoved(vec3 p) {
    float part = fract(windTime / 8.0);
    float wave = sin(6.2831853 * fract(20.0 * part) + dot(p, vec3(9.0, 7.0, 11.0)));
    return p + windPush(vec3(0.0, 1.0, 0.0), _wind_trunk, 2.0, part)
      + windPush(_wind_limb_axis, _wind_limb, 5.0, part) + windPush(_wind_twig_axis, _wind_twig, 10.0, part)
      + (vec3(0.0, length(windGust), 0.0) + windGust) * (0.7 * _wind_flutter * wave);
  }
`;

export class View {
  #renderer;
  #scene = new THREE.Scene();
  #camera = new THREE.PerspectiveCamera(30, 1, 0.05, 2000);
  #controls;
  #sun = new THREE.DirectionalLight(0xfff3df, 2.6);
  #ground;
  #tree = null;
  #loader = new GLTFLoader();
  #wind = { time: { value: 0 }, gust: { value: new THREE.Vector3() } };
  #framed = null;
  #drawn = false;

  constructor(canvas) {
    this.canvas = canvas;
    this.#renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#renderer.shadowMap.enabled = true;
    this.#renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    this.#renderer.toneMapping = THREE.NeutralToneMapping;
    this.#renderer.toneMappingExposure = 1.1;
    this.#sun.castShadow = true;
    // Leaves let light through.
    this.#sun.shadow.intensity = 0.7;
    this.#sun.shadow.mapSize.set(2048, 2048);
    this.#ground = new THREE.Mesh(
      new THREE.CircleGeometry(1, 96).rotateX(-Math.PI / 2),
      new THREE.MeshStandardMaterial({ color: 0x8f9a74, roughness: 1 }),
    );
    this.#ground.receiveShadow = true;
    this.#scene.add(this.#sun, this.#sun.target, new THREE.HemisphereLight(0xdfeaf2, 0xa09a80, 2.2), this.#ground);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.maxPolarAngle = Math.PI * 0.5;
    this.#controls.addEventListener("change", () => this.redraw());
    canvas.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement);
    this.paint();
    this.#resize();
    const frame = (time) => {
      if (this.#wind.gust.value.length() > 0) {
        this.#wind.time.value = (time / 1000) % 8;
        this.redraw();
      }
      if (this.#drawn) {
        this.#drawn = false;
        this.#renderer.render(this.#scene, this.#camera);
      }
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  redraw() {
    this.#drawn = true;
  }

  // The page's colours, which may have changed.
  paint() {
    const sky = getComputedStyle(this.canvas.parentElement).backgroundColor;
    this.#scene.background = new THREE.Color(sky);
    const isDark = this.#scene.background.getHSL({}).l < 0.4;
    this.#ground.material.color.set(isDark ? 0x4b5340 : 0x8f9a74);
    this.#scene.fog = null;
    this.redraw();
  }

  set wind(strength) {
    this.#wind.gust.value.set(strength, 0, 0);
    this.redraw();
  }

  // Puts the tree of a file where the last one was. `frame` looks at all of it.
  async show(file, frame) {
    const { scene } = await this.#loader.parseAsync(file.buffer, "");
    scene.traverse((node) => {
      if (!node.isMesh) return;
      node.castShadow = true;
      node.receiveShadow = true;
      // The wind moves vertices out of the box.
      node.frustumCulled = false;
      const { material } = node;
      // Blended leaves would need an order; masked ones do not.
      if (material.map) material.map.anisotropy = 4;
      const attributes = node.geometry.attributes;
      if (attributes._wind_trunk) this.#sway(node);
    });
    const old = this.#tree;
    this.#tree = scene;
    this.#scene.add(scene);
    if (old) this.#drop(old);
    const box = new THREE.Box3().setFromObject(scene);
    if (frame || !this.#framed) this.#frame(box);
    this.#light(box);
    this.redraw();
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
  }

  #sway(node) {
    const bend = (material) => {
      material.onBeforeCompile = (shader) => {
        shader.uniforms.windTime = this.#wind.time;
        shader.uniforms.windGust = this.#wind.gust;
        shader.vertexShader =
          WIND + shader.vertexShader.replace("#include <begin_vertex>", "vec3 transformed = windMoved(position);");
      };
    };
    bend(node.material);
    const { map, alphaTest } = node.material;
    node.customDepthMaterial = new THREE.MeshDepthMaterial({ depthPacking: THREE.RGBADepthPacking, map, alphaTest });
    bend(node.customDepthMaterial);
  }

  #drop(tree) {
    this.#scene.remove(tree);
    tree.traverse((node) => {
      node.geometry?.dispose();
      const { material } = node;
      for (const image of [material?.map, material?.normalMap, material?.roughnessMap, material?.aoMap]) image?.dispose();
      material?.dispose();
      node.customDepthMaterial?.dispose();
    });
  }

  #frame(box) {
    const size = box.getSize(new THREE.Vector3());
    const middle = new THREE.Vector3(0, size.y * 0.46, 0);
    const radius = Math.max(size.y, size.x, size.z) * 0.66;
    const aspect = Math.min(1, this.#camera.aspect);
    const away = radius / Math.sin((this.#camera.fov * Math.PI) / 360) / aspect;
    const towards = this.#framed
      ? this.#camera.position.clone().sub(this.#controls.target).normalize()
      : new THREE.Vector3(0.35, 0.16, 1).normalize();
    this.#framed = true;
    this.#controls.target.copy(middle);
    this.#camera.position.copy(middle).addScaledVector(towards, away);
    this.#camera.near = away / 100;
    this.#camera.far = away * 20;
    this.#camera.updateProjectionMatrix();
    this.#controls.minDistance = away * 0.05;
    this.#controls.maxDistance = away * 6;
    this.#controls.update();
  }

  // Sun and ground are as large as the tree needs.
  #light(box) {
    const size = box.getSize(new THREE.Vector3());
    const reach = Math.max(size.y, size.x, size.z, 0.5);
    this.#sun.target.position.set(0, size.y * 0.4, 0);
    this.#sun.position.copy(this.#sun.target.position).add(new THREE.Vector3(-0.5, 1, 0.75).multiplyScalar(reach * 1.5));
    const shadow = this.#sun.shadow.camera;
    shadow.left = shadow.bottom = -reach;
    shadow.right = shadow.top = reach;
    shadow.near = 0.01;
    shadow.far = reach * 5;
    shadow.updateProjectionMatrix();
    this.#sun.shadow.normalBias = reach * 0.002;
    this.#ground.scale.setScalar(reach * 3);
  }

  #key(event) {
    const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const zoom = { "+": 0.9, "=": 0.9, "-": 1.1 }[event.key];
    if (!turn && !zoom) return;
    event.preventDefault();
    const offset = this.#camera.position.clone().sub(this.#controls.target);
    const around = new THREE.Spherical().setFromVector3(offset);
    if (turn) {
      around.theta += turn[0] * 0.1;
      around.phi = Math.min(Math.max(around.phi + turn[1] * 0.1, 0.05), Math.PI * 0.5);
    } else {
      around.radius = Math.min(Math.max(around.radius * zoom, this.#controls.minDistance), this.#controls.maxDistance);
    }
    this.#camera.position.copy(this.#controls.target).add(offset.setFromSpherical(around));
    this.#controls.update();
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.#renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.redraw();
  }

  // The picture as it is, as a PNG file.
  async picture() {
    this.#renderer.render(this.#scene, this.#camera);
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }
}
