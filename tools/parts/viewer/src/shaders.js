// The GPU's shaders for springs and masses that face the camera, shadows, the sky, the floor and particles in water.
import { heightOf } from "./ground.js";

/** Number of masses in a row of the texture that holds positions. */
export const textureWidth = 256;

const placeOf = /* glsl */ `
uniform sampler2D positions;
vec3 placeOf(float mass) {
  int i = int(mass);
  return texelFetch(positions, ivec2(i % ${textureWidth}, i / ${textureWidth}), 0).xyz;
}`;

const shade = /* glsl */ `
uniform vec3 haze;
uniform vec2 hazeRange;
vec3 shade(vec3 colour, vec3 normal, float depth) {
  float light = 0.58 + 0.42 * max(0.0, dot(normal, normalize(vec3(-0.35, 0.75, 0.55))));
  return mix(colour * light, haze, 0.55 * smoothstep(hazeRange.x, hazeRange.y, depth));
}`;

export const springVertex = /* glsl */ `
in vec2 ends;
in vec3 colour;
in float fresh;
uniform float radius;
uniform float pixel; // size of a pixel at distance 1
uniform float glow; // brightness of new springs, 0 to 1
uniform vec3 freshColour;
out vec3 vColour;
out vec3 vSide;
out vec3 vFront;
out float vAcross;
out float vDepth;
${placeOf}
void main() {
  vec4 a = modelViewMatrix * vec4(placeOf(ends.x), 1.0);
  vec4 b = modelViewMatrix * vec4(placeOf(ends.y), 1.0);
  vec3 along = b.xyz - a.xyz;
  vec3 at = mix(a.xyz, b.xyz, position.y);
  vSide = normalize(cross(along, -at) + vec3(1e-9, 0.0, 0.0));
  vFront = normalize(cross(vSide, along) + vec3(0.0, 0.0, 1e-9));
  if (dot(vFront, -at) < 0.0) vFront = -vFront;
  vAcross = position.x;
  vColour = mix(colour, freshColour, glow * fresh);
  vDepth = -at.z;
  // springs thinner than a pixel would flicker
  float wide = max(radius * (1.0 + 1.2 * glow * fresh), 0.6 * pixel * vDepth);
  gl_Position = projectionMatrix * vec4(at + vSide * position.x * wide, 1.0);
}`;

export const springFragment = /* glsl */ `
in vec3 vColour;
in vec3 vSide;
in vec3 vFront;
in float vAcross;
in float vDepth;
uniform float opacity;
out vec4 fragment;
${shade}
void main() {
  vec3 normal = vSide * vAcross + vFront * sqrt(max(0.0, 1.0 - vAcross * vAcross));
  fragment = vec4(shade(vColour, normal, vDepth), opacity);
}`;

export const massVertex = /* glsl */ `
in float mass;
in vec3 colour;
uniform float radius;
uniform float touch; // a mass that is at most this high above the ground is on it, m; below -1e9 without ground
uniform vec3 touchColour;
out vec2 vAt;
out vec3 vColour;
out float vDepth;
${placeOf}
${heightOf}
void main() {
  vec3 place = placeOf(mass);
  bool isOnGround = place.z - heightOf(place.xy) <= touch;
  vec4 at = modelViewMatrix * vec4(place, 1.0);
  vAt = position.xy;
  vColour = isOnGround ? touchColour : colour;
  vDepth = -at.z;
  gl_Position = projectionMatrix * (at + vec4(position.xy * radius * (isOnGround ? 1.5 : 1.0), 0.0, 0.0));
}`;

export const massFragment = /* glsl */ `
in vec2 vAt;
in vec3 vColour;
in float vDepth;
out vec4 fragment;
${shade}
void main() {
  float r = dot(vAt, vAt);
  if (r > 1.0) discard;
  fragment = vec4(shade(vColour, vec3(vAt, sqrt(1.0 - r)), vDepth), 1.0);
}`;

// a face of a voxel: a square with four masses as corners, which lie in a plane only roughly
const cornerOf = /* glsl */ `
vec3 cornerOf(vec2 at, vec3 a, vec3 b, vec3 c, vec3 d) {
  return at.y < 0.0 ? (at.x < 0.0 ? a : b) : (at.x < 0.0 ? d : c);
}`;

export const skinVertex = /* glsl */ `
in vec4 corners;
in vec3 colour;
out vec3 vColour;
out vec3 vNormal;
out vec2 vAt;
out float vDepth;
${placeOf}
${cornerOf}
vec3 seen(float mass) { return (modelViewMatrix * vec4(placeOf(mass), 1.0)).xyz; }
void main() {
  vec3 a = seen(corners.x), b = seen(corners.y), c = seen(corners.z), d = seen(corners.w);
  vec3 at = cornerOf(position.xy, a, b, c, d);
  vNormal = normalize(cross(c - a, d - b) + vec3(0.0, 0.0, 1e-12));
  if (dot(vNormal, a + b + c + d) > 0.0) vNormal = -vNormal;
  vAt = position.xy;
  vColour = colour;
  vDepth = -at.z;
  gl_Position = projectionMatrix * vec4(at, 1.0);
}`;

export const skinFragment = /* glsl */ `
in vec3 vColour;
in vec3 vNormal;
in vec2 vAt;
in float vDepth;
out vec4 fragment;
${shade}
void main() {
  vec2 pixels = (1.0 - abs(vAt)) / fwidth(vAt); // from the edges of the face
  float edge = 1.0 - clamp(min(pixels.x, pixels.y) - 0.4, 0.0, 1.0);
  fragment = vec4(shade(vColour * (1.0 - 0.35 * edge), vNormal, vDepth), 1.0);
}`;

// places projected onto the floor along the light; the stencil buffer darkens each pixel only once
const onFloor = /* glsl */ `
${heightOf}
vec3 onFloor(vec3 p) {
  vec2 at = p.xy + max(0.0, p.z - heightOf(p.xy)) * vec2(-0.18, 0.3);
  return vec3(at, heightOf(at));
}`;

export const skinShadowVertex = /* glsl */ `
in vec4 corners;
${placeOf}
${cornerOf}
${onFloor}
void main() {
  vec3 at = cornerOf(position.xy, placeOf(corners.x), placeOf(corners.y), placeOf(corners.z), placeOf(corners.w));
  gl_Position = projectionMatrix * modelViewMatrix * vec4(onFloor(at), 1.0);
}`;

export const shadowVertex = /* glsl */ `
in vec2 ends;
uniform float radius;
${placeOf}
${onFloor}
void main() {
  vec3 a = onFloor(placeOf(ends.x)), b = onFloor(placeOf(ends.y));
  vec2 along = normalize(b.xy - a.xy + vec2(1e-9, 0.0));
  vec3 at = mix(a, b, position.y) + vec3(-along.y, along.x, 0.0) * position.x * radius * 2.2;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(at, 1.0);
}`;

export const shadowFragment = /* glsl */ `
uniform vec4 shadow;
out vec4 fragment;
void main() { fragment = shadow; }`;

export const skyVertex = /* glsl */ `
out vec2 vAt;
void main() {
  vAt = position.xy;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

export const skyFragment = /* glsl */ `
in vec2 vAt;
uniform vec3 near;
uniform vec3 far;
out vec4 fragment;
void main() { fragment = vec4(mix(near, far, smoothstep(0.0, 1.5, length(vAt - vec2(0.0, 0.2)))), 1.0); }`;

export const floorVertex = /* glsl */ `
uniform vec3 centre; // of level ground, which moves with the camera's focus
out vec2 vAt;
out vec3 vNormal;
void main() {
  vec3 at = position + vec3(centre.xy, 0.0);
  vAt = at.xy;
  vNormal = normal;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(at, 1.0);
}`;

export const floorFragment = /* glsl */ `
in vec2 vAt;
in vec3 vNormal;
uniform vec3 line;
uniform vec3 earth;
uniform float relief; // 0: only lines; 1: opaque hills
uniform vec3 focus;
uniform float reach;
out vec4 fragment;
float grid(float cell, float width) {
  vec2 at = vAt / cell;
  vec2 edge = abs(fract(at - 0.5) - 0.5) / (fwidth(at) * width);
  return 1.0 - min(min(edge.x, edge.y), 1.0);
}
void main() {
  float fade = 1.0 - smoothstep(0.25 * reach, reach, distance(vAt, focus.xy));
  float strength = max(0.32 * grid(0.25, 1.0), 0.85 * grid(1.0, 1.4));
  float light = dot(normalize(vNormal), vec3(0.5, -0.8, 1.0)); // 1 on level ground
  vec3 hills = earth * clamp(0.3 + 0.7 * light, 0.0, 1.12);
  fragment = vec4(mix(mix(line, hills, relief), line, strength), mix(strength, 1.0, relief) * fade);
}`;

// particles in the water through which a swimmer moves; their pattern repeats around the focus
export const moteVertex = /* glsl */ `
uniform vec3 focus;
uniform float reach;
uniform float pixel; // size of a pixel at distance 1
out float vFade;
void main() {
  vec3 at = mod(position * 2.0 * reach - focus + reach, 2.0 * reach) - reach;
  vFade = 1.0 - smoothstep(0.4 * reach, reach, length(at));
  vec4 view = modelViewMatrix * vec4(at + focus, 1.0);
  gl_Position = projectionMatrix * view;
  gl_PointSize = clamp(0.007 * reach / (pixel * -view.z), 1.0, 7.0);
}`;

export const moteFragment = /* glsl */ `
in float vFade;
uniform vec3 line;
out vec4 fragment;
void main() {
  float r = length(gl_PointCoord - 0.5) * 2.0;
  fragment = vec4(line, vFade * (1.0 - smoothstep(0.4, 1.0, r)));
}`;
