// Bodies: the robots and the objects in the scene. A body is a tree of links, as in common/spatial/scene.h: link 0 is
// its root with everything that no joint moves, but for lights, which are links of their own. Links of equal geometry
// are instances of one mesh, so that a thousand robots are drawn by a few calls.
//
// Geometry is made once per world; an update writes one matrix per link. Colours of instances are written only when
// they change, because each write sends the whole buffer to the graphics.
import {
  Box3, BufferGeometry, Color, DynamicDrawUsage, Group, InstancedMesh, Matrix4, Mesh, Raycaster, Sphere, Vector3, type
  Camera
} from 'three';
import type {Levels} from './levels';
import type {Pose, World} from './protocol';
import {compose, IDENTITY, isAway, jointMotion, poseOf, rootOf, sameEntity, toMatrix, type Entity, type Run} from './run';
import {softened, type GeometryBuilder, type Rgb, type SurfaceMaterial, type Surfaces} from './surfaces';

interface Part {
  model: number;
  pose: Pose;  // in the link
}

interface Link {
  joint: number;  // -1: link 0, or a light
  light: number;  // of the world's lights: drawn by itself, because it may be dark; -1: none
  parent: number;  // link
  pose: Pose;  // in the parent link, at joint position 0
  parts: Part[];
  batch: Batch | null;  // null: nothing to draw
  instance: number;
  color: Color | null;  // that the instance has; null: another one
}

interface Body {
  entity: Entity;
  links: Link[];
  radius: number;
  top: number;  // m above its pose
}

interface Batch {
  geometry: BufferGeometry;
  owners: Entity[];  // by instance
  mesh: InstancedMesh | null;
  isRecolored: boolean;  // since it was drawn
}

const PLAIN = new Color(1, 1, 1);
export const DARK = new Color(0.06, 0.06, 0.06);  // a quarter of the colour's components, as cameras see it
const SELECTED = new Color(1.2, 1.2, 1.25);

// The colour of an instance is a factor of the colours of its parts. A negative one replaces them, with their lightness.
function paintNegative(material: SurfaceMaterial): void {
  material.onBeforeCompile = shader => {
    shader.vertexShader = shader.vertexShader.replace('#include <color_vertex>', `#include <color_vertex>
      #ifdef USE_INSTANCING_COLOR
        if (instanceColor.r < 0.0) vColor.xyz = -instanceColor.xyz * (0.6 + 0.4 * max(color.r, max(color.g, color.b)));
      #endif`);
  };
}

export class Bodies {
  readonly group = new Group();
  private readonly bodies: Body[] = [];
  private readonly ofRobots: Body[] = [];  // by index, like the next
  private readonly ofObjects: Body[] = [];
  private readonly ofPeople: Body[] = [];
  private readonly batches = new Map<string, Batch>();
  private readonly linkOfModel = new Map<number, {body: Body; link: number; pose: Pose}>();
  private readonly matrix = new Matrix4();
  private readonly stalled = new Color();  // for paintNegative
  private readonly previews = new Map<string, Group>();
  private readonly material: SurfaceMaterial;
  private readonly ghost: SurfaceMaterial;
  private readonly lightOfModel: Map<number, number>;

  constructor(private readonly world: World, private readonly surfaces: Surfaces) {
    this.material = surfaces.material({vertexColors: true});
    paintNegative(this.material);
    this.ghost = surfaces.material({vertexColors: true, transparent: true, opacity: 0.5});
    this.lightOfModel = new Map(world.lights.map(({model}, i) => [model, i]));
    world.robots.forEach((robot, index) => {
      if (robot.present) this.addBody({kind: 'robot', index}, robot.root);
    });
    world.objects.forEach((root, index) => {
      if (!world.models[root].removed) this.addBody({kind: 'object', index}, root);
    });
    world.people.forEach(({root}, index) => {
      if (!world.models[root].removed) this.addBody({kind: 'person', index}, root);
    });
    for (const batch of this.batches.values()) {
      const mesh = new InstancedMesh(batch.geometry, this.material, batch.owners.length);
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      mesh.frustumCulled = false;
      mesh.castShadow = true;
      mesh.receiveShadow = true;
      mesh.userData.batch = batch;
      for (let i = 0; i < batch.owners.length; ++i) mesh.setColorAt(i, PLAIN);
      batch.mesh = mesh;
      this.group.add(mesh);
    }
  }

  setStalledColor(color: Color): void {
    this.stalled.copy(color).multiplyScalar(-1);
    for (const {links} of this.bodies) for (const link of links) link.color = null;
  }

  // True for models of bodies, which are no part of the static map.
  contains(model: number): boolean {
    return this.linkOfModel.has(model);
  }

  place(run: Run, selected: Entity | null): void {
    for (const body of this.bodies) {
      const links = this.linkPoses(body, run);
      if (!links) continue;
      const stalled = body.entity.kind === 'robot' && run.robots[body.entity.index].stalled;
      const color = stalled ? this.stalled : sameEntity(body.entity, selected) ? SELECTED : PLAIN;
      for (let i = 0; i < links.length; ++i) {
        const link = body.links[i];
        const {batch} = link;
        if (!batch?.mesh) continue;
        batch.mesh.setMatrixAt(link.instance, isAway(links[i]) ? this.matrix.makeScale(0, 0, 0) : toMatrix(links[i], this.matrix));
        const shown = link.light >= 0 && !run.isLit(this.world.lights[link.light]) ? DARK : color;
        if (link.color === shown) continue;
        link.color = shown;
        batch.mesh.setColorAt(link.instance, shown);
        batch.isRecolored = true;
      }
    }
    for (const batch of this.batches.values()) {
      const {mesh} = batch;
      if (!mesh) continue;
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor && batch.isRecolored) mesh.instanceColor.needsUpdate = true;
      batch.isRecolored = false;
      mesh.boundingSphere = null;  // else picking would use the poses of before
    }
  }

  private bodiesOf(kind: Entity['kind']): Body[] {
    return {robot: this.ofRobots, object: this.ofObjects, person: this.ofPeople}[kind];
  }

  radiusOf(entity: Entity): number {
    return this.bodyOf(entity)?.radius ?? 0.2;
  }

  topOf(entity: Entity): number {
    return this.bodyOf(entity)?.top ?? 0;
  }

  // The pose of a model of a body, in the world.
  poseOfModel(model: number, run: Run): Pose | null {
    const place = this.linkOfModel.get(model);
    const links = place ? this.linkPoses(place.body, run) : null;
    return place && links ? compose(links[place.link], place.pose) : null;
  }

  // The pose at which link 0 of an entity is drawn.
  drawnPose(entity: Entity): Pose | null {
    const link = this.bodyOf(entity)?.links[0];
    if (!link?.batch?.mesh) return null;
    link.batch.mesh.getMatrixAt(link.instance, this.matrix);
    const e = this.matrix.elements;
    return {x: e[12], y: e[13], z: e[14], heading: Math.atan2(e[1], e[0])};
  }

  // A transparent body like the first entity of that type, at its matrix; null: the world has none.
  previewOf(type: string): Group | null {
    const known = this.previews.get(type);
    if (known) return known;
    const body = this.bodies.find(({entity}) => {
      const model = this.world.models[rootOf(this.world, entity)];
      return model.type === type || model.name.replace(/[_:]?\d+$/, '') === type;
    });
    if (!body) return null;
    const group = new Group();
    group.matrixAutoUpdate = false;
    const poses: Pose[] = [IDENTITY];
    body.links.forEach((link, i) => {
      if (i > 0) poses.push(compose(poses[link.parent], link.pose));
      if (!link.batch) return;
      const mesh = new Mesh(link.batch.geometry, this.ghost);
      mesh.matrixAutoUpdate = false;
      toMatrix(poses[i], mesh.matrix);
      group.add(mesh);
    });
    this.previews.set(type, group);
    return group;
  }

  // The entity under a ray between two heights, and how far away it is.
  pick(raycaster: Raycaster, from: number, to: number): {entity: Entity; distance: number} | null {
    const hits = raycaster.intersectObjects(this.group.children, false);
    const hit = hits.find(({point}) => point.z >= from && point.z < to);
    if (!hit || hit.instanceId === undefined) return null;
    const batch = hit.object.userData.batch as Batch;
    return {entity: batch.owners[hit.instanceId], distance: hit.distance};
  }

  dispose(): void {
    for (const batch of this.batches.values()) {
      batch.geometry.dispose();
      batch.mesh?.dispose();
    }
    this.material.dispose();
    this.ghost.dispose();
  }

  private bodyOf(entity: Entity): Body | undefined {
    return this.bodiesOf(entity.kind)[entity.index];
  }

  private linkPoses(body: Body, run: Run): Pose[] | null {
    const root = poseOf(run, body.entity);
    if (!root) return null;
    const poses: Pose[] = [root];
    for (let i = 1; i < body.links.length; ++i) {
      const link = body.links[i];
      if (link.joint < 0) {
        poses.push(compose(poses[link.parent], link.pose));
        continue;
      }
      const position = run.joints[link.joint]?.position ?? 0;
      poses.push(compose(compose(poses[link.parent], link.pose), jointMotion(this.world.joints[link.joint], position)));
    }
    return poses;
  }

  private addBody(entity: Entity, root: number): void {
    const links: Link[] = [{joint: -1, light: -1, parent: 0, pose: IDENTITY, parts: [], batch: null, instance: 0, color: null}];
    const addLink = (joint: number, light: number, parent: number, pose: Pose): number =>
      links.push({joint, light, parent, pose, parts: [], batch: null, instance: 0, color: null}) - 1;
    const body: Body = {entity, links, radius: 0.05, top: 0};
    const models = this.world.models;
    const places = new Map<number, {link: number; pose: Pose}>([[root, {link: 0, pose: IDENTITY}]]);
    // A model's parent has a smaller index.
    for (let m = root; m < models.length; ++m) {
      if (m !== root) {
        const parent = places.get(models[m].parent);
        if (!parent) continue;
        const pose = compose(parent.pose, models[m].poseInParent);
        const joint = this.world.joints.findIndex(j => j.model === m);
        if (joint >= 0) places.set(m, {link: addLink(joint, -1, parent.link, pose), pose: IDENTITY});
        else places.set(m, {link: parent.link, pose});
      }
      const place = places.get(m)!;
      this.linkOfModel.set(m, {body, ...place});
      if (models[m].removed) continue;
      const light = this.lightOfModel.get(m);
      if (light === undefined) links[place.link].parts.push({model: m, pose: place.pose});
      else links[addLink(-1, light, place.link, place.pose)].parts.push({model: m, pose: IDENTITY});
    }
    for (const link of links) this.addInstance(link, entity, body);
    this.bodies.push(body);
    this.bodiesOf(entity.kind)[entity.index] = body;
  }

  private addInstance(link: Link, entity: Entity, body: Body): void {
    const models = this.world.models;
    const isRoot = link === body.links[0];
    const withNose = isRoot && entity.kind === 'robot';
    // Equal shapes, colours and places make equal geometry; names of models have no influence.
    const key = JSON.stringify([
      withNose, link.parts.map(({model, pose}) => [models[model].shape, models[model].color, pose]),
    ]);
    let batch = this.batches.get(key);
    if (!batch) {
      const geometry = this.makeGeometry(link, withNose);
      if (!geometry) return;
      batch = {geometry, owners: [], mesh: null, isRecolored: false};
      this.batches.set(key, batch);
    }
    link.batch = batch;
    link.instance = batch.owners.length;
    batch.owners.push(entity);
    if (!isRoot) return;
    const box = batch.geometry.boundingBox ?? new Box3();
    body.radius = new Sphere().setFromPoints([
      new Vector3(box.min.x, box.min.y, 0), new Vector3(box.max.x, box.max.y, 0),
    ]).radius;
    body.top = box.max.z;
  }

  private makeGeometry(link: Link, withNose: boolean): BufferGeometry | null {
    const builder = this.surfaces.builder();
    for (const {model, pose} of link.parts) {
      const {shape, color} = this.world.models[model];
      builder.addShape(this.world.shapes[shape], pose, softened(color.slice(0, 3) as Rgb));
    }
    if (builder.empty) return null;
    if (withNose) this.addNose(builder, link);
    const geometry = builder.build();
    geometry.computeBoundingBox();
    return geometry;
  }

  // A wedge on the widest block that shows the heading.
  private addNose(builder: GeometryBuilder, link: Link): void {
    let widest = 0;
    let middle = {x: 0, y: 0};
    let front = 0;
    let side = 0;
    let z = 0;
    for (const {model, pose} of link.parts) {
      for (const block of this.world.shapes[this.world.models[model].shape].blocks) {
        const box = new Box3();
        for (let i = 0; i < block.outline.length; i += 2) {
          const p = compose(pose, {x: block.outline[i], y: block.outline[i + 1], z: 0, heading: 0});
          box.expandByPoint(new Vector3(p.x, p.y, 0));
        }
        const area = (box.max.x - box.min.x) * (box.max.y - box.min.y);
        if (area <= widest * 1.0001 && !(area > 0.98 * widest && pose.z + block.top > z)) continue;
        widest = area;
        middle = {x: (box.min.x + box.max.x) / 2, y: (box.min.y + box.max.y) / 2};
        front = box.max.x - middle.x;
        side = 0.55 * Math.min(box.max.y - middle.y, front);
        z = pose.z + block.top;
      }
    }
    if (front <= 0 || side <= 0) return;
    const white: Rgb = [0.97, 0.97, 0.97];
    const at = (x: number, y: number): [number, number] => [middle.x + x, middle.y + y];
    builder.addFlat([at(0.96 * front, 0), at(0.35 * front, side), at(0.5 * front, 0)], z + 0.004, IDENTITY, white);
    builder.addFlat([at(0.96 * front, 0), at(0.5 * front, 0), at(0.35 * front, -side)], z + 0.004, IDENTITY, white);
  }
}

// The names of robots, as elements over the picture.

// px that a name covers: no other name may have them, names of a crowd would only cover each other.
const LETTER = 7;
const EDGES = 14;
const HEIGHT = 21;

export class Labels {
  visible = true;
  most = 120;
  private width = 1;  // px
  private height = 1;
  private readonly elements = new Map<number, HTMLElement>();  // by robot
  private readonly point = new Vector3();

  constructor(private readonly parent: HTMLElement) {}

  // Sets the size of the picture, px.
  setSize(width: number, height: number): void {
    this.width = width;
    this.height = height;
  }

  place(run: Run | null, bodies: Bodies | null, camera: Camera, selected: Entity | null, levels: Levels): void {
    const shown = new Set<number>();
    const taken: Array<[number, number, number]> = [];  // left, top, width
    if (run && bodies) {
      for (let i = 0; i < run.world.robots.length; ++i) {
        const robot = run.world.robots[i];
        const row = run.robots[i];
        const entity: Entity = {kind: 'robot', index: i};
        const isSelected = sameEntity(entity, selected);
        if (!robot.present || !row) continue;
        if (!isSelected && (!this.visible || shown.size >= this.most)) continue;
        const shift = levels.shiftAt(row.pose.z);
        if (!shift) continue;
        this.point.set(row.pose.x, row.pose.y, row.pose.z + bodies.topOf(entity)).add(shift).project(camera);
        const {x, y, z} = this.point;
        if (z > 1 || Math.abs(x) > 1 || Math.abs(y) > 1) continue;
        const left = ((x + 1) / 2) * this.width;
        const top = ((1 - y) / 2) * this.height;
        const wide = EDGES + LETTER * robot.name.length;
        const isFree = !taken.some(([a, b, c]) => Math.abs(a - left) < (wide + c) / 2 && Math.abs(b - top) < HEIGHT);
        if (!isFree && !isSelected) continue;
        taken.push([left, top, wide]);
        shown.add(i);
        const element = this.elementOf(i, robot.name);
        element.style.transform = `translate(${left}px, ${top}px) translate(-50%, -135%)`;
        element.classList.toggle('stalled', row.stalled);
        element.classList.toggle('selected', isSelected);
      }
    }
    for (const [i, element] of this.elements) {
      if (shown.has(i)) continue;
      element.remove();
      this.elements.delete(i);
    }
  }

  clear(): void {
    for (const element of this.elements.values()) element.remove();
    this.elements.clear();
  }

  private elementOf(robot: number, name: string): HTMLElement {
    let element = this.elements.get(robot);
    if (!element) {
      element = document.createElement('div');
      element.className = 'label';
      element.textContent = name;
      this.parent.append(element);
      this.elements.set(robot, element);
    }
    return element;
  }
}
