// Surfaces: the materials of solid things, and the light on them. A graphics card computes it for each pixel, with
// shadows. Without one it is a part of the colours of the vertices instead: so drawing costs a fraction, and a body that
// turns takes its light along.
import {
  AmbientLight, Color, DirectionalLight, HemisphereLight, MeshBasicMaterial, MeshLambertMaterial, Vector3,
  type MeshLambertMaterialParameters, type Object3D,
} from 'three';
import {GeometryBuilder} from './geometry';

export type SurfaceMaterial = MeshLambertMaterial | MeshBasicMaterial;

const TO_SUN = new Vector3(-0.45, -0.75, 1.3);

export class Surfaces {
  readonly sun = new DirectionalLight(0xffffff, 1.7);
  private readonly sky = new HemisphereLight(0xffffff, 0x8a8f98, 1.9);
  private readonly around = new AmbientLight(0xffffff, 0.25);

  // `shaded`: the graphics compute the light.
  constructor(private readonly shaded: boolean) {}

  // To be added to the scene.
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

  // Of geometry from a builder of builder().
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
