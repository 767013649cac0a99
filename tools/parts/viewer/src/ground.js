// Rough ground, given by heights on a square grid.
import * as THREE from "three";
import { sums } from "./unpack.js";

const level = 127; // the stored value of height 0; values are 0 … 254

export class Ground {
  /** Unpacks a scene's ground. Returns undefined if it is level. */
  static async of({ ground }) {
    if (!ground) return undefined;
    return Object.assign(new Ground(), ground, { levels: Uint8Array.from(await sums(ground.heights)) });
  }

  /** Returns the ground as triangles. */
  geometry() {
    const { columns, rows, spacing, levels } = this;
    const positions = new Float32Array(3 * columns * rows);
    for (let i = 0; i < columns * rows; ++i) {
      positions[3 * i] = this.x + (i % columns) * spacing;
      positions[3 * i + 1] = this.y + Math.floor(i / columns) * spacing;
      positions[3 * i + 2] = this.roughness * (levels[i] / level - 1);
    }
    const triangles = new Uint32Array(6 * (columns - 1) * (rows - 1));
    for (let row = 0, at = 0; row < rows - 1; ++row)
      for (let column = 0; column < columns - 1; ++column, at += 6) {
        const i = row * columns + column;
        triangles.set([i, i + 1, i + columns + 1, i, i + columns + 1, i + columns], at);
      }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
    geometry.computeVertexNormals();
    return geometry;
  }

  /** Returns the height at a point, m. Points beyond the edge have the height of the edge. */
  heightAt(x, y) {
    const { columns, rows, spacing, levels } = this;
    const [u, v] = [
      [(x - this.x) / spacing, columns],
      [(y - this.y) / spacing, rows],
    ].map(([at, count]) => Math.min(count - 1, Math.max(0, at)));
    const [i, j] = [Math.min(columns - 2, Math.floor(u)), Math.min(rows - 2, Math.floor(v))];
    const row = (k) => levels[k * columns + i] + (u - i) * (levels[k * columns + i + 1] - levels[k * columns + i]);
    return this.roughness * ((row(j) + (v - j) * (row(j + 1) - row(j))) / level - 1);
  }
}

const levelGround = { levels: Uint8Array.of(level), columns: 1, rows: 1, x: 0, y: 0, spacing: 1, roughness: 0 };

/** The uniforms that heightOf() reads. */
export function heightUniforms(ground = levelGround) {
  const heights = new THREE.DataTexture(ground.levels, ground.columns, ground.rows, THREE.RedFormat);
  heights.minFilter = heights.magFilter = THREE.LinearFilter;
  heights.needsUpdate = true;
  return {
    heights: { value: heights },
    heightsAt: { value: new THREE.Vector4(ground.x, ground.y, ground.spacing, ground.roughness) },
  };
}

/** GLSL: the height of the ground at a point, m. Points beyond the edge have the height of the edge. */
export const heightOf = /* glsl */ `
uniform sampler2D heights;
uniform vec4 heightsAt; // x and y of the first, spacing, roughness
float heightOf(vec2 at) {
  vec2 sampled = (at - heightsAt.xy) / heightsAt.z + 0.5;
  return heightsAt.w * (texture(heights, sampled / vec2(textureSize(heights, 0))).r * (255.0 / ${level}.0) - 1.0);
}`;
