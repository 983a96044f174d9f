// Surfaces: the materials of solid things, and the light on them. A graphics card computes it for each pixel, with
// shadows. Without one it is a part of the colours of the vertices instead: so drawing costs a fraction, and a body that
// turns takes its light along.
import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, HemisphereLight, MeshBasicMaterial,
  MeshLambertMaterial, ShapeUtils, SRGBColorSpace, Vector2, Vector3, type MeshLambertMaterialParameters, type Object3D
} from 'three';
import type {Block, Pose, Shape} from './protocol';

export type SurfaceMaterial = MeshLambertMaterial | MeshBasicMaterial;

const TO_SUN = new Vector3(-0.45, -0.75, 1.3);

export class Surfaces {
  readonly sun = new DirectionalLight(0xffffff, 1.7);
  private readonly sky = new HemisphereLight(0xffffff, 0x8a8f98, 1.9);
  private readonly around = new AmbientLight(0xffffff, 0.25);

  // `shaded`: the graphics compute the light.
  constructor(private readonly shaded: boolean) {}

  // The lights, which have to be added to the scene.
  lights(): Object3D[] {
    return this.shaded ? [this.sky, this.sun, this.sun.target, this.around] : [];
  }

  // The sun shines on a square around a point, `size` m wide.
  aimSun(center: Vector3, size: number): void {
    this.sun.position.copy(center).addScaledVector(TO_SUN, size);
    this.sun.target.position.copy(center);
    this.sun.shadow.mapSize.set(2048, 2048);
    Object.assign(this.sun.shadow.camera, {
      left: -0.8 * size, right: 0.8 * size, top: 0.8 * size, bottom: -0.8 * size, near: 0.1 * size, far: 4 * size,
    });
    this.sun.shadow.normalBias = 0.0006 * size;
    this.sun.shadow.camera.updateProjectionMatrix();
  }

  // The material of geometry from a builder of builder().
  material(parameters: MeshLambertMaterialParameters): SurfaceMaterial {
    return this.shaded ? new MeshLambertMaterial(parameters) : new MeshBasicMaterial(parameters);
  }

  builder(): GeometryBuilder {
    return new GeometryBuilder(this.shaded ? () => 1 : (x, y, z) => this.lightOn(x, y, z));
  }

  // The colour of a plane that faces up, for a material without vertex colours.
  ofPlane(color: Color): Color {
    return this.shaded ? color : color.clone().multiplyScalar(this.lightOn(0, 0, 1));
  }

  // The factor by which the lights above change the colour of a face; its normal in the world. As MeshLambertMaterial:
  // the irradiance over pi.
  private lightOn(x: number, y: number, z: number): number {
    const up = this.sky.position;
    const share = 0.5 * (x * up.x + y * up.y + z * up.z) + 0.5;
    const sky = this.sky.intensity * (this.sky.groundColor.g + share * (1 - this.sky.groundColor.g));
    const sun = this.sun.intensity * Math.max(0, x * TO_SUN.x + y * TO_SUN.y + z * TO_SUN.z) / TO_SUN.length();
    return (sky + sun + this.around.intensity) / Math.PI;
  }
}

// Triangles of the world's shapes, gathered into one geometry.

export type Rgb = [number, number, number];

// Grows without a copy for each triangle.
class Floats {
  private values = new Float32Array(1024);
  length = 0;

  push(a: number, b: number, c: number): void {
    if (this.length + 3 > this.values.length) {
      const grown = new Float32Array(2 * this.values.length);
      grown.set(this.values);
      this.values = grown;
    }
    this.values[this.length++] = a;
    this.values[this.length++] = b;
    this.values[this.length++] = c;
  }
  done(): Float32Array {
    return this.values.slice(0, this.length);
  }
}

export class GeometryBuilder {
  private readonly positions = new Floats();
  private readonly normals = new Floats();
  private readonly colors = new Floats();
  private readonly edges = new Floats();
  private readonly color = new Color();

  // `lightOn`: the factor for the colours of a face, by its normal.
  constructor(private readonly lightOn: (nx: number, ny: number, nz: number) => number) {}

  get empty(): boolean {
    return this.positions.length === 0;
  }

  addShape(shape: Shape, pose: Pose, rgb: Rgb): void {
    this.color.setRGB(...rgb, SRGBColorSpace);
    for (const block of shape.blocks) this.addBlock(block, pose);
    this.addRectangles(shape, pose);
  }

  // A triangle in the plane z, seen from above.
  addFlat(points: Array<[number, number]>, z: number, pose: Pose, rgb: Rgb): void {
    this.color.setRGB(...rgb, SRGBColorSpace);
    const at = transform(pose);
    const [a, b, c] = points.map(([x, y]) => at(x, y));
    this.triangle(a, b, c, pose.z + z, 1);
  }

  build(): BufferGeometry {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(this.positions.done(), 3));
    geometry.setAttribute('normal', new BufferAttribute(this.normals.done(), 3));
    geometry.setAttribute('color', new BufferAttribute(this.colors.done(), 3));
    return geometry;
  }

  // The upper edges of all outlines, as pairs of points.
  buildEdges(): BufferGeometry {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(this.edges.done(), 3));
    return geometry;
  }

  private addBlock(block: Block, pose: Pose): void {
    const at = transform(pose);
    const points: Vector2[] = [];
    for (let i = 0; i < block.outline.length; i += 2) points.push(at(block.outline[i], block.outline[i + 1]));
    const bottom = pose.z + block.bottom;
    const top = pose.z + block.top;
    for (const [a, b, c] of ShapeUtils.triangulateShape(points, [])) {
      this.triangle(points[a], points[b], points[c], top, 1);
      if (bottom > 0.01) this.triangle(points[a], points[c], points[b], bottom, -1);
    }
    this.addSides(points, bottom, top);
  }

  // Their upper sides one by one, and the sides around their union.
  private addRectangles(shape: Shape, pose: Pose): void {
    const at = transform(pose);
    const top = pose.z + shape.top;
    const r = shape.rectangles;
    for (let i = 0; i < r.length; i += 4) {
      const corners = [at(r[i], r[i + 1]), at(r[i + 2], r[i + 1]), at(r[i + 2], r[i + 3]), at(r[i], r[i + 3])];
      this.triangle(corners[0], corners[1], corners[2], top, 1);
      this.triangle(corners[0], corners[2], corners[3], top, 1);
    }
    // The gateway does not say which way round the loops go; all go the same way, holes the other one.
    const loops = shape.loops.map(loop => {
      const points: Vector2[] = [];
      for (let i = 0; i < loop.length; i += 2) points.push(at(loop[i], loop[i + 1]));
      return points;
    });
    const area = loops.reduce((sum, points) => sum + ShapeUtils.area(points), 0);
    for (const points of loops) this.addSides(area < 0 ? points.reverse() : points, pose.z + shape.bottom, top);
  }

  // The inside is to the left of each side.
  private addSides(points: Vector2[], bottom: number, top: number): void {
    points.forEach((a, i) => {
      const b = points[(i + 1) % points.length];
      const length = Math.hypot(b.x - a.x, b.y - a.y);
      if (length === 0) return;
      const nx = (b.y - a.y) / length;
      const ny = (a.x - b.x) / length;
      this.vertex(a.x, a.y, bottom, nx, ny, 0);
      this.vertex(b.x, b.y, bottom, nx, ny, 0);
      this.vertex(b.x, b.y, top, nx, ny, 0);
      this.vertex(a.x, a.y, bottom, nx, ny, 0);
      this.vertex(b.x, b.y, top, nx, ny, 0);
      this.vertex(a.x, a.y, top, nx, ny, 0);
      this.edges.push(a.x, a.y, top);
      this.edges.push(b.x, b.y, top);
    });
  }

  private triangle(a: Vector2, b: Vector2, c: Vector2, z: number, nz: number): void {
    const up = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0;
    const [second, third] = up === nz > 0 ? [b, c] : [c, b];
    this.vertex(a.x, a.y, z, 0, 0, nz);
    this.vertex(second.x, second.y, z, 0, 0, nz);
    this.vertex(third.x, third.y, z, 0, 0, nz);
  }

  private vertex(x: number, y: number, z: number, nx: number, ny: number, nz: number): void {
    this.positions.push(x, y, z);
    this.normals.push(nx, ny, nz);
    const light = this.lightOn(nx, ny, nz);
    this.colors.push(light * this.color.r, light * this.color.g, light * this.color.b);
  }
}

function transform(pose: Pose): (x: number, y: number) => Vector2 {
  const c = Math.cos(pose.heading);
  const s = Math.sin(pose.heading);
  return (x, y) => new Vector2(pose.x + c * x - s * y, pose.y + s * x + c * y);
}

// Pure screen colours are too loud beside each other.
export function softened([r, g, b]: Rgb): Rgb {
  const luma = 0.3 * r + 0.59 * g + 0.11 * b;
  const mix = (value: number): number => 0.9 * (value + (luma - value) * 0.2) + 0.1 * 0.55;
  return [mix(r), mix(g), mix(b)];
}

export function mixed(a: Rgb, b: Rgb, share: number): Rgb {
  return [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share, a[2] + (b[2] - a[2]) * share];
}
