// The picture: a tree of a GLB file on its ground, in sun and shadow, in the wind.

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { Pieces } from "./pieces.js";

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

// Pixels of a preview over those of the page, where the processor draws.
const COARSE = 0.5;

// Whether the processor draws, which takes seconds where a graphics card takes milliseconds.
function isDrawnByProcessor() {
  const context = document.createElement("canvas").getContext("webgl2", { failIfMajorPerformanceCaveat: true });
  if (!context) return true;
  const { UNMASKED_RENDERER_WEBGL } = context.getExtension("WEBGL_debug_renderer_info") ?? {};
  const name = context.getParameter(UNMASKED_RENDERER_WEBGL ?? context.RENDERER);
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

export class View {
  #renderer;
  #isSlow = isDrawnByProcessor();
  #scene = new THREE.Scene();
  #camera = new THREE.PerspectiveCamera(30, 1, 0.05, 2000);
  #controls;
  #sun = new THREE.DirectionalLight(0xfff3df, 2.6);
  #ground;
  // The tree itself, which waits unseen while there is a preview of another.
  #tree = null;
  #preview = null;
  #pieces = new Pieces();
  #loader = new GLTFLoader();
  #wind = { time: { value: 0 }, gust: { value: new THREE.Vector3() } };
  #framed = null;
  // The usual distance, and what an address wants to see the tree from.
  #usual = 1;
  #wanted = null;
  #drawn = false;
  // Greatest extent of the tree, metres.
  #reach = 1;

  constructor(canvas) {
    this.canvas = canvas;
    this.#renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.#isSlow });
    this.#renderer.shadowMap.enabled = true;
    this.#renderer.shadowMap.type = THREE.PCFShadowMap;
    // Shadows stay where they are while the tree turns.
    this.#renderer.shadowMap.autoUpdate = false;
    this.#renderer.toneMapping = THREE.NeutralToneMapping;
    this.#renderer.toneMappingExposure = 1.1;
    this.#sun.castShadow = true;
    // Leaves let light through.
    this.#sun.shadow.intensity = 0.7;
    this.#sun.shadow.mapSize.setScalar(this.#isSlow ? 1024 : 2048);
    this.#ground = new THREE.Mesh(
      new THREE.CircleGeometry(1, 96).rotateX(-Math.PI / 2),
      new THREE.MeshStandardMaterial({ color: 0x8f9a74, roughness: 1 }),
    );
    this.#ground.receiveShadow = true;
    this.#scene.add(this.#sun, this.#sun.target, new THREE.HemisphereLight(0xdfeaf2, 0xa09a80, 2.2), this.#ground);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.maxPolarAngle = Math.PI * 0.5;
    this.#controls.addEventListener("change", () => this.redraw());
    this.#controls.addEventListener("end", () => this.onTurn?.());
    canvas.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement);
    this.paint();
    this.#resize();
    const frame = (time) => {
      if (this.#wind.gust.value.length() > 0) {
        this.#wind.time.value = (time / 1000) % 8;
        this.#renderer.shadowMap.needsUpdate = true;
        this.redraw();
      }
      if (this.#drawn) {
        this.#drawn = false;
        const away = this.#camera.position.distanceTo(this.#controls.target);
        this.#scene.fog.near = away + this.#reach;
        this.#scene.fog.far = away + 3 * this.#reach;
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
    // The ground ends in the sky's colour, wherever its edge is.
    this.#scene.fog ??= new THREE.Fog(sky);
    this.#scene.fog.color.set(sky);
    this.redraw();
  }

  set wind(strength) {
    this.#wind.gust.value.set(strength, 0, 0);
    this.redraw();
  }

  // Puts the tree of a file where the last one was, and resolves once it is drawn to the milliseconds that reading took. `frame` looks
  // at all of it.
  async show(file, frame) {
    const begin = performance.now();
    const { scene } = await this.#loader.parseAsync(file.buffer, "");
    scene.traverse((node) => {
      if (!node.isMesh) return;
      node.castShadow = true;
      node.receiveShadow = true;
      // The wind moves vertices out of the box.
      node.frustumCulled = false;
      const { material } = node;
      if (material.map) material.map.anisotropy = this.#isSlow ? 1 : 4;
      const attributes = node.geometry.attributes;
      if (attributes._wind_trunk) this.#sway(node);
    });
    const last = [this.#tree, this.#preview];
    this.#tree = scene;
    this.#preview = null;
    const read = await this.#put(scene, last, frame, begin);
    // Only now, so that its shaders serve the new tree too.
    last.forEach((tree) => tree && this.#drop(tree));
    return read;
  }

  // As `show`, for the meshes of a preview.
  async sketch(bytes, frame) {
    const begin = performance.now();
    const group = this.#pieces.read(bytes);
    group.traverse((node) => {
      node.castShadow = !this.#isSlow;
      node.receiveShadow = !this.#isSlow;
    });
    const last = this.#preview;
    this.#preview = group;
    const read = await this.#put(group, [this.#tree, last], frame, begin);
    if (last) this.#dropMeshes(last);
    return read;
  }

  async #put(tree, last, frame, begin) {
    for (const other of last) if (other) other.visible = false;
    this.#scene.add(tree);
    const box = new THREE.Box3().setFromObject(tree);
    if (frame || !this.#framed) this.#frame(box);
    this.#light(box);
    this.#resize();
    this.#renderer.shadowMap.needsUpdate = true;
    this.redraw();
    const read = performance.now() - begin;
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    return read;
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

  // Whether the tree itself is shown, not a preview.
  get isWhole() {
    return this.#tree !== null && this.#preview === null;
  }

  #dropMeshes(tree) {
    this.#scene.remove(tree);
    tree.traverse((node) => {
      node.geometry?.dispose();
      if (node.isInstancedMesh) node.dispose();
    });
  }

  #drop(tree) {
    const isPreview = tree.isGroup && tree.children.every((node) => this.#pieces.has(node.material));
    this.#dropMeshes(tree);
    if (isPreview) return;
    tree.traverse((node) => {
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
    // Another tree is seen from the same side.
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
    this.#usual = away;
    if (this.#wanted) this.#look();
    this.#controls.update();
  }

  // Sun and ground are as large as the tree needs.
  #light(box) {
    const size = box.getSize(new THREE.Vector3());
    const reach = Math.max(size.y, size.x, size.z, 0.5);
    this.#reach = reach;
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

  // Where the tree is seen from, for the address: azimuth and elevation in degrees, distance over the usual one; null before there is one.
  get camera() {
    if (this.#wanted || !this.#framed) return this.#wanted;
    const around = new THREE.Spherical().setFromVector3(this.#camera.position.clone().sub(this.#controls.target));
    const degrees = (radians) => Math.round(THREE.MathUtils.radToDeg(radians));
    return [degrees(around.theta), 90 - degrees(around.phi), Number((around.radius / this.#usual).toFixed(2))];
  }

  // Holds once a tree is shown.
  set camera([azimuth, elevation, distance]) {
    this.#wanted = [azimuth, Math.min(Math.max(elevation, 0), 89), Math.min(Math.max(distance, 0.05), 6)];
    if (this.#framed) this.#look();
  }

  #look() {
    const [azimuth, elevation, distance] = this.#wanted;
    this.#wanted = null;
    const [theta, phi] = [azimuth, 90 - elevation].map(THREE.MathUtils.degToRad);
    const offset = new THREE.Vector3().setFromSphericalCoords(this.#usual * distance, phi, theta);
    this.#camera.position.copy(this.#controls.target).add(offset);
    this.#controls.update();
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
    this.onTurn?.();
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    // The processor draws previews coarsely and without shadows.
    const isCoarse = this.#isSlow && this.#preview !== null;
    const ratio = isCoarse ? COARSE : Math.min(devicePixelRatio, this.#isSlow ? 1 : 2);
    this.#sun.castShadow = !isCoarse;
    if (this.#renderer.getPixelRatio() !== ratio) this.#renderer.setPixelRatio(ratio);
    const size = this.#renderer.getSize(new THREE.Vector2());
    if (size.x !== width || size.y !== height) this.#renderer.setSize(width, height, false);
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
