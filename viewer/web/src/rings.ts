// Rings: marks around entities on the ground, equally wide on the screen for all sizes and distances.
import {Color, Group, Mesh, MeshBasicMaterial, RingGeometry, type Vector3} from 'three';
import type {Pose} from './protocol';

const PARTS = 48;

export interface Ringed {
  pose: Pose;
  radius: number;  // m
}

export class Rings {
  readonly group = new Group();
  private readonly material = new MeshBasicMaterial({transparent: true, opacity: 0.9, depthWrite: false});
  private readonly rings: Array<{mesh: Mesh<RingGeometry, MeshBasicMaterial>; radius: number}> = [];

  // `width`: px.
  constructor(private readonly width: number) {}

  setColor(color: Color): void {
    this.material.color = color;
  }

  show(ringed: Ringed[]): void {
    while (this.rings.length < ringed.length) {
      const mesh = new Mesh(new RingGeometry(1, 1.1, PARTS), this.material);
      mesh.renderOrder = 2;
      this.rings.push({mesh, radius: 1});
      this.group.add(mesh);
    }
    this.rings.forEach((ring, i) => {
      ring.mesh.visible = i < ringed.length;
      if (i >= ringed.length) return;
      const {pose, radius} = ringed[i];
      ring.mesh.position.set(pose.x, pose.y, pose.z + 0.01);
      ring.radius = 1.12 * radius;
    });
  }

  // `pixelAt`: the length of a pixel at a point, m.
  fit(pixelAt: (point: Vector3) => number): void {
    const same = (a: number, b: number): boolean => Math.abs(a - b) < 0.05 * b;
    for (const {mesh, radius} of this.rings) {
      if (!mesh.visible) continue;
      const width = this.width * pixelAt(mesh.position);
      const {innerRadius, outerRadius} = mesh.geometry.parameters;
      if (same(innerRadius, radius) && same(outerRadius - innerRadius, width)) continue;
      mesh.geometry.dispose();
      mesh.geometry = new RingGeometry(radius, radius + width, PARTS);
    }
  }
}
