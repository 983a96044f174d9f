// PlanUnderlay: the picture of a floor plan on the ground of the world, in its scale, for walls that are traced over it
// with the tools that draw. It is in no file, and gone with the page.
import {DataTexture, DoubleSide, Mesh, MeshBasicMaterial, PlaneGeometry, RGBAFormat, SRGBColorSpace} from 'three';
import type {WorldScene} from './scene';

const ABOVE_GROUND = 0.002;  // m
const OPACITY = 0.6;

export class PlanUnderlay {
  private readonly texture: DataTexture;
  private readonly material: MeshBasicMaterial;
  private readonly plane: Mesh;

  // `grey`: of the picture, row by row from the top. `pixel`: m. The middle of the picture is at the origin.
  constructor(private readonly scene: WorldScene, width: number, height: number, grey: Uint8Array, pixel: number) {
    const pixels = new Uint8Array(4 * width * height);
    for (let y = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x) {
        const at = 4 * ((height - 1 - y) * width + x);  // textures begin at the bottom
        pixels.fill(grey[y * width + x], at, at + 3);
        pixels[at + 3] = 255;
      }
    }
    this.texture = new DataTexture(pixels, width, height, RGBAFormat);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.needsUpdate = true;
    this.material = new MeshBasicMaterial({map: this.texture, side: DoubleSide, transparent: true, opacity: OPACITY, depthWrite: false});
    this.plane = new Mesh(new PlaneGeometry(width * pixel, height * pixel), this.material);
    this.plane.position.z = ABOVE_GROUND;
    scene.add(this.plane);
    scene.invalidate();
  }

  dispose(): void {
    this.plane.removeFromParent();
    this.plane.geometry.dispose();
    this.material.dispose();
    this.texture.dispose();
    this.scene.invalidate();
  }
}
