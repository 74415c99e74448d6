// The stage of a sheet: start, target and flight in space, by three.js, which the program brings along.

import * as THREE from '/build/three.module.js';
import { OrbitControls } from '/examples/jsm/controls/OrbitControls.js';
import { TransformControls } from '/examples/jsm/controls/TransformControls.js';
import { Shadow } from './shadow.js';

const most_pixels = 1.5; // of the canvas, per pixel of the page: finer costs more than it shows
const force_length = 0.25; // of L, of an arrow as large as a particle's weight
const longest_force = 1; // of L
const gizmo_modes = { move: 'translate', turn: 'rotate', scale: 'scale' };
// Of the gizmo's axes and planes, in place of its own full red, green, blue and their mixtures.
const gizmo_colors = {
  ff0000: '#d1432b', '00ff00': '#3a9a4b', '0000ff': '#3a6fd1', ffff00: '#d19a2b', '00ffff': '#2b9aa8', ff00ff: '#a04bb5',
};

// Without a graphics card smooth edges take most of the time.
function draws_in_software() {
  const gl = document.createElement('canvas').getContext('webgl');
  const info = gl?.getExtension('WEBGL_debug_renderer_info');
  return !info || /swiftshader|llvmpipe|software/i.test(gl.getParameter(info.UNMASKED_RENDERER_WEBGL));
}

// Every face as triangles, a fan about its first corner.
export function triangles_of(faces) {
  return faces.flatMap((face) => face.slice(2).flatMap((_, k) => [face[0], face[k + 1], face[k + 2]]));
}

// The edges of all faces; `alone`: those of one face only, the sheet's border.
function edges_of(faces, alone) {
  const count = new Map();
  for (const face of faces) {
    face.forEach((a, k) => {
      const b = face[(k + 1) % face.length];
      const key = a < b ? `${a} ${b}` : `${b} ${a}`;
      count.set(key, (count.get(key) ?? 0) + 1);
    });
  }
  return [...count].filter(([, faces_of]) => !alone || faces_of === 1).flatMap(([key]) => key.split(' ').map(Number));
}

// A shape that changes: its triangles from both sides, and its edges.
class Cloth {
  constructor(group, order) {
    this.group = group;
    this.points = new THREE.BufferGeometry();
    this.lines = new THREE.BufferGeometry();
    this.front = new THREE.MeshLambertMaterial({ side: THREE.FrontSide });
    this.back = new THREE.MeshLambertMaterial({ side: THREE.BackSide });
    this.meshes = [this.front, this.back].map((material) => new THREE.Mesh(this.points, material));
    this.wires = new THREE.LineSegments(this.lines, new THREE.LineBasicMaterial({ transparent: true, opacity: 0.55 }));
    for (const part of [...this.meshes, this.wires]) {
      part.renderOrder = order;
      part.frustumCulled = false;
      group.add(part);
    }
  }

  set_faces(faces, count) {
    this.at = new THREE.BufferAttribute(new Float32Array(3 * count), 3);
    this.color = new THREE.BufferAttribute(new Float32Array(3 * count).fill(1), 3);
    this.points.setAttribute('position', this.at);
    this.points.setAttribute('color', this.color);
    this.points.setIndex(triangles_of(faces));
    this.lines.setAttribute('position', this.at);
    this.edges = edges_of(faces, false);
    this.border = edges_of(faces, true);
    this.lines.setIndex(this.edges);
    this.shape = this.normals_of = this.colors = this.drawn_lines = null;
  }

  // `shape` and `colors` are drawn as they were when they were given first. options: {color, back,
  // opacity, behind: how far it steps back where another lies on it, shaded, wires, colors: per vertex
  // or null}
  show(shape, { color, back, opacity = 1, behind = 1, shaded = true, wires = false, colors = null }) {
    this.group.visible = Boolean(shape);
    if (!shape) return;
    if (shape !== this.shape) {
      shape.forEach((point, i) => this.at.setXYZ(i, ...point));
      this.at.needsUpdate = true;
      this.shape = shape;
    }
    if (shaded && shape !== this.normals_of) {
      this.points.computeVertexNormals();
      this.normals_of = shape;
    }
    this.front.color.set(colors ? '#ffffff' : color);
    this.back.color.set(colors ? '#ffffff' : back ?? color);
    if (colors && colors !== this.colors) {
      colors.forEach((rgb, i) => this.color.setXYZ(i, ...rgb));
      this.color.needsUpdate = true;
      this.colors = colors;
    }
    for (const material of [this.front, this.back]) {
      if (material.vertexColors !== (colors ? THREE.VertexColors : THREE.NoColors)) {
        material.vertexColors = colors ? THREE.VertexColors : THREE.NoColors;
        material.needsUpdate = true;
      }
      material.transparent = opacity < 1;
      material.opacity = opacity;
      material.depthWrite = opacity === 1;
      material.polygonOffset = true; // lines lie upon it
      material.polygonOffsetFactor = material.polygonOffsetUnits = behind;
    }
    for (const mesh of this.meshes) mesh.visible = shaded;
    this.wires.material.color.set(color);
    const lines = wires || !shaded ? this.edges : this.border;
    if (lines !== this.drawn_lines) this.lines.setIndex(lines);
    this.drawn_lines = lines;
    this.wires.material.opacity = lines === this.edges ? 0.8 : 0.55;
  }
}

export class Space {
  // on: {draw(), moved(matrix, live): what the gizmo did to the target since it was taken}
  constructor(canvas, on) {
    this.canvas = canvas;
    this.on = on;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !draws_in_software(), alpha: true });
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01, 1000);
    this.make_lights();
    const group = () => {
      const made = new THREE.Group();
      this.scene.add(made);
      return made;
    };
    this.start = new Cloth(group(), 1);
    this.target = new Cloth(group(), 2);
    this.cloths = [new Cloth(group(), 3), new Cloth(group(), 4)];
    this.crossed = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2 }));
    this.arrows = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial());
    this.trails = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ transparent: true, opacity: 0.4 }));
    this.paths = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ transparent: true, opacity: 0.8 }));
    for (const part of [this.crossed, this.arrows, this.trails, this.paths]) {
      part.frustumCulled = false;
      this.scene.add(part);
    }
    this.make_controls();
  }

  make_lights() {
    this.sky = new THREE.HemisphereLight('#ffffff', '#b9bdc9');
    this.sun = new THREE.DirectionalLight('#ffffff', 0.36);
    this.sun.position.set(0.25, 1, 0.3);
    this.shadow = new Shadow();
    this.scene.add(this.sky, this.sun, this.shadow.plane);
  }

  make_controls() {
    this.orbit = new OrbitControls(this.camera, this.canvas);
    this.orbit.enableKeys = false; // the page has its own
    this.orbit.screenSpacePanning = true;
    this.orbit.addEventListener('change', () => this.on.draw());
    this.handle = new THREE.Object3D();
    this.scene.add(this.handle);
    this.gizmo = new TransformControls(this.camera, this.canvas);
    this.gizmo.setSize(0.65);
    this.gizmo.traverse(({ material }) => {
      const color = material && gizmo_colors[material.color.getHexString()];
      if (color) material.color.set(color);
    });
    this.scene.add(this.gizmo);
    this.gizmo.addEventListener('change', () => this.on.draw());
    this.gizmo.addEventListener('dragging-changed', ({ value }) => {
      this.orbit.enabled = !value;
      this.dragging = value;
      if (!value) {
        this.on.moved(this.handle_change(), false);
        this.take(this.center);
      }
    });
    this.gizmo.addEventListener('objectChange', () => this.on.moved(this.handle_change(), true));
  }

  // A gesture of the hand, as a matrix that takes points where they were to where they are.
  handle_change() {
    this.handle.updateMatrix();
    const back = new THREE.Matrix4().makeTranslation(...this.taken_at.map((x) => -x));
    return new THREE.Matrix4().multiplyMatrices(this.handle.matrix, back);
  }

  // The gizmo stands at the target's middle.
  take(center) {
    this.center = center;
    if (this.dragging) return;
    this.taken_at = center;
    this.handle.position.set(...center);
    this.handle.rotation.set(0, 0, 0);
    this.handle.scale.set(1, 1, 1);
  }

  set_tool(tool) {
    const mode = gizmo_modes[tool];
    if (!mode) return this.gizmo.detach();
    this.gizmo.setMode(mode);
    this.gizmo.attach(this.handle);
  }

  set_faces(faces, count) {
    if (this.faces === faces) return;
    this.faces = faces;
    for (const cloth of [this.start, this.target, ...this.cloths]) cloth.set_faces(faces, count);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(most_pixels, devicePixelRatio || 1));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  // Everything is in view: points of all shapes; `ground` is its height.
  fit(shapes, ground) {
    const box = new THREE.Box3();
    for (const shape of shapes) for (const point of shape) box.expandByPoint(new THREE.Vector3(...point));
    this.lay_ground(box, ground);
    const middle = box.getCenter(new THREE.Vector3());
    const radius = box.getSize(new THREE.Vector3()).length() / 2 || 1;
    const half = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    const away = new THREE.Vector3(0.35, 0.38, 1).normalize().multiplyScalar((0.92 * radius) / Math.sin(narrow));
    this.camera.position.copy(middle).add(away);
    this.camera.near = radius / 100;
    this.camera.far = radius * 100;
    this.camera.updateProjectionMatrix();
    this.orbit.target.copy(middle);
    this.orbit.update();
  }

  // As large as what may throw a shadow on it, and more.
  lay_ground(box, ground) {
    const size = box.getSize(new THREE.Vector3()), middle = box.getCenter(new THREE.Vector3());
    const wide = Math.max(size.x, size.z, size.y) * 1.6;
    this.shadow.lay(ground, wide);
    const cell = 10 ** Math.floor(Math.log10(wide / 4));
    const cells = Math.max(2, 2 * Math.ceil(wide / cell / 2));
    if (this.grid) this.scene.remove(this.grid);
    this.grid = new THREE.GridHelper(cells * cell, cells, '#888888', '#888888');
    this.grid.material.transparent = true;
    this.grid.material.opacity = 0.22;
    this.grid.position.set(Math.round(middle.x / cell) * cell, ground, Math.round(middle.z / cell) * cell);
    this.scene.add(this.grid);
  }

  // what: {start, target, cloths: [{shape, color, back, stale, errors, forces, ghosts, path, crossed,
  //        wires}], wires, length, effort_unit}
  draw(what, colors) {
    this.start.show(what.start, { color: colors.initial, opacity: 0.4, wires: what.wires, shaded: !what.wires });
    this.target.show(what.target, { color: colors.target, opacity: 0.3, behind: 6, wires: what.wires, shaded: !what.wires });
    this.cloths.forEach((cloth, i) => {
      const shown = what.cloths[i];
      const wires = what.wires || shown?.wires;
      cloth.show(shown?.shape, {
        color: shown?.color, back: shown?.back, shaded: !wires, wires,
        opacity: shown?.stale ? 0.5 : 1, colors: shown?.errors,
      });
    });
    this.draw_lines(what, colors);
    this.draw_crossed(what.cloths, colors);
    this.shadow.draw(what.cloths.map(({ shape }) => shape), this.faces, colors.shade);
    this.sky.intensity = colors.sky;
    this.gizmo.visible = Boolean(this.gizmo.object) && !what.playing;
    this.renderer.render(this.scene, this.camera);
  }

  draw_lines({ cloths, length, effort_unit }, colors) {
    // `from`: what the points are made of, which are made anew only where that is another.
    const put = (part, from, points_of, color) => {
      if (part.from?.length !== from.length || part.from.some((each, i) => each !== from[i])) {
        part.from = from;
        part.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points_of()), 3));
      }
      part.visible = part.geometry.attributes.position.count > 0;
      part.material.color.set(color);
    };
    const { border } = this.start;
    const first = cloths[0]?.color ?? colors.a;
    put(this.trails, cloths.map(({ ghosts }) => ghosts), () => cloths.flatMap(({ ghosts }) => (ghosts ?? []).flatMap((ghost) => border.flatMap((i) => ghost[i]))), first);
    put(this.paths, cloths.map(({ path }) => path), () => cloths.flatMap(({ path }) => (path ?? []).slice(1).flatMap((point, k) => [...path[k], ...point])), first);
    put(this.arrows, cloths.flatMap(({ shape, forces }) => (forces ? [shape, forces] : [])),
      () => cloths.flatMap(({ shape, forces }) => (forces ? arrows(shape, forces, length, effort_unit) : [])), colors.force);
  }

  // Faces that pass through others.
  draw_crossed(cloths, colors) {
    const points = cloths.flatMap(({ shape, crossed }) => (crossed?.length ? triangles_of(crossed.map((f) => this.faces[f])).flatMap((i) => shape[i]) : []));
    this.crossed.visible = points.length > 0;
    if (!points.length) return;
    this.crossed.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points), 3));
    this.crossed.material.color.set(colors.bad);
  }
}

// Lines with two barbs each.
function arrows(shape, forces, length, effort_unit) {
  const points = [];
  shape.forEach((from, i) => {
    const force = new THREE.Vector3(...forces[i]).multiplyScalar((force_length * length) / effort_unit);
    const size = force.length();
    if (size < 0.01 * length) return;
    force.clampLength(0, longest_force * length);
    const start = new THREE.Vector3(...from), tip = start.clone().add(force);
    const side = new THREE.Vector3(-force.y, force.x, 0.1 * force.z).cross(force).normalize().multiplyScalar(0.12 * force.length());
    points.push(...from, ...tip.toArray());
    for (const sign of [1, -1]) {
      points.push(...tip.toArray(), ...tip.clone().addScaledVector(force, -0.25).addScaledVector(side, sign).toArray());
    }
  });
  return points;
}
