// Points, lines or triangles of the scene that are filled anew for each picture.
import {
  BufferAttribute, BufferGeometry, DynamicDrawUsage, LineSegments, Mesh, Points, type LineBasicMaterial, type Material,
  type MeshBasicMaterial, type Object3D, type PointsMaterial,
} from 'three';

// Its buffer grows when it has to. Without points it is neither sent nor drawn.
export class Stream {
  readonly object: Object3D;
  private readonly geometry = new BufferGeometry();
  private values = new Float32Array(3000);
  private length = 0;

  private constructor(make: (geometry: BufferGeometry) => Object3D) {
    this.attach();
    this.object = make(this.geometry);
    this.object.frustumCulled = false;
    this.object.renderOrder = 1;
    this.object.visible = false;
  }

  static triangles(material: MeshBasicMaterial): Stream {
    return new Stream(geometry => new Mesh<BufferGeometry, Material>(geometry, material));
  }
  static lines(material: LineBasicMaterial): Stream {
    return new Stream(geometry => new LineSegments(geometry, material));
  }
  static points(material: PointsMaterial): Stream {
    return new Stream(geometry => new Points(geometry, material));
  }

  begin(): void {
    this.length = 0;
  }
  push(x: number, y: number, z: number): void {
    if (this.length + 3 > this.values.length) {
      const grown = new Float32Array(2 * this.values.length);
      grown.set(this.values);
      this.values = grown;
      this.attach();
    }
    this.values[this.length++] = x;
    this.values[this.length++] = y;
    this.values[this.length++] = z;
  }
  end(): void {
    this.object.visible = this.length > 0;
    if (!this.object.visible) return;
    this.geometry.setDrawRange(0, this.length / 3);
    const positions = this.geometry.getAttribute('position') as BufferAttribute;
    positions.clearUpdateRanges();
    positions.addUpdateRange(0, this.length);
    positions.needsUpdate = true;
  }

  private attach(): void {
    this.geometry.dispose();
    this.geometry.setAttribute('position', new BufferAttribute(this.values, 3).setUsage(DynamicDrawUsage));
  }
}
