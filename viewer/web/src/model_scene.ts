// ModelScene: the model in editing as a body, which the mouse turns. Drawn only when it changes, with a renderer of its
// own: the scene of the world may be large.
import {
  AmbientLight, BufferGeometry, Color, DirectionalLight, EdgesGeometry, ExtrudeGeometry, GridHelper, Group, LineBasicMaterial,
  LineSegments, Mesh, MeshLambertMaterial, PerspectiveCamera, Scene, Shape, WebGLRenderer,
} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import type {PictureBlock} from './file_client';
import {color} from './sheet';

export class ModelScene {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(35, 1, 0.01, 1000);
  private readonly controls: OrbitControls;
  private bodies = new Group();
  private reach = 0;  // m, the greatest coordinate of a shown point
  private waiting = false;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({canvas, antialias: true});
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', () => this.invalidate());
    const sun = new DirectionalLight(0xffffff, 2);
    sun.position.set(-2, -3, 5);
    this.scene.add(new AmbientLight(0xffffff, 1.4), sun);
    new ResizeObserver(() => this.invalidate()).observe(canvas);
  }

  // `blocks`: in m, as the file and the page have them.
  show(blocks: PictureBlock[], fallback: string): void {
    this.bodies.traverse(each => {
      if (each instanceof Mesh || each instanceof LineSegments) {
        (each.geometry as BufferGeometry).dispose();
        each.material.dispose();
      }
    });
    this.scene.remove(this.bodies);
    this.bodies = new Group();
    let reach = 0.2;
    for (const {outline, z, color: own} of blocks) {
      if (outline.length < 3 || z[1] <= z[0]) continue;
      const shape = new Shape();
      outline.forEach(([x, y], i) => {
        if (i === 0) shape.moveTo(x, y);
        else shape.lineTo(x, y);
        reach = Math.max(reach, Math.abs(x), Math.abs(y));
      });
      reach = Math.max(reach, z[1]);
      const geometry = new ExtrudeGeometry(shape, {depth: z[1] - z[0], bevelEnabled: false});
      const fill = own ? new Color().setRGB(...own, 'srgb') : new Color(fallback);
      const mesh = new Mesh(geometry, new MeshLambertMaterial({color: fill}));
      const edges = new LineSegments(new EdgesGeometry(geometry), new LineBasicMaterial({color: 0x20242b}));
      mesh.position.z = edges.position.z = z[0];
      this.bodies.add(mesh, edges);
    }
    const side = Math.max(1, Math.ceil(2.4 * reach));
    const grid = new GridHelper(side, 10 * side <= 60 ? 10 * side : side, color('--faint'), color('--grid'));
    grid.rotation.x = Math.PI / 2;
    this.bodies.add(grid);
    this.scene.add(this.bodies);
    if (Math.abs(reach - this.reach) > 0.3 * this.reach) {
      this.reach = reach;
      this.controls.target.set(0, 0, 0.35 * reach);
      this.camera.position.set(2.6 * reach, -3 * reach, 2.4 * reach);
      this.controls.update();
    }
    this.invalidate();
  }

  private invalidate(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      const {clientWidth, clientHeight} = this.canvas;
      if (clientWidth === 0 || clientHeight === 0) return;
      this.renderer.setSize(clientWidth, clientHeight, false);
      this.camera.aspect = clientWidth / clientHeight;
      this.camera.updateProjectionMatrix();
      this.scene.background = new Color(color('--ground'));
      this.renderer.render(this.scene, this.camera);
    });
  }
}
