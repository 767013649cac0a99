// The views of the stage: where the camera looks from, and how the picture is projected.
import * as THREE from "three";

const fieldOfView = THREE.MathUtils.degToRad(32); // of a picture that is at least as wide as high
const farAway = 200; // an orthographic view has a camera this many times as far away, with a smaller field of view
const framing = 2.9; // distance of the camera, in multiples of the body's size

/** The directions from which the views look at the robot. All but the first are orthographic. */
export const views = {
  perspective: { label: "in perspective", from: [0.55, -1, 0.42] },
  side: { label: "from the side", from: [0, -1, 0] },
  front: { label: "from the front", from: [1, 0, 0] },
  top: { label: "from above", from: [0, -1e-4, 1] },
};

/** Places a camera so that it sees a body of a size at the origin. */
export const place = (camera, view, size) =>
  camera.position.set(...views[view].from).normalize().multiplyScalar(framing * size);

/** Returns the field of view of a picture: a narrow picture shows as much of the body as a wide one. */
function widened(aspect) {
  const half = Math.tan(fieldOfView / 2);
  return 2 * Math.atan(aspect < 1 ? half / aspect : half);
}

/** Returns the camera that draws a stage in a picture with an aspect ratio, as `control`, the camera that the user turns
 *  about `target`, asks for. */
export function cameraFor(stage, aspect, view, control, target) {
  const camera = new THREE.PerspectiveCamera();
  camera.quaternion.copy(control.quaternion);
  camera.aspect = aspect;
  const times = view === "perspective" ? 1 : farAway;
  camera.fov = THREE.MathUtils.radToDeg(2 * Math.atan(Math.tan(widened(aspect) / 2) / times));
  const offset = control.position.clone().sub(target);
  const distance = times * offset.length();
  camera.near = Math.max(0.01 * stage.size, distance - 60 * stage.size);
  camera.far = distance + 60 * stage.size;
  camera.position.copy(target).addScaledVector(offset, times).add(stage.target);
  camera.position.z += 0.05 * stage.size; // makes room for the caption above the body
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
  return camera;
}

/** Returns the pixels of a metre, at the distance of the robot, in a picture of a width and a height. */
export const pixelsOfMetre = (width, height, control, target) =>
  height / (2 * control.position.distanceTo(target) * Math.tan(widened(width / height) / 2));
