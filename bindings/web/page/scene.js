// Draws the surface, the proxy, the hand and the force between them with WebGL 2, in device axes: x right, y up,
// z towards the viewer [device mm]. It only observes. The surface stands still: it is drawn once, with its depths, and
// copied below what moves. A million triangles take half a second where there is no graphics card.

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
const cornersText = `#version 300 es
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }`;
const copyText = `#version 300 es
precision highp float;
uniform highp sampler2D still, depths; uniform int finer; out vec4 result;
void main() {
  result = texture(still, gl_FragCoord.xy * float(finer) / vec2(textureSize(still, 0)));
  gl_FragDepth = texelFetch(depths, ivec2(gl_FragCoord.xy) * finer, 0).r;
}`;
const eye = 400; // [device mm] from the middle

/** Without a graphics card. The loop of the hand needs the processor. */
function drawsByProcessor() {
  const gl = new OffscreenCanvas(1, 1).getContext("webgl2");
  const named = gl?.getExtension("WEBGL_debug_renderer_info"); // Firefox says it without
  const renderer = gl?.getParameter(named ? named.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|basic render/i.test(renderer);
}

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
    this.isSlow = drawsByProcessor();
    const gl = (this.gl = canvas.getContext("webgl2", { antialias: !this.isSlow }));
    if (!gl) throw new Error("this browser has no WebGL 2");
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    this.program = this.linked(vertexText, fragmentText);
    this.copying = this.linked(cornersText, copyText);
    this.still = null; // the surface as it was drawn: its size, a framebuffer and textures
    this.drawn = ""; // what the canvas shows
    this.ball = this.uploaded(ball());
    this.surface = [];
  }

  linked(...texts) {
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [i, kind] of [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].entries()) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, texts[i]);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.bindAttribLocation(program, 0, "place");
    gl.bindAttribLocation(program, 1, "normal");
    gl.linkProgram(program);
    return { program, at: (name) => gl.getUniformLocation(program, name) };
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
    this.transform = transform;
    this.surface = parts.filter(({ triangles }) => triangles.length > 0).map((part) => this.uploaded(part));
  }

  clear() {
    for (const { array, buffers } of this.surface) {
      this.gl.deleteVertexArray(array);
      for (const buffer of buffers) this.gl.deleteBuffer(buffer);
    }
    this.surface = [];
    this.forget();
  }

  /** The surface has to be drawn again. */
  forget() {
    if (this.still) {
      this.gl.deleteFramebuffer(this.still.target);
      for (const texture of this.still.textures) this.gl.deleteTexture(texture);
    }
    this.still = null;
    this.drawn = "";
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
    const { scp, force, constrained } = snapshot ?? {};
    const now = [width, height, scp, force, constrained, ...hand].join();
    if (this.drawn === now || !(width > 0 && height > 0)) return;
    if (canvas.width !== width || canvas.height !== height) {
      [canvas.width, canvas.height] = [width, height];
      this.forget();
    }
    this.still ??= this.drawStill(width, height);
    this.drawn = now;
    gl.viewport(0, 0, width, height);
    this.copyStill();
    if (!snapshot || !this.transform) return;
    this.begin(width, height);
    const proxy = this.device(scp);
    this.sphere(proxy, 2.5, constrained ? [1, 0.45, 0.1, 1] : [0.5, 0.8, 1, 1]);
    gl.disable(gl.DEPTH_TEST); // the hand is inside the solid
    for (let i = 1; i < 12; ++i) {
      const at = proxy.map((v, a) => v + ((hand[a] - v) * i) / 12);
      if (constrained) this.sphere(at, 0.5, [1, 0.85, 0.2, 0.8]);
    }
    this.sphere(hand, 1.8, [0.3, 1, 0.5, 0.55]);
    for (let i = 1; i <= 10; ++i) {
      this.sphere(proxy.map((v, a) => v + force[a] * i), 0.35 + 0.06 * i, [1, 0.2, 0.2, 0.7]);
    }
  }

  /** The surface in a picture of its own, with twice the pixels along each edge if those of the screen are large. */
  drawStill(width, height) {
    const gl = this.gl;
    const finer = devicePixelRatio < 2 ? 2 : 1;
    const texture = (kind, filter) => {
      const made = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, made);
      gl.texStorage2D(gl.TEXTURE_2D, 1, kind, finer * width, finer * height);
      for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
      return made;
    };
    const textures = [texture(gl.RGBA8, gl.LINEAR), texture(gl.DEPTH_COMPONENT24, gl.NEAREST)];
    const target = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    for (const [i, kind] of [gl.COLOR_ATTACHMENT0, gl.DEPTH_ATTACHMENT].entries()) gl.framebufferTexture2D(gl.FRAMEBUFFER, kind, gl.TEXTURE_2D, textures[i], 0);
    gl.viewport(0, 0, finer * width, finer * height);
    gl.clearColor(0.12, 0.13, 0.15, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.begin(width, height);
    if (this.surface.length > 0) {
      const { rotation: r, scale } = this.transform;
      const origin = this.device([0, 0, 0]);
      const row = (i) => [r[i][0] / scale, r[i][1] / scale, r[i][2] / scale, 0];
      const model = [...row(0), ...row(1), ...row(2), origin[0], origin[1], origin[2] - eye, 1];
      for (const part of this.surface) this.part(part, model, [...r[0], ...r[1], ...r[2]], [0.85, 0.72, 0.62, 1]);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return { target, textures, finer };
  }

  copyStill() {
    const { gl, copying, still } = this;
    gl.useProgram(copying.program);
    for (const [i, name] of ["still", "depths"].entries()) {
      gl.activeTexture(gl.TEXTURE0 + i);
      gl.bindTexture(gl.TEXTURE_2D, still.textures[i]);
      gl.uniform1i(copying.at(name), i);
    }
    gl.uniform1i(copying.at("finer"), still.finer);
    gl.enable(gl.DEPTH_TEST); // or no depth is written
    gl.depthFunc(gl.ALWAYS);
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.depthFunc(gl.LESS);
  }

  /** What follows is seen from the eye. */
  begin(width, height) {
    const gl = this.gl;
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.program.program);
    const up = 0.28 / Math.min(1, width / height);
    const [near, far] = [50, 1000];
    gl.uniformMatrix4fv(this.program.at("projection"), false, [
      height / width / up, 0, 0, 0, 0, 1 / up, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, (-2 * far * near) / (far - near), 0,
    ]);
  }

  sphere(at, radius, colour) {
    const r = radius;
    this.part(this.ball, [r, 0, 0, 0, 0, r, 0, 0, 0, 0, r, 0, at[0], at[1], at[2] - eye, 1], [1, 0, 0, 0, 1, 0, 0, 0, 1], colour);
  }

  part({ array, count }, model, turn, colour) {
    const gl = this.gl;
    gl.bindVertexArray(array);
    gl.uniformMatrix4fv(this.program.at("model"), false, model);
    gl.uniformMatrix3fv(this.program.at("turn"), false, turn);
    gl.uniform4fv(this.program.at("colour"), colour);
    gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0);
  }
}
