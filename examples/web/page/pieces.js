// The meshes of a preview, from the words that src/preview.rs writes: no file is written and read, no leaf is copied, and materials
// are used again, so that no shader is compiled while a slider moves.

import * as THREE from "three";

const COLORS = 1;
const DOUBLE_SIDED = 2;
const COPIES = 4;

export class Pieces {
  // Materials by what their shaders need.
  #materials = new Map();

  has(material) {
    return [...this.#materials.values()].includes(material);
  }

  // The meshes of an answer, as a group.
  read(bytes) {
    const { buffer } = bytes;
    const used = new Map();
    const group = new THREE.Group();
    let at = bytes.byteOffset;
    const take = (Kind, length) => {
      const array = new Kind(buffer, at, length);
      at += array.byteLength;
      return array;
    };
    const end = bytes.byteOffset + bytes.byteLength;
    while (at < end) {
      const [vertices, indices, copies, flags] = take(Uint32Array, 4);
      const [red, green, blue] = take(Float32Array, 4);
      const geometry = new THREE.BufferGeometry();
      const attribute = (name) => geometry.setAttribute(name, new THREE.BufferAttribute(take(Float32Array, 3 * vertices), 3));
      attribute("position");
      attribute("normal");
      if (flags & COLORS) attribute("color");
      const matrices = take(Float32Array, 16 * copies);
      const tints = take(Float32Array, 3 * copies);
      geometry.setIndex(new THREE.BufferAttribute(take(Uint32Array, indices), 1));
      const number = used.get(flags) ?? 0;
      used.set(flags, number + 1);
      const material = this.#material(flags, number);
      material.color.setRGB(red, green, blue);
      if (flags & COPIES) {
        const mesh = new THREE.InstancedMesh(geometry, material, 0);
        mesh.count = copies;
        mesh.instanceMatrix = new THREE.InstancedBufferAttribute(matrices, 16);
        mesh.instanceColor = new THREE.InstancedBufferAttribute(tints, 3);
        mesh.frustumCulled = false;
        group.add(mesh);
      } else {
        group.add(new THREE.Mesh(geometry, material));
      }
    }
    return group;
  }

  // The one of this number with these flags in a preview.
  #material(flags, number) {
    const key = `${flags} ${number}`;
    if (!this.#materials.has(key)) {
      this.#materials.set(key, new THREE.MeshLambertMaterial({
        vertexColors: Boolean(flags & COLORS),
        side: flags & DOUBLE_SIDED ? THREE.DoubleSide : THREE.FrontSide,
      }));
    }
    return this.#materials.get(key);
  }
}
