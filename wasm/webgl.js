// SPDX-License-Identifier: Apache-2.0
// Replacement for Emscripten's WebGL functions, restricted to the calls of native/gpu/gles_device.cpp: no attributes,
// no uniform blocks, no buffer offsets, no errors of its own. Half as long.
const library = {
  // Objects by number, 0: none. The page registers contexts and textures (web/src/wasm/wasm-abi.ts).
  $GL: {
    contexts: [null],
    buffers: [null], programs: [null], framebuffers: [null], renderbuffers: [null], textures: [null], shaders: [null], vaos: [null], syncs: [null],
    add: function(table, object) { return object ? table.push(object) - 1 : 0; },
    registerContext: function(context) { return GL.add(GL.contexts, context); },
  },
  $GL__postset: 'var GLctx;',
  emscripten_webgl_make_context_current: function(context) {
    GLctx = GL.contexts[context];
    return 0;
  },

  $create__deps: ['$GL'],
  $create: function(count, at, table, method) {
    for (; count--; at += 4) HEAP32[at >> 2] = GL.add(table, GLctx[method]());
  },
  $remove: function(count, at, table, method) {
    for (; count--; at += 4) {
      GLctx[method](table[HEAP32[at >> 2]]);
      table[HEAP32[at >> 2]] = null;
    }
  },
  glGenBuffers: function(count, at) { create(count, at, GL.buffers, 'createBuffer'); },
  glGenFramebuffers: function(count, at) { create(count, at, GL.framebuffers, 'createFramebuffer'); },
  glGenRenderbuffers: function(count, at) { create(count, at, GL.renderbuffers, 'createRenderbuffer'); },
  glGenTextures: function(count, at) { create(count, at, GL.textures, 'createTexture'); },
  glDeleteBuffers: function(count, at) { remove(count, at, GL.buffers, 'deleteBuffer'); },
  glDeleteFramebuffers: function(count, at) { remove(count, at, GL.framebuffers, 'deleteFramebuffer'); },
  glDeleteRenderbuffers: function(count, at) { remove(count, at, GL.renderbuffers, 'deleteRenderbuffer'); },
  glDeleteTextures: function(count, at) { remove(count, at, GL.textures, 'deleteTexture'); },
  glFenceSync: function(condition, flags) { return GL.add(GL.syncs, GLctx.fenceSync(condition, flags)); },
  glDeleteSync: function(sync) {
    GLctx.deleteSync(GL.syncs[sync]);
    GL.syncs[sync] = null;
  },

  glCreateShader: function(type) { return GL.add(GL.shaders, GLctx.createShader(type)); },
  glShaderSource: function(shader, count, texts) { GLctx.shaderSource(GL.shaders[shader], UTF8ToString(HEAP32[texts >> 2])); }, // single text
  glGetShaderiv: function(shader, name, at) { HEAP32[at >> 2] = GLctx.getShaderParameter(GL.shaders[shader], name); },
  glGetShaderInfoLog: function(shader, size, length, at) { stringToUTF8(GLctx.getShaderInfoLog(GL.shaders[shader]) || '', at, size); },
  glDeleteShader: function(shader) {
    GLctx.deleteShader(GL.shaders[shader]);
    GL.shaders[shader] = null;
  },
  glCreateProgram: function() { return GL.add(GL.programs, GLctx.createProgram()); },
  glLinkProgram: function(program) { GLctx.linkProgram(GL.programs[program]); },
  glUseProgram: function(program) { GLctx.useProgram(GL.program = GL.programs[program]); },
  glGetProgramiv: function(program, name, at) { HEAP32[at >> 2] = GLctx.getProgramParameter(GL.programs[program], name); },
  glGetProgramInfoLog: function(program, size, length, at) { stringToUTF8(GLctx.getProgramInfoLog(GL.programs[program]) || '', at, size); },
  glDeleteProgram: function(program) {
    GLctx.deleteProgram(GL.programs[program]);
    GL.programs[program] = null;
  },
  glGetActiveUniform: function(program, index, nameSize, length, size, type, name) {
    const uniform = GLctx.getActiveUniform(GL.programs[program], index);
    HEAP32[size >> 2] = uniform.size;
    HEAP32[type >> 2] = uniform.type;
    stringToUTF8(uniform.name, name, nameSize);
  },
  glGetUniformLocation: function(program, name) {
    program = GL.programs[program];
    const place = GLctx.getUniformLocation(program, UTF8ToString(name));
    return place ? (program.places = program.places || []).push(place) - 1 : -1; // none: in a block, or built in
  },
  $uniformPlace__deps: ['$GL'],
  $uniformPlace: function(place) { return GL.program.places[place]; },

  glGetIntegerv: function(name, at) { HEAP32[at >> 2] = GLctx.getParameter(name); },
  glPixelStorei: function(name, value) { GLctx.pixelStorei(name, value); },
  glBindBuffer: function(target, buffer) { GLctx.bindBuffer(target, GL.buffers[buffer]); },
  glBufferData: function(target, size, data, usage) {
    if (data) GLctx.bufferData(target, HEAPU8, usage, data, size);
    else GLctx.bufferData(target, size, usage);
  },
  glDrawBuffers: function(count, at) { GLctx.drawBuffers(HEAPU32.subarray(at >> 2, (at >> 2) + count)); },
  glInvalidateFramebuffer: function(target, count, at) { GLctx.invalidateFramebuffer(target, HEAPU32.subarray(at >> 2, (at >> 2) + count)); },

  // Memory as pixels of a type: heap view and offset.
  $pixelsAt: function(type, at) {
    const heap = { 5121: HEAPU8, 5125: HEAPU32, 5126: HEAPF32, 5131: HEAPU16 }[type];
    return [heap, at / heap.BYTES_PER_ELEMENT];
  },
  glTexImage2D: function(target, level, internal, width, height, border, format, type) {
    GLctx.texImage2D(target, level, internal, width, height, border, format, type, null); // no pixels
  },
  glTexSubImage2D: function(target, level, x, y, width, height, format, type, at) {
    GLctx.texSubImage2D(target, level, x, y, width, height, format, type, ...pixelsAt(type, at));
  },
  glTexSubImage3D: function(target, level, x, y, z, width, height, depth, format, type, at) {
    GLctx.texSubImage3D(target, level, x, y, z, width, height, depth, format, type, ...pixelsAt(type, at));
  },
  glReadPixels: function(x, y, width, height, format, type, at) { // at: 0, offset into the bound pixel buffer
    GLctx.readPixels(x, y, width, height, format, type, ...(at ? pixelsAt(type, at) : [0]));
  },
};
for (const [kind, heap, numbers] of [['1fv', 'HEAPF32', 1], ['2fv', 'HEAPF32', 2], ['3fv', 'HEAPF32', 3], ['4fv', 'HEAPF32', 4], ['1iv', 'HEAP32', 1], ['1uiv', 'HEAPU32', 1]]) {
  library[`glUniform${kind}`] = eval(`(function(place, count, at) { GLctx.uniform${kind}(uniformPlace(place), ${heap}, at >> 2, count * ${numbers}); })`);
}
Object.assign(library, {
  glUniform1i: function(place, value) { GLctx.uniform1i(uniformPlace(place), value); },
  glUniformMatrix4fv: function(place, count, transpose, at) { GLctx.uniformMatrix4fv(uniformPlace(place), transpose, HEAPF32, at >> 2, count * 16); },
});
// Dependencies of each function, in place of Emscripten's.
for (const [name, value] of Object.entries(library)) {
  if (name.endsWith('__deps') || name.endsWith('__postset')) continue;
  const needs = ['GL', 'create', 'remove', 'uniformPlace', 'pixelsAt'].filter((other) => `$${other}` !== name && new RegExp(`\\b${other}\\b`).test(String(value)));
  library[`${name}__deps`] = ['$GL', ...needs.filter((other) => other !== 'GL').map((other) => `$${other}`)].filter((other) => other !== name);
}
mergeInto(LibraryManager.library, library);
