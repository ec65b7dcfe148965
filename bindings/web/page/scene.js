// Draws the surface, the proxy, the hand and the force between them with WebGL 2, in device axes: x right, y up,
// z towards the viewer [device mm]. It only observes.

const vertexText = `#version 300 es
uniform mat4 projection, model; uniform mat3 turn;
in vec3 place, normal; out vec3 n, p;
void main() { vec4 at = model * vec4(place, 1); p = at.xyz; n = turn * normal; gl_Position = projection * at; }`;
const fragmentText = `#version 300 es
precision mediump float;
uniform vec4 colour; in vec3 n, p; out vec4 result;
void main() {
  vec3 normal = dot(n, n) > 0.0 ? normalize(n) : normalize(cross(dFdx(p), dFdy(p)));
  float lit = 0.35 + 0.65 * max(0.0, dot(normal, normalize(vec3(0.3, 0.5, 0.8))));
  result = vec4(colour.rgb * lit, colour.a);
}`;
const eye = 400; // [device mm] from the middle

/** Vertices and triangles of a ball of radius 1, which are also its normals. */
function ball(rings = 16, sectors = 24) {
  const places = [];
  const corners = [];
  for (let i = 0; i <= rings; ++i) {
    for (let j = 0; j <= sectors; ++j) {
      const [a, b] = [(Math.PI * i) / rings, (2 * Math.PI * j) / sectors];
      places.push(Math.sin(a) * Math.cos(b), Math.cos(a), Math.sin(a) * Math.sin(b));
      const at = i * (sectors + 1) + j;
      if (i < rings && j < sectors) corners.push(at, at + 1, at + sectors + 1, at + 1, at + sectors + 2, at + sectors + 1);
    }
  }
  return { vertices: new Float32Array(places), normals: new Float32Array(places), triangles: new Uint32Array(corners) };
}

export class Scene {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = (this.gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true }));
    if (!gl) throw new Error("this browser has no WebGL 2");
    this.program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertexText], [gl.FRAGMENT_SHADER, fragmentText]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(this.program, shader);
    }
    gl.bindAttribLocation(this.program, 0, "place");
    gl.bindAttribLocation(this.program, 1, "normal");
    gl.linkProgram(this.program);
    this.at = (name) => gl.getUniformLocation(this.program, name);
    this.ball = this.uploaded(ball());
    this.surface = [];
  }

  uploaded({ vertices, normals, triangles }) {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const buffers = [];
    const fill = (target, data) => {
      buffers.push(gl.createBuffer());
      gl.bindBuffer(target, buffers.at(-1));
      gl.bufferData(target, data, gl.STATIC_DRAW);
    };
    fill(gl.ARRAY_BUFFER, vertices);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    if (normals.length > 0) {
      fill(gl.ARRAY_BUFFER, normals);
      gl.enableVertexAttribArray(1);
      gl.vertexAttribPointer(1, 3, gl.FLOAT, false, 0, 0);
    }
    fill(gl.ELEMENT_ARRAY_BUFFER, triangles);
    return { array, buffers, count: triangles.length };
  }

  /** The parts of a surface; `transform` as in the settings. */
  show(parts, transform) {
    this.clear();
    this.surface = parts.filter(({ triangles }) => triangles.length > 0).map((part) => this.uploaded(part));
    this.transform = transform;
  }

  clear() {
    for (const { array, buffers } of this.surface) {
      this.gl.deleteVertexArray(array);
      for (const buffer of buffers) this.gl.deleteBuffer(buffer);
    }
    this.surface = [];
  }

  /** Physical to device. */
  device(point) {
    const { rotation: r, translation: t, scale } = this.transform;
    const d = point.map((v, i) => v - t[i]);
    return [0, 1, 2].map((c) => (r[0][c] * d[0] + r[1][c] * d[1] + r[2][c] * d[2]) / scale);
  }

  /** The device's x and y [mm] under a point of the canvas, in the plane z. */
  under(event, z) {
    const box = this.canvas.getBoundingClientRect();
    const half = ((eye - z) * 0.28) / Math.min(1, box.width / box.height);
    const y = 1 - (2 * (event.clientY - box.top)) / box.height;
    const x = (2 * (event.clientX - box.left)) / box.width - 1;
    return [(x * half * box.width) / box.height, y * half];
  }

  draw(snapshot, hand) {
    const { gl, canvas } = this;
    const width = Math.round(canvas.clientWidth * devicePixelRatio);
    const height = Math.round(canvas.clientHeight * devicePixelRatio);
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(0.12, 0.13, 0.15, 1);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.program);
    const up = 0.28 / Math.min(1, width / height);
    const [near, far] = [50, 1000];
    gl.uniformMatrix4fv(this.at("projection"), false, [
      height / width / up, 0, 0, 0, 0, 1 / up, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, (-2 * far * near) / (far - near), 0,
    ]);
    if (this.surface.length > 0) {
      const { rotation: r, scale } = this.transform;
      const origin = this.device([0, 0, 0]);
      const row = (i) => [r[i][0] / scale, r[i][1] / scale, r[i][2] / scale, 0];
      const model = [...row(0), ...row(1), ...row(2), origin[0], origin[1], origin[2] - eye, 1];
      for (const part of this.surface) this.part(part, model, [...r[0], ...r[1], ...r[2]], [0.85, 0.72, 0.62, 1]);
    }
    if (!snapshot || !this.transform) return;
    const proxy = this.device(snapshot.scp);
    this.sphere(proxy, 2.5, snapshot.constrained ? [1, 0.45, 0.1, 1] : [0.5, 0.8, 1, 1]);
    gl.disable(gl.DEPTH_TEST); // the hand is inside the solid
    for (let i = 1; i < 12; ++i) {
      const at = proxy.map((v, a) => v + ((hand[a] - v) * i) / 12);
      if (snapshot.constrained) this.sphere(at, 0.5, [1, 0.85, 0.2, 0.8]);
    }
    this.sphere(hand, 1.8, [0.3, 1, 0.5, 0.55]);
    for (let i = 1; i <= 10; ++i) {
      this.sphere(proxy.map((v, a) => v + snapshot.force[a] * i), 0.35 + 0.06 * i, [1, 0.2, 0.2, 0.7]);
    }
  }

  sphere(at, radius, colour) {
    const r = radius;
    this.part(this.ball, [r, 0, 0, 0, 0, r, 0, 0, 0, 0, r, 0, at[0], at[1], at[2] - eye, 1], [1, 0, 0, 0, 1, 0, 0, 0, 1], colour);
  }

  part({ array, count }, model, turn, colour) {
    const gl = this.gl;
    gl.bindVertexArray(array);
    gl.uniformMatrix4fv(this.at("model"), false, model);
    gl.uniformMatrix3fv(this.at("turn"), false, turn);
    gl.uniform4fv(this.at("colour"), colour);
    gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0);
  }
}
