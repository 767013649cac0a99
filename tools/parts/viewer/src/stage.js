// One robot in its scene, drawn by three.js. Each spring and each mass is a flat square of two triangles, which faces
// the camera and is shaded as a cylinder or a ball. The shaders read the positions of masses from a texture, so that
// for each frame the program only has to write these positions. Instancing is not used, since without a GPU each
// instance costs as much as a separate draw call.
import * as THREE from "three";
import { materialColour, springColours } from "./colours.js";
import { style } from "./elements.js";
import { heightUniforms } from "./ground.js";
import { skinOf } from "./skin.js";
import { Track } from "./track.js";
import {
  floorFragment,
  floorVertex,
  massFragment,
  massVertex,
  moteFragment,
  moteVertex,
  shadowFragment,
  shadowVertex,
  skinFragment,
  skinShadowVertex,
  skinVertex,
  skyFragment,
  skyVertex,
  springFragment,
  springVertex,
  textureWidth,
} from "./shaders.js";

const effectTime = 0.7; // s during which removed springs fade and new ones stop glowing

const material = (vertexShader, fragmentShader, uniforms, options = {}) =>
  new THREE.ShaderMaterial({ glslVersion: THREE.GLSL3, vertexShader, fragmentShader, uniforms, ...options });

/** Fills a geometry with squares that extend from -1 to 1 in x and from `low` to 1 in y. `attributes` maps each name to
 *  the number of components of a value and the values, one for each square. */
function setSquares(geometry, low, count, attributes) {
  geometry.dispose();
  const set = (name, size, values) => geometry.setAttribute(name, new THREE.BufferAttribute(values, size));
  const corners = [-1, low, 0, 1, low, 0, 1, 1, 0, -1, 1, 0];
  const positions = new Float32Array(12 * count);
  for (let i = 0; i < positions.length; ++i) positions[i] = corners[i % 12];
  set("position", 3, positions);
  for (const [name, [size, values]] of Object.entries(attributes)) set(name, size, atCorners(values, size, count));
  const triangles = new Uint32Array(6 * count);
  for (let i = 0, at = 0; i < 4 * count; i += 4) {
    triangles[at++] = i;
    triangles[at++] = i + 1;
    triangles[at++] = i + 2;
    triangles[at++] = i;
    triangles[at++] = i + 2;
    triangles[at++] = i + 3;
  }
  geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
}

/** Repeats each square's value for its four corners. */
function atCorners(values, size, count) {
  const all = new Float32Array(4 * size * count);
  for (let i = 0, at = 0; i < size * count; i += size)
    for (let corner = 0; corner < 4; ++corner) for (let k = 0; k < size; ++k) all[at++] = values[i + k];
  return all;
}

const colour = (name) => new THREE.Color().setStyle(style(name), THREE.LinearSRGBColorSpace);

export class Stage {
  /** Shows a robot in its scene, which may have a level or rough floor, or water. On a slope, gravity is tilted; the
   *  whole scene is rotated so that gravity points down. */
  constructor(life, { scene, material_names }, ground) {
    this.life = life;
    this.materialNames = material_names;
    this.scene = new THREE.Scene();
    this.scene.rotation.y = THREE.MathUtils.degToRad(scene.slope);
    this.mode = "material";
    const { size, middle } = life.boxIn(0);
    this.size = size;
    this.start = middle;
    this.focus = new THREE.Vector3(); // the point that the camera looks at, in the ground's frame
    this.target = new THREE.Vector3(); // the same point after rotation by the slope
    const rows = Math.max(1, Math.ceil(life.massCount / textureWidth));
    this.positions = new THREE.DataTexture(
      new Float32Array(4 * textureWidth * rows),
      textureWidth,
      rows,
      THREE.RGBAFormat,
      THREE.FloatType,
    );
    this.#makeUniforms(ground);
    this.#addSky();
    if (scene.floor) this.#addFloor(ground);
    this.isInWater = scene.water;
    if (this.isInWater) this.#addMotes();
    this.touch = scene.floor ? life.touch : -Infinity;
    this.#addBody();
    if (scene.floor) this.#addShadow(ground);
    if (life.way) this.#addTrack(scene, ground);
    this.readTheme();
  }

  #makeUniforms(ground) {
    const springs = Math.max(1, ...this.life.shots.map((shot) => shot.springs.length));
    const radius = this.size * Math.min(0.0075, 0.09 / Math.sqrt(springs));
    this.thin = radius;
    this.shared = {
      positions: { value: this.positions },
      radius: { value: radius },
      pixel: { value: 0 },
      glow: { value: 0 },
      freshColour: { value: new THREE.Color() },
      haze: { value: new THREE.Color() },
      hazeRange: { value: new THREE.Vector2() },
    };
    this.world = {
      line: { value: new THREE.Color() },
      earth: { value: new THREE.Color() },
      focus: { value: this.focus },
      reach: { value: (ground ? 3 : 6) * this.size }, // the data of rough ground reaches no further
    };
    this.massRadius = { value: 0 };
    this.heights = heightUniforms(ground);
    this.shadow = { value: new THREE.Vector4() };
  }

  #add(geometry, made, order) {
    const mesh = new THREE.Mesh(geometry, made);
    mesh.frustumCulled = false;
    mesh.renderOrder = order;
    this.scene.add(mesh);
    return mesh;
  }

  #addBody() {
    const springs = (uniforms, options) =>
      material(
        springVertex,
        springFragment,
        { ...this.shared, opacity: { value: 1 }, ...uniforms },
        { side: THREE.DoubleSide, ...options },
      );
    this.springs = new THREE.BufferGeometry();
    this.#add(this.springs, springs({}, {}), 2);
    this.gone = new THREE.BufferGeometry();
    this.goneMaterial = springs(
      { radius: { value: 2.2 * this.shared.radius.value } },
      { transparent: true, depthWrite: false },
    );
    this.#add(this.gone, this.goneMaterial, 4);
    this.masses = new THREE.BufferGeometry();
    this.touchColour = { value: new THREE.Color() };
    const uniforms = {
      ...this.shared,
      ...this.heights,
      radius: this.massRadius,
      touch: { value: Math.max(this.touch, -1e10) },
      touchColour: this.touchColour,
    };
    this.#add(this.masses, material(massVertex, massFragment, uniforms), 3);
    this.skin = new THREE.BufferGeometry();
    this.#add(this.skin, material(skinVertex, skinFragment, { ...this.shared }, { side: THREE.DoubleSide }), 2);
  }

  #addShadow(ground) {
    const shown = {
      transparent: true,
      depthWrite: false,
      depthTest: !ground, // with the test, straight shadows would be hidden inside hills
      side: THREE.DoubleSide,
      stencilWrite: true,
      stencilRef: 0,
      stencilFunc: THREE.EqualStencilFunc,
      stencilZPass: THREE.IncrementStencilOp,
    };
    const uniforms = { ...this.shared, ...this.heights, shadow: this.shadow };
    this.#add(this.springs, material(shadowVertex, shadowFragment, uniforms, shown), 1);
    this.#add(this.skin, material(skinShadowVertex, shadowFragment, uniforms, shown), 1);
  }

  #addTrack(scene, ground) {
    const level = scene.floor ? () => 0 : undefined;
    this.track = new Track(this.life, ground ? (x, y) => ground.heightAt(x, y) : level);
    this.scene.add(this.track.root);
  }

  #addSky() {
    this.sky = { near: { value: new THREE.Color() }, far: { value: new THREE.Color() } };
    this.#add(
      new THREE.PlaneGeometry(2, 2),
      material(skyVertex, skyFragment, this.sky, { depthWrite: false, depthTest: false }),
      -1,
    );
  }

  #addFloor(ground) {
    const side = 4 * this.world.reach.value;
    this.floor = this.#add(
      ground ? ground.geometry() : new THREE.PlaneGeometry(side, side),
      material(
        floorVertex,
        floorFragment,
        {
          ...this.world,
          relief: { value: ground ? 1 : 0 },
          centre: ground ? { value: new THREE.Vector3() } : this.world.focus,
        },
        { transparent: true, depthWrite: Boolean(ground) },
      ),
      0,
    );
  }

  #addMotes() {
    const geometry = new THREE.BufferGeometry();
    let seed = 1; // a random generator with a fixed seed: every page shows the same water
    const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(Array.from({ length: 3 * 2500 }, random), 3));
    const motes = new THREE.Points(
      geometry,
      material(
        moteVertex,
        moteFragment,
        { ...this.world, pixel: this.shared.pixel },
        { transparent: true, depthWrite: false },
      ),
    );
    motes.frustumCulled = false;
    this.scene.add(motes);
  }

  readTheme() {
    this.shared.haze.value.copy(colour(this.isInWater ? "--water" : "--stage"));
    this.sky.near.value.copy(colour(this.isInWater ? "--water" : "--stage"));
    this.sky.far.value.copy(colour(this.isInWater ? "--water-low" : "--stage-low"));
    this.shared.freshColour.value.copy(colour("--fresh"));
    this.touchColour.value.copy(colour("--touch"));
    this.world.line.value.copy(colour("--grid"));
    this.world.earth.value.copy(colour("--earth"));
    const dark = colour("--shadow");
    this.shadow.value.set(dark.r, dark.g, dark.b, Number(style("--shadow-strength")));
    this.track?.readTheme();
    this.#shown = undefined;
  }

  /** Draws springs as thick as muscles rather than as wires, or thin again. */
  setThick(thick) {
    this.shared.radius.value = thick ? Math.max(3 * this.thin, 0.016 * this.size) : this.thin;
    this.#shown = undefined; // the radius of masses depends on it
  }

  /** Covers voxels with their outer faces, in place of their springs, or uncovers them again. */
  setSkin(isOn) {
    this.hasSkin = isOn && this.life.voxels.length > 0;
    this.#shown = undefined;
  }

  /** Returns, for each spring of the life, whether it is hidden in a shot because faces cover its voxels. */
  #covered(shot) {
    return this.hasSkin ? skinOf(this.life, shot, () => [0, 0, 0]).covered : [];
  }

  /** The materials that the springs seen at any time have, and those inside voxels, which give faces their colours. */
  get materialsSeen() {
    const inside = new Set(this.hasSkin ? this.life.voxels.flatMap((voxel) => voxel.inside) : []);
    return this.life.shots.flatMap((shot) => {
      const covered = this.#covered(shot);
      return [...shot.materials].filter((_, i) => !covered[shot.springs[i]] || inside.has(shot.springs[i]));
    });
  }

  setMode(mode) {
    this.mode = mode;
    this.#shown = undefined;
  }

  #shown; // the shot whose springs are in the buffers

  /** The shot that is drawn. */
  get shown() {
    return this.#shown ?? 0;
  }

  #fill(index) {
    const { life } = this;
    const shot = life.shots[index];
    const colourOf = springColours(life, this.mode, this.scale);
    const skin = this.hasSkin ? skinOf(life, shot, colourOf) : { corners: [], colours: [], covered: [] };
    setSquares(this.skin, -1, skin.corners.length / 4, { corners: [4, skin.corners], colour: [3, skin.colours] });
    const there = shot.springs.map((_, i) => i).filter((i) => !skin.covered[shot.springs[i]]);
    setSquares(this.springs, 0, there.length, {
      ...this.#squares(shot, there, colourOf),
      fresh: [1, Array.from(there, (i) => shot.isNew[i])],
    });
    setSquares(this.gone, 0, shot.gone.length, {
      ...this.#squares(life.shots[index - 1], shot.gone, colourOf),
      fresh: [1, new Uint8Array(shot.gone.length)],
    });
    setSquares(this.masses, -1, shot.masses.length, {
      mass: [1, shot.masses],
      colour: [3, this.#massColours(shot)],
    });
    // without springs, masses are drawn larger so that they are visible
    const alone = shot.springs.length > 0 ? 0 : (0.09 * this.size) / Math.cbrt(shot.masses.length);
    this.massRadius.value = Math.max(1.7 * this.shared.radius.value, alone);
    this.#shown = index;
  }

  /** Returns the attributes of the squares of the springs in `list`. */
  #squares(shot, list, colourOf) {
    const ends = new Float32Array(2 * list.length);
    const colour = new Float32Array(3 * list.length);
    for (let k = 0; k < list.length; ++k) {
      const spring = shot.springs[list[k]];
      ends[2 * k] = this.life.ends[2 * spring];
      ends[2 * k + 1] = this.life.ends[2 * spring + 1];
      const its = colourOf(shot, list[k]);
      for (let i = 0; i < 3; ++i) colour[3 * k + i] = its[i];
    }
    return { ends: [2, ends], colour: [3, colour] };
  }

  /** Returns the colours of masses. In a body without springs, masses have the colours of their materials. */
  #massColours(shot) {
    const { materials } = this.life.robot.film;
    const plain = colour("--mass").toArray();
    const colours = shot.springs.length === 0 ? materials.map((made) => materialColour(made, materials)) : [];
    return Array.from(shot.masses).flatMap((mass) => colours[this.life.massMaterials[mass]] ?? plain);
  }

  /** Sets how strongly new springs glow and removed ones are visible, by the time since the shot began. */
  #light(shot, time) {
    const left =
      1 - Math.min(1, (time - shot.begin) / Math.min(effectTime, 0.7 * (shot.end - shot.begin) || effectTime));
    this.goneMaterial.uniforms.opacity.value = 0.75 * left;
    this.shared.glow.value = left;
  }

  /** Shows the robot at a time [s]. With `follow`, the camera's focus moves with it. */
  seek(time, follow) {
    const { life } = this;
    if (life.shots.length === 0) return;
    const index = life.shotAt(time);
    if (index !== this.#shown) this.#fill(index);
    life.writePositions(time, this.positions.image.data);
    this.positions.needsUpdate = true;
    this.track?.seek(time);
    this.#light(life.shots[index], time);
    this.lookAt(follow ? life.middleAt(time, life.smoothPath) : this.start);
  }

  lookAt([x, y, z]) {
    this.focus.set(x, y, z);
    this.target.copy(this.focus).applyEuler(this.scene.rotation);
  }

  /** Draws the camera's view into a picture that is `height` pixels high. */
  draw(renderer, camera, height) {
    const distance = camera.position.distanceTo(this.target);
    this.shared.hazeRange.value.set(distance - 0.5 * this.size, distance + 1.1 * this.size);
    this.shared.pixel.value = (2 * Math.tan((camera.fov * Math.PI) / 360)) / height;
    renderer.render(this.scene, camera);
  }

  dispose() {
    this.scene.traverse((object) => (object.geometry?.dispose(), object.material?.dispose()));
    this.positions.dispose();
    this.heights.heights.value.dispose();
  }
}
