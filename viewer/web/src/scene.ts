// WorldScene: the picture of a run. It is drawn only when something has changed: a page in a corner of the screen costs
// nothing while the run is paused.
//
// The world's axes are those of three.js with z up. Static parts are meshes per world; bodies are placed per update or,
// between two updates, per frame (motion.ts). Levels of a building are drawn by shifting the camera and clipping, not
// by moving bodies.
import {
  Box3, Color, Mesh, MeshBasicMaterial, Object3D, OrthographicCamera, PCFSoftShadowMap, PerspectiveCamera, Plane,
  Raycaster, RingGeometry, Scene, Vector2, Vector3, type WebGLRenderer
} from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';
import {Bodies, Labels} from './bodies';
import {GoalMarks} from './goals';
import {makeGraphics, Quality} from './graphics';
import {Levels, planesOf} from './levels';
import {Motion, Trails} from './motion';
import type {Pose, World} from './protocol';
import {findEntity, isAway, poseOf, toMatrix, type Entity, type Run} from './run';
import {Rings, type Ringed} from './rings';
import {Rays, SensorMarks} from './sensor_marks';
import {Ground, StaticMap} from './static_map';
import {Surfaces} from './surfaces';
import {TrafficMarks} from './traffic_marks';
import {ZoneMarks} from './zone_marks';
import {VehicleMarks} from './vehicle_marks';
import type {VehicleState} from './vehicles';

export type ViewName = 'orbit' | 'top';

// The places of a world's parts that do not change with the state.
interface Setting {
  world: World;
  map: StaticMap;
  bodies: Bodies;
  ground: Ground;
}

const MARGIN = 0.04;  // of the picture, around the whole world
const LOW_VIEW = 0.92;  // rad from above, of the whole world in the orbit view
const HIGH_VIEW = 0.5;  // the same in a picture that would be empty above and below the world
const FILLED = 0.72;  // of the picture's height, with which it is not
const RING_WIDTH = 3;  // px, of the mark of the selection
const TURN = 0.09;  // rad of the camera for a key
const SHIFT = 0.06;  // of the picture's height, the same
const GROUND_LAYER = 1;  // that of three.js in which the ground is, and nothing else
const MOST_SHADOWS = 400;  // bodies; beyond that shadows cost more than they show

function colorOf(name: string): Color {
  return new Color(getComputedStyle(document.documentElement).getPropertyValue(name).trim());
}

export class WorldScene {
  readonly labels: Labels;
  readonly trails = new Trails();
  readonly traffic = new TrafficMarks();
  readonly zones = new ZoneMarks();
  readonly vehicle = new VehicleMarks();
  readonly motion = new Motion();
  view: ViewName = 'orbit';
  following = false;
  levels = new Levels();
  levelsChanged: () => void = () => {};  // others are shown, or in another way
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly perspective = new PerspectiveCamera(45, 1, 0.05, 5000);
  private readonly orthographic = new OrthographicCamera(-1, 1, 1, -1, 0.1, 5000);
  private readonly orbit: OrbitControls;
  private readonly top: OrbitControls;
  private readonly surfaces: Surfaces;
  private readonly rays = new Rays();
  private readonly marks = new SensorMarks();
  private readonly goals = new GoalMarks();
  private readonly rings = new Rings(RING_WIDTH);  // of the selection
  private readonly ghostRings = new Rings(RING_WIDTH);  // where what is dragged with the ghost would be
  private readonly ghost = new Mesh(
    new RingGeometry(0.86, 1, 48), new MeshBasicMaterial({transparent: true, opacity: 0.9, depthWrite: false}));
  private readonly raycaster = new Raycaster();
  private setting: Setting | null = null;
  private run: Run | null = null;
  private drawn: Run | null = null;  // with the poses that are drawn
  private selected: Entity | null = null;
  private followed: Vector3 | null = null;  // where the followed robot was
  private dirty = true;
  private preview: Object3D | null = null;
  private framed = false;  // the whole world is in the picture, until the camera is moved
  private moved = false;  // the bodies are drawn between two states
  // Of a world in editing: how far the ground reaches from the origin at least, m; the place that a pointer chooses instead
  // of the one below it; and where what is dragged would be.
  leastReach = 0;
  chosenPlace: (point: Vector3) => Vector3 = point => point;
  ghostMoved: (pose: Pose | null) => void = () => {};
  alsoSelected: Entity[] = [];  // with the one that is
  readonly quality: Quality;

  // `full`: everything is drawn, however slow that is.
  constructor(private readonly parent: HTMLElement, full: boolean) {
    const {renderer, fast} = makeGraphics(full);
    this.quality = new Quality(fast ? 0 : 2, full);
    this.renderer = renderer;
    this.surfaces = new Surfaces(fast);
    this.renderer.debug.checkShaderErrors = false;  // a check waits until they are compiled
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFSoftShadowMap;
    parent.append(this.renderer.domElement);
    this.labels = new Labels(parent);
    for (const light of this.surfaces.lights()) light.layers.enableAll();
    for (const camera of [this.perspective, this.orthographic]) camera.layers.enableAll();
    this.scene.add(
      ...this.surfaces.lights(), this.rays.group, this.marks.group, this.trails.lines, this.goals.lines, this.zones.group,
      this.traffic.group, this.vehicle.group, this.rings.group, this.ghostRings.group, this.ghost);
    this.ghost.visible = false;
    this.ghost.add(new Mesh(new RingGeometry(1, 1.5, 3, 1, -0.12, 0.24), this.ghost.material));
    this.ghost.renderOrder = 2;
    this.perspective.up.set(0, 0, 1);
    this.orthographic.up.set(0, 1, 0);
    this.orbit = new OrbitControls(this.perspective, this.renderer.domElement);
    this.orbit.maxPolarAngle = 0.495 * Math.PI;
    this.orbit.zoomToCursor = true;
    this.top = new OrbitControls(this.orthographic, this.renderer.domElement);
    this.top.enableRotate = false;
    this.top.screenSpacePanning = true;
    this.top.zoomToCursor = true;
    this.top.mouseButtons = {LEFT: 2, MIDDLE: 1, RIGHT: 2};
    this.top.touches = {ONE: 1, TWO: 2};
    for (const controls of [this.orbit, this.top]) controls.addEventListener('change', () => this.invalidate());
    for (const controls of [this.orbit, this.top]) controls.addEventListener('start', () => { this.framed = false; });
    new ResizeObserver(() => this.resize()).observe(parent);
    this.resize();
    this.setView('orbit');
    const frame = (now: number): void => {
      requestAnimationFrame(frame);
      if (this.quality.next(now)) this.applyQuality();
      if (this.motion.moves(now) || this.moved) this.place();
      if (!this.dirty || !this.setting) return;
      this.draw();
      this.quality.drawn(now);
    };
    requestAnimationFrame(frame);
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }
  get camera(): PerspectiveCamera | OrthographicCamera {
    return this.view === 'orbit' ? this.perspective : this.orthographic;
  }
  get bodies(): Bodies | null {
    return this.setting?.bodies ?? null;
  }

  invalidate(): void {
    this.dirty = true;
  }

  // `keepCamera`: the world has been edited, or is the previous one.
  setWorld(world: World, keepCamera: boolean): void {
    this.clear();
    const bodies = new Bodies(world, this.surfaces);
    const map = new StaticMap(world, this.surfaces, model => bodies.contains(model));
    const choice = this.levels.choice;
    this.levels = new Levels(world.levels);
    this.levels.choose(choice);
    const box = this.contentBox(world, map);
    const ground = this.makeGround(box);
    this.setting = {world, map, bodies, ground};
    this.scene.add(ground.group, map.group, bodies.group);
    const {x, y} = box.getSize(new Vector3());
    this.surfaces.aimSun(box.getCenter(new Vector3()), Math.max(x, y, 2));
    this.applyQuality();
    this.applyTheme();
    if (!keepCamera) {
      this.trails.clear();
      this.frame(box);
    }
    this.levelsChanged();
  }

  // "stacked", "beside", or the name of a level.
  chooseLevels(choice: string): void {
    const before = this.levels.choice;
    this.levels.choose(choice);
    if (!this.setting || this.levels.choice === before) return;
    const {world, map, ground} = this.setting;
    const box = this.contentBox(world, map);
    this.scene.remove(ground.group);
    ground.dispose();
    this.setting.ground = this.makeGround(box);
    this.scene.add(this.setting.ground.group);
    this.applyTheme();
    this.applyQuality();
    if (before === 'beside' || choice === 'beside') this.frame(box);
    this.followed = null;
    this.levelsChanged();
  }

  private makeGround(box: Box3): Ground {
    const ground = new Ground(box, this.surfaces);
    ground.group.traverse(part => part.layers.set(GROUND_LAYER));
    return ground;
  }

  clear(): void {
    if (!this.setting) return;
    const {map, bodies, ground} = this.setting;
    this.scene.remove(map.group, bodies.group, ground.group);
    for (const part of [map, bodies, ground]) part.dispose();
    this.setting = null;
    this.run = this.drawn = null;
    this.alsoSelected = [];
    this.labels.clear();
    this.invalidate();
  }

  show(run: Run, selected: Entity | null): void {
    if (!this.setting || run.world !== this.setting.world) return;
    const isFirst = this.run === null;
    this.run = run;
    if (isFirst && this.framed) this.home();  // robots and objects may be far from their starts
    this.selected = selected;
    this.motion.update(run, performance.now());
    this.trails.show(run);
    this.goals.show(run);
    this.place();
  }

  // The vehicle of VDA 5050 whose way is shown; null: none.
  setVehicle(robot: number, state: VehicleState | null): void {
    if (this.vehicle.set(robot, state)) this.invalidate();
  }

  // Puts everything where it is drawn now.
  private place(): void {
    if (!this.setting || !this.run) return;
    const now = performance.now();
    this.moved = this.motion.moves(now);
    const run = this.drawn = this.motion.view(this.run, now);
    const selected = this.selected;
    this.setting.bodies.place(run, selected);
    this.setting.map.show(run);
    this.rays.show(run, this.setting.bodies);
    this.marks.show(run);
    this.zones.show(run);
    this.traffic.show(run);
    this.vehicle.show(run);
    const poseIn = (entity: Entity): Pose | null => {
      const placed = poseOf(run, entity);
      return placed && !isAway(placed) ? placed : null;
    };
    const pose = selected ? poseIn(selected) : null;
    const {bodies} = this.setting;
    this.rings.show([...(selected ? [selected] : []), ...this.alsoSelected].flatMap((entity): Ringed[] => {
      const at = poseIn(entity);
      return at ? [{pose: at, radius: bodies.radiusOf(entity)}] : [];
    }));
    this.follow(pose);
    this.invalidate();
  }

  setView(view: ViewName): void {
    if (view === 'top' && this.view !== 'top') {
      this.orthographic.position.set(this.orbit.target.x, this.orbit.target.y, 1000);
      this.top.target.set(this.orbit.target.x, this.orbit.target.y, 0);
      const distance = this.perspective.position.distanceTo(this.orbit.target);
      const height = 2 * distance * Math.tan((this.perspective.fov * Math.PI) / 360);
      this.orthographic.zoom = (this.orthographic.top - this.orthographic.bottom) / height;
      this.orthographic.updateProjectionMatrix();
    } else if (view === 'orbit' && this.view !== 'orbit') {
      const shift = this.top.target.clone().sub(this.orbit.target).setZ(0);
      this.orbit.target.add(shift);
      this.perspective.position.add(shift);
    }
    this.view = view;
    this.applyQuality();
    this.orbit.enabled = view === 'orbit';
    this.top.enabled = view === 'top';
    this.orbit.update();
    this.top.update();
    this.invalidate();
  }

  // The whole world in the picture, as it is now.
  home(): void {
    if (this.setting) this.frame(this.contentBox(this.setting.world, this.setting.map));
  }

  // How far what is in the world reaches from the origin, m: to -x, -y, x, y.
  reach(): number[] {
    if (!this.setting) return [];
    const {min, max} = this.contentBox(this.setting.world, this.setting.map);
    return [-min.x, -min.y, max.x, max.y];
  }

  // The camera by keys: x and y are -1, 0 or 1. It turns around its target; `shift`, and from above: it moves.
  moveByKeys(x: number, y: number, shift: boolean): void {
    const {target} = this.view === 'orbit' ? this.orbit : this.top;
    const back = this.camera.position.clone().sub(target);
    if (this.view === 'top') {
      const step = (SHIFT * (this.orthographic.top - this.orthographic.bottom)) / this.orthographic.zoom;
      return this.shiftBy(new Vector3(x * step, y * step, 0));
    }
    if (shift) {
      const away = back.clone().setZ(0).normalize().negate();
      const right = new Vector3(away.y, -away.x, 0);
      const step = SHIFT * 2 * back.length() * Math.tan((this.perspective.fov * Math.PI) / 360);
      return this.shiftBy(right.multiplyScalar(x * step).addScaledVector(away, y * step));
    }
    this.framed = false;
    const polar = Math.acos(back.z / back.length());
    const next = Math.max(0.02, Math.min(this.orbit.maxPolarAngle, polar - y * TURN));
    const azimuth = Math.atan2(back.y, back.x) + x * TURN;
    const flat = back.length() * Math.sin(next);
    this.perspective.position.copy(target).add(
      new Vector3(flat * Math.cos(azimuth), flat * Math.sin(azimuth), back.length() * Math.cos(next)));
    this.orbit.update();
    this.invalidate();
  }

  zoomBy(factor: number): void {
    this.framed = false;
    if (this.view === 'top') {
      this.orthographic.zoom *= factor;
      this.orthographic.updateProjectionMatrix();
    } else {
      const {target} = this.orbit;
      this.perspective.position.sub(target).multiplyScalar(1 / factor).add(target);
      this.orbit.update();
    }
    this.invalidate();
  }

  setControlsEnabled(enabled: boolean): void {
    (this.view === 'orbit' ? this.orbit : this.top).enabled = enabled;
  }

  centerOn(entity: Entity): void {
    const pose = this.run ? poseOf(this.run, entity) : null;
    if (!pose) return;
    this.shiftTo(this.drawnPlace(pose));
  }

  applyTheme(): void {
    this.scene.background = colorOf('--sky');
    this.rings.setColor(colorOf('--accent'));
    this.ghostRings.setColor(colorOf('--accent'));
    this.ghost.material.color = colorOf('--accent');
    this.rays.setColor(colorOf('--rays'));
    this.traffic.setColors(colorOf('--stalled'), colorOf('--lost'));
    this.setting?.bodies.setStalledColor(colorOf('--stalled'));
    this.setting?.ground.setColors(colorOf('--ground'), colorOf('--grid'));
    this.setting?.map.setEdgeColor(colorOf('--edges'));
    this.invalidate();
  }

  // The entity at a place of the window.
  pick(clientX: number, clientY: number): Entity | null {
    if (!this.setting) return null;
    const {bodies} = this.setting;
    this.aim(clientX, clientY);
    if (this.levels.areStacked) return bodies.pick(this.raycaster, -Infinity, Infinity)?.entity ?? null;
    const {origin} = this.raycaster.ray;
    const hits = this.levels.drawn.flatMap(({from, to, shift}) => {
      origin.sub(shift);
      const hit = bodies.pick(this.raycaster, from, to);
      origin.add(shift);
      return hit ?? [];
    });
    return hits.sort((a, b) => a.distance - b.distance)[0]?.entity ?? null;
  }

  // The point of the plane z at a place of the window; null: none.
  pointAt(clientX: number, clientY: number, z: number): Vector3 | null {
    this.aim(clientX, clientY);
    const shift = this.levels.shiftAt(z);
    if (!shift) return null;
    const point = this.raycaster.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), -(z + shift.z)), new Vector3());
    return point && this.chosenPlace(point.sub(shift));
  }

  // The point of the floor there: of the ground, or of the level that is drawn on it.
  floorAt(clientX: number, clientY: number): Vector3 | null {
    if (this.levels.areStacked) return this.pointAt(clientX, clientY, 0);
    const ground = this.levels.list[0].z;
    this.aim(clientX, clientY);
    const point = this.raycaster.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), -ground), new Vector3());
    return point && this.chosenPlace(point.sub(this.levels.levelAtDrawn(point).shift));
  }

  placeOfName(name: string): {x: number; y: number} | null {
    const entity = this.run ? findEntity(this.run.world, name) : null;
    return entity && this.placeOf(entity);
  }

  // Where an entity is on the window.
  placeOf(entity: Entity): {x: number; y: number} | null {
    const pose = this.run ? poseOf(this.run, entity) : null;
    if (!pose || !this.setting) return null;
    const z = pose.z + 0.5 * this.setting.bodies.topOf(entity);
    return this.project(new Vector3(pose.x, pose.y, z));
  }

  project(point: Vector3): {x: number; y: number} {
    this.camera.updateMatrixWorld();
    const p = this.drawnPlace(point).project(this.camera);
    const box = this.canvas.getBoundingClientRect();
    return {x: box.left + ((p.x + 1) / 2) * box.width, y: box.top + ((1 - p.y) / 2) * box.height};
  }

  add(object: Object3D): void {
    this.scene.add(object);
  }

  // The place where an entity would be put. `type`: of the model, whose body is shown if the world has one.
  showGhost(pose: Pose | null, radius: number, type = ''): void {
    this.ghostMoved(pose);
    this.ghost.visible = pose !== null;
    const body = pose && type ? this.bodies?.previewOf(type) ?? null : null;
    if (this.preview && this.preview !== body) this.scene.remove(this.preview);
    if (body && this.preview !== body) this.scene.add(body);
    this.preview = body;
    if (pose && body) toMatrix(pose, body.matrix);
    if (pose) {
      this.ghost.position.set(pose.x, pose.y, pose.z + 0.015);
      this.ghost.rotation.z = pose.heading;
      this.ghost.scale.setScalar(1.3 * radius);
    }
    this.invalidate();
  }

  // The places of others that are dragged with it.
  showGhostRings(ringed: Ringed[]): void {
    this.ghostRings.show(ringed);
    this.invalidate();
  }

  // The present picture, to the size of the canvas.
  drawInto(context: CanvasRenderingContext2D): void {
    this.draw();
    context.drawImage(this.canvas, 0, 0, context.canvas.width, context.canvas.height);
  }

  // PNG, of the size of the window or, with `width` and `height`, of so many pixels.
  picture(width = 0, height = 0): string {
    if (width > 0) {
      this.renderer.setPixelRatio(1);
      this.setSize(width, height);
    }
    this.draw();
    const data = this.canvas.toDataURL('image/png');
    if (width > 0) {
      this.applyQuality();
      this.setSize(this.parent.clientWidth, this.parent.clientHeight);
    }
    return data;
  }

  // Where the camera is and looks at, as a text for an address.
  get cameraText(): string {
    const {target} = this.view === 'orbit' ? this.orbit : this.top;
    const {x, y, z} = this.perspective.position;
    const numbers = this.view === 'orbit' ? [x, y, z, target.x, target.y, target.z] : [target.x, target.y, this.orthographic.zoom];
    return numbers.map(value => Number(value.toFixed(3))).join(',');
  }

  // From such a text; another one changes nothing.
  setCamera(text: string): void {
    const numbers = text.split(',').map(Number);
    if (numbers.length !== (this.view === 'orbit' ? 6 : 3) || !numbers.every(Number.isFinite)) return;
    const [x, y, z, ...to] = numbers;
    if (this.view === 'orbit') {
      this.perspective.position.set(x, y, z);
      this.orbit.target.set(to[0], to[1], to[2]);
      this.orbit.update();
    } else {
      this.top.target.set(x, y, 0);
      this.orthographic.position.set(x, y, 1000);
      this.orthographic.zoom = Math.max(1e-3, z);
      this.orthographic.updateProjectionMatrix();
      this.top.update();
    }
    this.framed = false;
    this.invalidate();
  }

  // The length of a pixel at a point, m.
  pixelAt(point: {x: number; y: number; z: number}): number {
    const {top, bottom, zoom} = this.orthographic;
    const height = this.view === 'top' ? (top - bottom) / zoom
      : 2 * Math.tan((this.perspective.fov * Math.PI) / 360) * this.perspective.position.distanceTo(this.drawnPlace(point));
    return height / Math.max(1, this.canvas.clientHeight);
  }

  private draw(): void {
    this.dirty = false;
    for (const rings of [this.rings, this.ghostRings]) rings.fit(point => this.pixelAt(point));
    if (this.levels.areStacked) this.renderer.render(this.scene, this.camera);
    else this.drawLevels();
    this.labels.place(this.drawn, this.bodies, this.camera, this.selected, this.levels);
  }

  // The ground, and then each level over it, with a camera that is shifted instead of the level.
  private drawLevels(): void {
    const {camera, renderer, scene} = this;
    const {background} = scene;
    camera.layers.set(GROUND_LAYER);
    renderer.render(scene, camera);
    scene.background = null;  // it would clear the picture
    renderer.autoClear = false;
    camera.layers.set(0);
    for (const part of this.levels.drawn) {
      camera.position.sub(part.shift);
      camera.updateMatrixWorld();
      renderer.clippingPlanes = planesOf(part);
      renderer.render(scene, camera);
      camera.position.add(part.shift);
    }
    camera.updateMatrixWorld();
    camera.layers.enableAll();
    renderer.clippingPlanes = [];
    renderer.autoClear = true;
    scene.background = background;
  }

  // Where a point is drawn.
  private drawnPlace({x, y, z}: {x: number; y: number; z: number}): Vector3 {
    return new Vector3(x, y, z).add(this.levels.shiftAt(z) ?? new Vector3());
  }

  private applyQuality(): void {
    const world = this.setting?.world;
    const isSmall = world !== undefined && world.robots.length + world.objects.length + world.people.length <= MOST_SHADOWS;
    this.surfaces.sun.castShadow = this.view === 'orbit' && this.levels.areStacked && isSmall && this.quality.level === 0;
    this.renderer.setPixelRatio(this.quality.pixelRatio);
    this.labels.most = this.quality.mostNames;
    this.invalidate();
  }

  private aim(clientX: number, clientY: number): void {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(((clientX - box.left) / box.width) * 2 - 1, 1 - ((clientY - box.top) / box.height) * 2);
    this.camera.updateMatrixWorld();
    this.raycaster.setFromCamera(at, this.camera);
  }

  private follow(pose: Pose | null): void {
    if (!this.following || !pose) {
      this.followed = null;
      return;
    }
    if (!this.levels.shiftAt(pose.z)) this.chooseLevels(this.levels.list[this.levels.numberAt(pose.z)].name);
    const at = this.drawnPlace(pose);
    if (this.followed) this.shiftBy(at.clone().sub(this.followed));
    else this.shiftTo(at);
    this.followed = at;
  }

  private shiftTo(point: Vector3): void {
    this.shiftBy(point.clone().sub(this.view === 'orbit' ? this.orbit.target : this.top.target));
  }

  private shiftBy(shift: Vector3): void {
    this.framed = false;
    if (this.view === 'top') shift.setZ(0);
    const controls = this.view === 'orbit' ? this.orbit : this.top;
    controls.target.add(shift);
    this.camera.position.add(shift);
    controls.update();
    this.invalidate();
  }

  private contentBox(world: World, map: StaticMap): Box3 {
    const box = new Box3().setFromObject(map.group);
    const add = (pose: Pose): Box3 => isAway(pose) ? box : box.expandByPoint(new Vector3(pose.x, pose.y, pose.z));
    world.robots.forEach(({present, root}, i) => present && add(this.run?.robots[i]?.pose ?? world.models[root].poseInParent));
    world.objects.forEach((root, i) => add(this.run?.objects[i]?.pose ?? world.models[root].poseInParent));
    world.people.forEach(({root}, i) => add(this.run?.people[i]?.pose ?? world.models[root].poseInParent));
    const reach = this.leastReach;
    if (reach > 0) box.expandByPoint(new Vector3(-reach, -reach, 0)).expandByPoint(new Vector3(reach, reach, 0));
    if (box.isEmpty()) box.set(new Vector3(-5, -5, 0), new Vector3(5, 5, 1));
    this.levels.setBox(box);
    return this.levels.drawnBox();
  }

  private frame(box: Box3): void {
    // The box has the places of robots and objects, not their extents.
    const all = box.clone().expandByVector(new Vector3(0.4, 0.4, 0));
    const size = all.getSize(new Vector3());
    const width = Math.max(size.x, 4);
    const depth = Math.max(size.y, 4);
    const center = all.getCenter(new Vector3()).setZ(0);
    this.top.target.copy(center);
    this.orthographic.position.set(center.x, center.y, 1000);
    const share = 1 - 2 * MARGIN;
    const {left, right, top, bottom} = this.orthographic;
    this.orthographic.zoom = share * Math.min((right - left) / width, (top - bottom) / depth);
    this.orthographic.updateProjectionMatrix();
    this.top.update();
    this.frameOrbit(center, width, depth, Math.max(all.max.z, 0.5));
    this.framed = true;
    this.invalidate();
  }

  // In a high picture the longer side of the world goes away from the viewer, and the camera looks from higher.
  private frameOrbit(center: Vector3, width: number, depth: number, height: number): void {
    const azimuth = width > depth && this.perspective.aspect < 0.8 ? Math.PI / 2 : 0;
    const corners = [-1, 1].flatMap(x => [-1, 1].flatMap(y => [0, height].map(
      z => new Vector3(0.5 * x * width, 0.5 * y * depth, z))));
    let polar = LOW_VIEW;
    let fit = this.fitOrbit(corners, azimuth, polar);
    while (fit.filled < FILLED && polar > HIGH_VIEW) {
      polar -= 0.06;
      fit = this.fitOrbit(corners, azimuth, polar);
    }
    this.orbit.target.copy(center).add(fit.shift);
    this.perspective.position.copy(this.orbit.target).addScaledVector(fit.toCamera, fit.distance);
    this.orbit.update();
  }

  // So near that all corners, which are relative to the middle of the world, are in the picture. `filled`: of its height;
  // `shift`: of the target, on the ground.
  private fitOrbit(corners: Vector3[], azimuth: number, polar: number):
      {toCamera: Vector3; shift: Vector3; distance: number; filled: number} {
    const toCamera = new Vector3(
      -Math.sin(azimuth) * Math.sin(polar), -Math.cos(azimuth) * Math.sin(polar), Math.cos(polar));
    const right = new Vector3(Math.cos(azimuth), -Math.sin(azimuth), 0);
    const up = new Vector3().crossVectors(toCamera, right);
    const tangent = (1 - 2 * MARGIN) * Math.tan((this.perspective.fov * Math.PI) / 360);
    let low = 0;
    let distance = 1;
    let filled = 0;
    // The middle of the picture is below the middle of the world, because what is near is larger: found in a few rounds.
    for (let round = 0; round < 8; ++round) {
      const place = corners.map(corner => ({
        x: corner.dot(right), y: corner.dot(up) - low, back: corner.dot(toCamera),
      }));
      distance = Math.max(...place.map(({x, y, back}) =>
        back + Math.max(Math.abs(x) / (tangent * this.perspective.aspect), Math.abs(y) / tangent)));
      const heights = place.map(({y, back}) => y / (distance - back));
      filled = (Math.max(...heights) - Math.min(...heights)) / (2 * tangent);
      low += 0.5 * distance * (Math.max(...heights) + Math.min(...heights));
    }
    const shift = new Vector3(Math.sin(azimuth), Math.cos(azimuth), 0).multiplyScalar(low / Math.cos(polar));
    return {toCamera, shift, distance: distance - shift.dot(toCamera), filled};
  }

  private resize(): void {
    this.setSize(Math.max(1, this.parent.clientWidth), Math.max(1, this.parent.clientHeight));
    if (this.framed) this.home();
    this.invalidate();
  }

  // Of the picture, px.
  private setSize(width: number, height: number): void {
    this.renderer.setSize(width, height);
    this.labels.setSize(width, height);
    this.perspective.aspect = width / height;
    this.perspective.updateProjectionMatrix();
    Object.assign(this.orthographic, {left: (-10 * width) / height, right: (10 * width) / height, top: 10, bottom: -10});
    this.orthographic.updateProjectionMatrix();
    this.invalidate();
  }
}
