// The static map: everything that never moves, merged into one mesh, with lines along its upper edges. Lights are
// meshes of their own, because they may be dark.
//
// One mesh per opacity, whatever the number of models: a floor plan of ten thousand rectangles is one call. Dense
// bitmaps are a texture in the plane of their upper side, because their outlines would be millions of triangles.
import {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, NearestFilter, PlaneGeometry, SRGBColorSpace, type Box3
} from 'three';
import {DARK} from './bodies';
import type {Area, Light, Pose, World} from './protocol';
import {compose, toMatrix, type Run} from './run';
import {mixed, softened, type GeometryBuilder, type Rgb, type SurfaceMaterial, type Surfaces} from './surfaces';

const SLATE: Rgb = [0.36, 0.41, 0.48];

// Geometry that is drawn with one opacity.
interface Layer {
  builder: GeometryBuilder;
  opacity: number;
}

export class StaticMap {
  readonly group = new Group();
  private readonly disposables: Array<{dispose(): void}> = [];
  private readonly lights: Array<{light: Light; material: SurfaceMaterial}> = [];
  private readonly edges = new LineBasicMaterial({transparent: true, opacity: 0.35});

  // `moves`: of the index of a model.
  constructor(world: World, private readonly surfaces: Surfaces, moves: (model: number) => boolean) {
    const poses: Pose[] = [];
    const layers = new Map<number, Layer>();
    const lightOfModel = new Map(world.lights.map(light => [light.model, light]));
    world.models.forEach((model, i) => {
      poses.push(model.parent < 0 ? model.poseInParent : compose(poses[model.parent], model.poseInParent));
      if (model.removed || moves(i)) return;
      const shape = world.shapes[model.shape];
      const isMap = shape.rectangles.length > 0 || shape.area !== null;
      const rgb = model.color.slice(0, 3) as Rgb;
      const light = lightOfModel.get(i);
      if (light) {
        const builder = surfaces.builder();
        builder.addShape(shape, poses[i], softened(rgb));
        this.addLight(light, builder);
        return;
      }
      const color = isMap ? mixed(rgb, SLATE, 0.8) : softened(rgb);
      const opacity = Math.round(Math.min(1, Math.max(0.15, model.color[3])) * 10) / 10;
      if (!layers.has(opacity)) layers.set(opacity, {builder: surfaces.builder(), opacity});
      layers.get(opacity)!.builder.addShape(shape, poses[i], color);
      if (shape.area) this.addArea(shape.area, compose(poses[i], shape.area.pose), shape.top, color);
    });
    for (const layer of layers.values()) this.addLayer(layer);
    this.disposables.push(this.edges);
  }

  // Dark lights are dark.
  show(run: Run): void {
    for (const {light, material} of this.lights) {
      if (run.isLit(light)) material.color.setRGB(1, 1, 1);
      else material.color.copy(DARK);
    }
  }

  setEdgeColor(color: Color): void {
    this.edges.color = color;
  }

  dispose(): void {
    for (const disposable of this.disposables) disposable.dispose();
  }

  private addLayer({builder, opacity}: Layer): void {
    if (builder.empty) return;
    const material = this.surfaces.material({vertexColors: true, transparent: opacity < 1, opacity});
    this.disposables.push(material);
    const mesh = new Mesh(this.kept(builder.build()), material);
    mesh.castShadow = opacity === 1;
    mesh.receiveShadow = true;
    this.group.add(mesh, new LineSegments(this.kept(builder.buildEdges()), this.edges));
  }

  private addLight(light: Light, builder: GeometryBuilder): void {
    if (builder.empty) return;
    const material = this.surfaces.material({vertexColors: true});
    const mesh = new Mesh(this.kept(builder.build()), material);
    mesh.castShadow = mesh.receiveShadow = true;
    this.group.add(mesh, new LineSegments(this.kept(builder.buildEdges()), this.edges));
    this.disposables.push(material);
    this.lights.push({light, material});
  }

  // A dense bitmap is a picture in the plane of its upper side.
  private addArea(area: Area, pose: Pose, top: number, rgb: Rgb): void {
    const pixels = new Uint8Array(4 * area.width * area.height);
    const color = rgb.map(value => Math.round(255 * value));
    for (let i = 0; i < area.width * area.height; ++i) {
      const occupied = (area.bits[i >> 3] >> (i & 7)) & 1;
      pixels.set([color[0], color[1], color[2], occupied ? 255 : 0], 4 * i);
    }
    const texture = new DataTexture(pixels, area.width, area.height);
    texture.colorSpace = SRGBColorSpace;
    texture.magFilter = NearestFilter;
    texture.needsUpdate = true;
    const [minX, minY, maxX, maxY] = area.box;
    const material = new MeshBasicMaterial({map: texture, alphaTest: 0.5, side: DoubleSide});
    const plane = new Mesh(this.kept(new PlaneGeometry(maxX - minX, maxY - minY)), material);
    plane.matrixAutoUpdate = false;
    const center = compose(pose, {x: (minX + maxX) / 2, y: (minY + maxY) / 2, z: top, heading: 0});
    toMatrix(center, plane.matrix);
    this.disposables.push(texture, material);
    this.group.add(plane);
  }

  private kept(geometry: BufferGeometry): BufferGeometry {
    this.disposables.push(geometry);
    return geometry;
  }
}

// The ground: a plane with a grid whose lines are a round number of metres apart.

const MOST_LINES = 80;  // along each side

export class Ground {
  readonly group = new Group();
  readonly step: number;  // m between thin lines
  private readonly plane: Mesh<PlaneGeometry, SurfaceMaterial>;
  private readonly thin: LineSegments<BufferGeometry, LineBasicMaterial>;
  private readonly thick: LineSegments<BufferGeometry, LineBasicMaterial>;

  constructor(box: Box3, private readonly surfaces: Surfaces) {
    const width = box.max.x - box.min.x;
    const depth = box.max.y - box.min.y;
    const margin = 0.08 * Math.max(width, depth) + 1;
    this.step = [0.5, 1, 2, 5, 10, 20, 50, 100, 1000].find(s => (Math.max(width, depth) + 2 * margin) / s < MOST_LINES) ?? 10000;
    const snap = 5 * this.step;
    const left = Math.floor((box.min.x - margin) / snap) * snap;
    const right = Math.ceil((box.max.x + margin) / snap) * snap;
    const near = Math.floor((box.min.y - margin) / snap) * snap;
    const far = Math.ceil((box.max.y + margin) / snap) * snap;
    this.plane = new Mesh(
      new PlaneGeometry(right - left, far - near),
      surfaces.material({polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2}));
    this.plane.position.set((left + right) / 2, (near + far) / 2, 0);
    this.plane.receiveShadow = true;
    const lines = (isThick: boolean): Float32Array => {
      const points: number[] = [];
      const add = (from: number, to: number, line: (at: number) => number[]): void => {
        for (let i = Math.round(from / this.step); i <= Math.round(to / this.step); ++i) {
          if ((i % 5 === 0) === isThick) points.push(...line(i * this.step));
        }
      };
      add(left, right, x => [x, near, 0, x, far, 0]);
      add(near, far, y => [left, y, 0, right, y, 0]);
      return new Float32Array(points);
    };
    const make = (isThick: boolean): LineSegments<BufferGeometry, LineBasicMaterial> => {
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(lines(isThick), 3));
      return new LineSegments(geometry, new LineBasicMaterial({transparent: true}));
    };
    this.thin = make(false);
    this.thick = make(true);
    this.group.add(this.plane, this.thin, this.thick);
  }

  setColors(plane: Color, line: Color): void {
    this.plane.material.color = this.surfaces.ofPlane(plane);
    this.thin.material.color = line;
    this.thin.material.opacity = 0.35;
    this.thick.material.color = line;
    this.thick.material.opacity = 0.8;
  }

  dispose(): void {
    for (const part of [this.plane, this.thin, this.thick]) {
      part.geometry.dispose();
      part.material.dispose();
    }
  }
}
