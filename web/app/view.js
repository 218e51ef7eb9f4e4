// A canvas with triangles: the model in space, or its layout in the plane.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
/** Checks along the longer side of the layout. */
const CHECKS = 64;

export class View {
  #canvas;
  #renderer;
  #scene = new THREE.Scene();
  #camera;
  #controls;
  #mesh;
  #lines;
  #flat;

  /** `flat`: looked at from above, and moved instead of turned. `pick` is told the triangle that was clicked. */
  constructor(canvas, { flat, pick }) {
    this.#canvas = canvas;
    this.#flat = flat;
    this.#renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.#camera = flat ? new THREE.OrthographicCamera() : new THREE.PerspectiveCamera(35);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enableRotate = !flat;
    if (flat) this.#controls.mouseButtons.LEFT = THREE.MOUSE.PAN;
    if (flat) this.#controls.touches.ONE = THREE.TOUCH.PAN;
    this.#controls.addEventListener("change", () => this.draw());
    const light = new THREE.HemisphereLight("#ffffff", "#8a8f96", flat ? 0 : 2.4);
    const lamp = new THREE.DirectionalLight("#ffffff", flat ? 0 : 1.2);
    this.#camera.add(lamp);
    lamp.position.set(1, 1, 2);
    this.#scene.add(light, this.#camera);
    new ResizeObserver(() => this.draw()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    canvas.addEventListener("keydown", (event) => this.#key(event));
    let down;
    canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    canvas.addEventListener("pointerup", (event) => {
      // A drag is no click.
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) pick(this.#at(event));
    });
  }

  /** Shows triangles: three points each, UVs for the checkerboard in units of a page, and pairs of points that are seams. */
  show({ points, uvs, seams }) {
    this.clear();
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(points.length).fill(1), 3));
    if (uvs) geometry.setAttribute("uv", new THREE.BufferAttribute(uvs, 2));
    geometry.computeVertexNormals();
    geometry.computeBoundingSphere();
    geometry.computeBoundingBox();
    const settings = { vertexColors: true, side: THREE.DoubleSide, map: uvs ? checkerboard() : null };
    const material = this.#flat ? new THREE.MeshBasicMaterial(settings) : new THREE.MeshStandardMaterial({ ...settings, roughness: 0.9 });
    this.#mesh = new THREE.Mesh(geometry, material);
    this.#scene.add(this.#mesh);
    if (seams?.length) {
      const lines = new THREE.BufferGeometry();
      lines.setAttribute("position", new THREE.BufferAttribute(seams, 3));
      this.#lines = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ color: "#c2410c" }));
      this.#scene.add(this.#lines);
    }
    this.#frame(geometry);
    this.draw();
  }

  /** Colours the triangles; without the checkerboard where `plain`. */
  paint(colours, plain) {
    if (!this.#mesh) return;
    // Light adds up linearly, colours are given as screens show them.
    this.#mesh.geometry.getAttribute("color").array.set(colours.map((x) => x ** 2.2));
    this.#mesh.geometry.getAttribute("color").needsUpdate = true;
    const map = plain || !this.#mesh.geometry.getAttribute("uv") ? null : checkerboard();
    if (this.#mesh.material.map !== map) {
      this.#mesh.material.map = map;
      this.#mesh.material.needsUpdate = true;
    }
    this.draw();
  }

  clear() {
    for (const object of [this.#mesh, this.#lines]) {
      if (!object) continue;
      this.#scene.remove(object);
      object.geometry.dispose();
      object.material.dispose();
    }
    this.#mesh = this.#lines = undefined;
    this.draw();
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (width === 0 || height === 0) return;
    this.#renderer.setSize(width, height, false);
    if (this.#flat) {
      const half = this.#camera.userData.half ?? 1;
      const [x, y] = width > height ? [half * (width / height), half] : [half, half * (height / width)];
      Object.assign(this.#camera, { left: -x, right: x, top: y, bottom: -y });
    } else {
      this.#camera.aspect = width / height;
    }
    this.#camera.updateProjectionMatrix();
    this.#scene.background = new THREE.Color(getComputedStyle(this.#canvas).backgroundColor);
    this.#renderer.render(this.#scene, this.#camera);
  }

  #frame(geometry) {
    const { center, radius } = geometry.boundingSphere;
    const size = radius || 1;
    if (this.#flat) {
      const { min, max } = geometry.boundingBox;
      this.#camera.userData.half = 0.53 * Math.max(max.x - min.x, max.y - min.y, Number.EPSILON);
      center.set((min.x + max.x) / 2, (min.y + max.y) / 2, 0);
      this.#camera.position.set(center.x, center.y, 10);
      Object.assign(this.#camera, { near: 0, far: 20, zoom: 1 });
    } else {
      this.#camera.position.set(center.x + 1.6 * size, center.y + 0.9 * size, center.z + 2.9 * size);
      Object.assign(this.#camera, { near: size / 100, far: size * 50 });
    }
    this.#controls.target.copy(center);
    this.#controls.update();
  }

  #at(event) {
    if (!this.#mesh) return undefined;
    const box = this.#canvas.getBoundingClientRect();
    const at = new THREE.Vector2((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(at, this.#camera);
    return ray.intersectObject(this.#mesh)[0]?.faceIndex;
  }

  #key(event) {
    const step = KEYS[event.key];
    const zoom = { "+": 1.1, "=": 1.1, "-": 1 / 1.1 }[event.key];
    if (!step && !zoom) return;
    event.preventDefault();
    const { target } = this.#controls;
    const from = this.#camera.position.clone().sub(target);
    if (this.#flat) {
      const move = (0.1 * (this.#camera.userData.half ?? 1)) / this.#camera.zoom;
      if (step) target.add(new THREE.Vector3(step[0] * move, step[1] * move, 0));
      if (zoom) this.#camera.zoom *= zoom;
    } else {
      const round = new THREE.Spherical().setFromVector3(from);
      if (step) round.theta -= step[0] * 0.1;
      if (step) round.phi = Math.min(Math.max(round.phi - step[1] * 0.1, 0.05), Math.PI - 0.05);
      if (zoom) round.radius /= zoom;
      from.setFromSpherical(round);
    }
    this.#camera.position.copy(target).add(from);
    this.#controls.update();
    this.draw();
  }
}

let board;

function checkerboard() {
  if (board) return board;
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 128;
  const context = canvas.getContext("2d");
  context.fillStyle = "#f4f4f0";
  context.fillRect(0, 0, 128, 128);
  context.fillStyle = "#7d8b96";
  context.fillRect(0, 0, 64, 64);
  context.fillRect(64, 64, 64, 64);
  board = new THREE.CanvasTexture(canvas);
  board.wrapS = board.wrapT = THREE.RepeatWrapping;
  board.colorSpace = THREE.SRGBColorSpace;
  board.anisotropy = 4;
  board.repeat.set(CHECKS / 2, CHECKS / 2);
  return board;
}
