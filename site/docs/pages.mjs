// SPDX-License-Identifier: Apache-2.0
// The documents that the site shows: { source: path in the repository, name: page in docs/, title: in the navigation }.
// A link to a source becomes a link to its page; a link to another file of the repository loses its address.

export const groups = [
  { title: 'Use it', pages: [
    { source: 'site/docs/README.md', name: 'index', title: 'Overview' },
    { source: 'web/README.md', name: 'element', title: 'The element' },
    { source: 'native/capture/CAPTURE.md', name: 'capture', title: 'Your own capture' },
    { source: 'native/capture/CLASSES.md', name: 'classes', title: 'Motions that blend' },
    { source: 'site/docs/cluster.md', name: 'cluster', title: 'On many machines' },
    { source: 'site/docs/live.md', name: 'live', title: 'Live' },
    { source: 'site/docs/errors.md', name: 'errors', title: 'Errors' },
  ] },
  { title: 'Measured', pages: [
    { source: 'site/docs/measured.md', name: 'measured', title: 'Against the papers' },
    { source: 'site/measured/cameras.md', name: 'cameras', title: 'Layers and cameras' },
    { source: 'site/measured/methods.md', name: 'methods', title: 'Methods from cameras' },
    { source: 'site/measured/hulls.md', name: 'hulls', title: 'Surfaces from cameras' },
    { source: 'site/measured/calibration.md', name: 'calibration', title: 'Cameras in step and in place' },
    { source: 'site/measured/live.md', name: 'live-measured', title: 'Live, measured' },
    { source: 'site/measured/cluster.md', name: 'cluster-measured', title: 'On many machines, measured' },
    { source: 'site/measured/phones.md', name: 'phones', title: 'What playing costs' },
    { source: 'site/measured/knobs.md', name: 'knobs', title: 'Disturbances of a capture' },
    { source: 'site/sample/actor_a/README.md', name: 'sample', title: 'The sample capture' },
  ] },
  { title: 'Inside', pages: [
    { source: 'native/README.md', name: 'native', title: 'The native code' },
    { source: 'native/GLOSSARY.md', name: 'glossary', title: 'Glossary' },
    { source: 'site/docs/where.md', name: 'where', title: 'Where to change what' },
    { source: 'native/package/FORMAT.md', name: 'format', title: 'File format' },
    { source: 'shaders/README.md', name: 'shaders', title: 'Shaders' },
    { source: '.github/CONTRIBUTING.md', name: 'contributing', title: 'Contributing' },
    { source: 'CHANGELOG.md', name: 'changelog', title: 'Changelog' },
  ] },
  { title: 'Algorithms', pages: [
    { source: 'native/algorithms/README.md', name: 'algorithms', title: 'All chapters' },
    { source: 'native/algorithms/labels.md', name: 'algorithms-labels', title: 'Labels' },
    { source: 'native/algorithms/texels.md', name: 'algorithms-texels', title: 'Texels' },
    { source: 'native/algorithms/rendering.md', name: 'algorithms-rendering', title: 'Rendering' },
    { source: 'native/algorithms/motion.md', name: 'algorithms-motion', title: 'Motion' },
    { source: 'native/algorithms/alignment.md', name: 'algorithms-alignment', title: 'Alignment' },
    { source: 'native/algorithms/coding.md', name: 'algorithms-coding', title: 'Coding' },
    { source: 'native/algorithms/mattes.md', name: 'algorithms-mattes', title: 'Mattes' },
    { source: 'native/algorithms/refinement.md', name: 'algorithms-refinement', title: 'Refinement' },
    { source: 'native/algorithms/calibration.md', name: 'algorithms-calibration', title: 'Calibration' },
    { source: 'native/algorithms/hulls.md', name: 'algorithms-hulls', title: 'Hulls' },
    { source: 'native/algorithms/stereo.md', name: 'algorithms-stereo', title: 'Stereo' },
    { source: 'native/algorithms/tracking.md', name: 'algorithms-tracking', title: 'Tracking' },
    { source: 'native/algorithms/cameras.md', name: 'algorithms-cameras', title: 'Cameras' },
    { source: 'native/algorithms/floating.md', name: 'algorithms-floating', title: 'Floating Textures' },
    { source: 'native/algorithms/montage.md', name: 'algorithms-montage', title: 'Montage4D' },
    { source: 'native/algorithms/player.md', name: 'algorithms-player', title: 'Player' },
    { source: 'native/algorithms/live.md', name: 'algorithms-live', title: 'Live' },
    { source: 'native/algorithms/measures.md', name: 'algorithms-measures', title: 'Measures' },
  ] },
];

export const pages = groups.flatMap((group) => group.pages);

/** Pictures of the documents, in site/docs/capture/; made by capture_pictures.mjs. */
export const capturePictures = ['cameras', 'calibration', 'sync', 'mattes', 'clips', 'hints'].map((name) => `capture/${name}.webp`);

/** Pictures of native/capture/CLASSES.md; made by class_pictures.sh. */
export const classPictures = ['speeds', 'texture'].map((name) => `classes/${name}.webp`);

/** Files of the repository that the assembled site has, too: path → path from docs/. */
export const served = new Map([
  ['README.md', 'index.html'],
  ['site/index.html', '../index.html'],
  ['site/steer.html', '../steer.html'],
  ['site/layers.jpg', '../layers.jpg'],
  ['site/measured/index.html', '../measured/index.html'],
  ['site/measured/figures.json', '../measured/figures.json'],
  ['site/docs/layering.svg', 'layering.svg'],
  ...[...capturePictures, ...classPictures].map((path) => [`site/docs/${path}`, path]),
  ...['embed', 'steer', 'gallery', 'own-controls'].map((name) => [`web/examples/${name}.html`, `../examples/${name}.html`]),
]);
