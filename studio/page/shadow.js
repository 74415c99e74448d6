// The soft shadow of sheets on the ground: their faces seen from above, painted small and blurred, as
// the picture on a plane. A map of depths, as three.js has it, takes twice the time of all else.

import * as THREE from '/build/three.module.js';

const pixels = 128; // of the picture, along its side; WebGL wants a power of two
const softness = 0.009; // how far it is blurred, over the width of the ground
const rim = 3; // times that, around it
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

  // The ground's height and how wide it is [m].
  lay(ground, wide) {
    this.ground = ground;
    this.blur = softness * wide;
    this.painted = [];
  }

  // The plane is no larger than the shadow: what lies in front of the view is blended, pixel by pixel.
  place(shapes) {
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    for (const shape of shapes) {
      for (const point of shape) {
        point.forEach((x, k) => {
          low[k] = Math.min(low[k], x);
          high[k] = Math.max(high[k], x);
        });
      }
    }
    const wide = Math.max(high[0] - low[0], high[1] - low[1]) + 2 * rim * this.blur;
    const [x, z] = low.map((edge, k) => (edge + high[k]) / 2);
    this.plane.scale.set(wide, wide, 1);
    this.plane.position.set(x, this.ground, z);
    return { x, z, wide };
  }

  // shapes: points of each cloth; opacity: how dark it is, 0 … 1.
  draw(shapes, faces, opacity) {
    this.plane.visible = shapes.length > 0;
    this.plane.material.opacity = opacity;
    const of = [faces, ...shapes];
    if (of.length === this.painted.length && of.every((each, i) => each === this.painted[i])) return;
    this.painted = of;
    if (!shapes.length) return;
    const { context } = this;
    const below = shapes.map((shape) => shape.map(([x, y, z]) => [x, z].map((at) => at - slant * (y - this.ground))));
    const { x, z, wide } = this.place(below);
    context.clearRect(0, 0, pixels, pixels);
    context.filter = `blur(${(pixels * this.blur) / wide}px)`;
    context.fillStyle = '#000';
    for (const shape of below) {
      const places = shape.map(([px, pz]) => [pixels * ((px - x) / wide + 0.5), pixels * ((pz - z) / wide + 0.5)]);
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
