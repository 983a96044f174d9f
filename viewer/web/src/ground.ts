// The ground: a plane with a grid whose lines are a round number of metres apart.
import {
  BufferAttribute, BufferGeometry, Color, Group, LineBasicMaterial, LineSegments, Mesh, PlaneGeometry,
  type Box3,
} from 'three';
import type {SurfaceMaterial, Surfaces} from './surfaces';

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
