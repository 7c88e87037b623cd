// Programs of the scene. `value`: place of a value in its scale, from 0 to 1; `beyond`: positive where nothing is drawn.

const SURFACE = {
  vertex: `#version 300 es
    in vec3 position; in float value, beyond;
    uniform mat4 modelViewMatrix, projectionMatrix;
    out vec3 eye; out float part, outside;
    void main() {
      vec4 at = modelViewMatrix * vec4(position, 1.0);
      eye = at.xyz;
      part = value;
      outside = beyond;
      gl_Position = projectionMatrix * at;
    }`,
  // Flat shading: the normal of the triangle on the screen, lit on both sides.
  fragment: `#version 300 es
    precision highp float;
    in vec3 eye; in float part, outside;
    uniform sampler2D map;
    out vec4 colour;
    void main() {
      if (outside > 0.0) discard;
      // Where regions meet, a section shows the side of the region that one looks into.
      gl_FragDepth = gl_FragCoord.z - (gl_FrontFacing ? 0.0 : 2e-6);
      vec3 normal = normalize(cross(dFdx(eye), dFdy(eye)));
      if (dot(normal, eye) > 0.0) normal = -normal;
      float light = 0.62 + 0.30 * max(dot(normal, normalize(vec3(-0.35, 0.6, 0.8))), 0.0) + 0.10 * max(normal.z, 0.0);
      colour = vec4(texture(map, vec2(clamp(part, 0.0, 1.0) * 0.99609 + 0.00195, 0.5)).rgb * light, 1.0);
    }`,
};

const LINES = {
  vertex: `#version 300 es
    in vec3 position; in float beyond;
    uniform mat4 modelViewMatrix, projectionMatrix;
    out float outside;
    void main() {
      outside = beyond;
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      // In front of the surface that they lie on.
      gl_Position.z -= 3e-4 * gl_Position.w;
    }`,
  fragment: `#version 300 es
    precision highp float;
    in float outside;
    uniform vec4 ink;
    out vec4 colour;
    void main() {
      if (outside > 0.0) discard;
      colour = vec4(ink.rgb * ink.a, ink.a);
    }`,
};

// Lines of a width on the screen: both ends at each of four corners, which are moved across the line.
const LINKS = {
  vertex: `#version 300 es
    in vec3 position; in vec3 other; in float side; in float value, beyond;
    uniform mat4 modelViewMatrix, projectionMatrix;
    uniform vec2 size; uniform float width;
    out float part, outside;
    void main() {
      vec4 a = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      vec4 b = projectionMatrix * modelViewMatrix * vec4(other, 1.0);
      vec2 along = (b.xy / b.w - a.xy / a.w) * size;
      float reach = length(along);
      vec2 across = reach > 0.0 ? vec2(-along.y, along.x) / reach : vec2(0.0);
      a.xy += side * across * width / size * a.w;
      part = value;
      outside = beyond;
      gl_Position = a;
    }`,
  fragment: `#version 300 es
    precision highp float;
    in float part, outside;
    uniform sampler2D map;
    out vec4 colour;
    void main() {
      if (outside > 0.0) discard;
      colour = vec4(texture(map, vec2(clamp(part, 0.0, 1.0) * 0.99609 + 0.00195, 0.5)).rgb, 1.0);
    }`,
};

const NODES = {
  vertex: `#version 300 es
    in vec3 position; in float value, beyond;
    uniform mat4 modelViewMatrix, projectionMatrix;
    uniform float width;
    out float part, outside;
    void main() {
      part = value;
      outside = beyond;
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      gl_PointSize = width;
    }`,
  fragment: `#version 300 es
    precision highp float;
    in float part, outside;
    uniform sampler2D map;
    out vec4 colour;
    void main() {
      if (outside > 0.0) discard;
      vec2 at = 2.0 * gl_PointCoord - 1.0;
      float r = dot(at, at);
      if (r > 1.0) discard;
      float light = 0.62 + 0.38 * max(dot(vec3(at.x, -at.y, sqrt(1.0 - r)), normalize(vec3(-0.35, 0.6, 0.8))), 0.0);
      colour = vec4(texture(map, vec2(clamp(part, 0.0, 1.0) * 0.99609 + 0.00195, 0.5)).rgb * light, 1.0);
    }`,
};

// Rings of a size on the screen, in front of what they mark.
const RINGS = {
  vertex: `#version 300 es
    in vec3 position;
    uniform mat4 modelViewMatrix, projectionMatrix;
    uniform float width;
    void main() {
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      gl_Position.z -= 0.02 * gl_Position.w;
      gl_PointSize = width;
    }`,
  fragment: `#version 300 es
    precision highp float;
    uniform vec4 ink;
    out vec4 colour;
    void main() {
      float r = length(2.0 * gl_PointCoord - 1.0);
      if (r > 1.0 || r < 0.55) discard;
      colour = ink;
    }`,
};

// An arrow along z: x and y in its radius, z 0 or 1 along the shaft, `head` 0 or 1 along the head.
const ARROW = {
  vertex: `#version 300 es
    in vec3 position; in float head;
    uniform mat4 modelViewMatrix, projectionMatrix;
    uniform vec3 start, along; uniform float reach, thick;
    out vec3 eye;
    void main() {
      float tip = min(6.0 * thick, 0.5 * reach);
      vec3 u = normalize(cross(abs(along.z) < 0.9 ? vec3(0, 0, 1) : vec3(1, 0, 0), along));
      vec3 at = start + thick * (position.x * u + position.y * cross(along, u)) + along * (position.z * (reach - tip) + head * tip);
      vec4 view = modelViewMatrix * vec4(at, 1.0);
      eye = view.xyz;
      gl_Position = projectionMatrix * view;
    }`,
  fragment: `#version 300 es
    precision highp float;
    in vec3 eye;
    uniform vec4 ink;
    out vec4 colour;
    void main() {
      vec3 normal = normalize(cross(dFdx(eye), dFdy(eye)));
      float light = 0.75 + 0.25 * abs(dot(normal, normalize(vec3(-0.35, 0.6, 0.8))));
      colour = vec4(ink.rgb * light * ink.a, ink.a);
    }`,
};

// Shaft and head of the arrow as triangles.
function arrowTriangles(n = 20) {
  const position = [], head = [];
  const ring = (i, r, z) => [r * Math.cos((2 * Math.PI * i) / n), r * Math.sin((2 * Math.PI * i) / n), z];
  const triangle = (corners, heads) => { corners.forEach((corner) => position.push(...corner)); head.push(...heads); };
  for (let i = 0; i < n; i++) {
    const [a, b, c, d] = [ring(i, 1, 0), ring(i + 1, 1, 0), ring(i, 1, 1), ring(i + 1, 1, 1)];
    triangle([a, b, c], [0, 0, 0]);
    triangle([c, b, d], [0, 0, 0]);
    triangle([ring(i, 2.6, 1), ring(i + 1, 2.6, 1), [0, 0, 1]], [0, 0, 1]);
    triangle([ring(i + 1, 2.6, 1), ring(i, 2.6, 1), [0, 0, 1]], [0, 0, 0]);
  }
  return { position: new Float32Array(position), head: new Float32Array(head) };
}
