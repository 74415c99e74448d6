// The soft shadow of sheets on the ground: their faces seen from above, painted small and blurred, as
// the picture on a plane. A map of depths, as three.js has it, takes twice the time of all else.

import * as THREE from '/build/three.module.js';

const pixels = 256; // of the picture, along its side; WebGL wants a power of two
const blur = 2.2; // pixels
const slant = 0.12; // over the height of what throws it

export class Shadow {
  constructor() {
    this.picture = document.createElement('canvas');
    this.picture.width = this.picture.height = pixels;
    this.context = this.picture.getContext('2d');
    this.texture = new THREE.CanvasTexture(this.picture);
    this.plane = new THREE.Mesh(
      new THREE.PlaneBufferGeometry(1, 1),
      new THREE.MeshBasicMaterial({ map: this.texture, transparent: true, depthWrite: false }));
    this.plane.rotation.x = -Math.PI / 2;
    this.plane.renderOrder = -1;
    this.painted = []; // of what: its faces and shapes
  }

  // A square of the ground, about `middle`, `wide` metres.
  lay(middle, ground, wide) {
    this.plane.scale.set(wide, wide, 1);
    this.plane.position.set(middle.x, ground, middle.z);
    this.painted = [];
  }

  // shapes: points of each cloth; opacity: how dark it is, 0 … 1.
  draw(shapes, faces, opacity) {
    this.plane.material.opacity = opacity;
    const of = [faces, ...shapes];
    if (of.length === this.painted.length && of.every((each, i) => each === this.painted[i])) return;
    this.painted = of;
    const { context } = this;
    const { x, y: ground, z } = this.plane.position, wide = this.plane.scale.x;
    const at = ([px, py, pz]) => {
      const shift = slant * (py - ground);
      return [pixels * ((px - shift - x) / wide + 0.5), pixels * ((pz - shift - z) / wide + 0.5)];
    };
    context.clearRect(0, 0, pixels, pixels);
    context.filter = `blur(${blur}px)`;
    context.fillStyle = '#000';
    for (const shape of shapes) {
      const places = shape.map(at);
      context.beginPath();
      for (const face of faces) {
        // All the same way round, so that two that lie on one another do not cancel.
        const [a, b, c] = [places[face[0]], places[face[1]], places[face[2]]];
        const turns = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        const around = turns < 0 ? [...face].reverse() : face;
        around.forEach((i, k) => (k ? context.lineTo(...places[i]) : context.moveTo(...places[i])));
        context.closePath();
      }
      context.fill();
    }
    this.texture.needsUpdate = true;
  }
}
