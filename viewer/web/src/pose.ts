// Poses as in troupe/pose.h: compose(X_AB, X_BC) is X_AC.
import type {Matrix4} from 'three';
import type {Joint, Pose} from './protocol';

export const IDENTITY: Pose = {x: 0, y: 0, z: 0, heading: 0};

export function compose(a: Pose, b: Pose): Pose {
  const c = Math.cos(a.heading);
  const s = Math.sin(a.heading);
  return {
    x: a.x + c * b.x - s * b.y,
    y: a.y + s * b.x + c * b.y,
    z: a.z + b.z,
    heading: a.heading + b.heading,
  };
}

// The motion of the joint's model at a position, in the model's frame.
export function jointMotion(joint: Joint, position: number): Pose {
  if (joint.revolute) return {...IDENTITY, heading: position};
  const [x, y, z] = joint.axis;
  return {x: position * x, y: position * y, z: position * z, heading: 0};
}

export function toMatrix(pose: Pose, matrix: Matrix4): Matrix4 {
  const c = Math.cos(pose.heading);
  const s = Math.sin(pose.heading);
  return matrix.set(c, -s, 0, pose.x, s, c, 0, pose.y, 0, 0, 1, pose.z, 0, 0, 0, 1);
}

export function degrees(radians: number): number {
  return (radians * 180) / Math.PI;
}
