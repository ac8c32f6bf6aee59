// SPDX-License-Identifier: Apache-2.0
// The page's side of web/develop.mjs, which puts it into every page that it serves, before all other scripts, with a line that
// defines `develop`: { version, shaders: [{ name, embedded, text }] }. Draws with the shaders of the tree in place of those that the player
// was built with, shows what is wrong, and reloads the page when something new was built.
{
  const context = WebGL2RenderingContext.prototype, { shaderSource, compileShader } = context;
  const names = new WeakMap();

  context.shaderSource = function (shader, source) {
    const found = develop.shaders.find(({ embedded }) => source.endsWith(embedded));
    if (!found) return shaderSource.call(this, shader, source);
    names.set(shader, found.name);
    return shaderSource.call(this, shader, source.slice(0, -found.embedded.length) + found.text);
  };
  context.compileShader = function (shader) {
    compileShader.call(this, shader);
    if (!names.has(shader) || this.isContextLost() || this.getShaderParameter(shader, this.COMPILE_STATUS)) return;
    const problem = `${names.get(shader)} does not compile:\n${this.getShaderInfoLog(shader)}`;
    fetch('/develop/problem', { method: 'POST', body: `${develop.version}\n${problem}` });
  };

  let panel = null;
  function show(problems) {
    panel?.remove();
    panel = null;
    if (!problems.length) return;
    panel = document.createElement('pre');
    panel.id = 'develop-problems';
    panel.textContent = problems.join('\n\n');
    Object.assign(panel.style, {
      position: 'fixed', inset: 'auto 0 0 0', maxHeight: '60vh', margin: 0, padding: '1em', overflow: 'auto', zIndex: 2147483647,
      background: '#300d', color: '#fdd', font: '13px/1.4 monospace', whiteSpace: 'pre-wrap',
    });
    document.documentElement.append(panel);
  }

  new EventSource('/develop/events').onmessage = ({ data }) => {
    const { version, problems } = JSON.parse(data);
    if (version !== develop.version) location.reload();
    else show(problems);
  };
}
