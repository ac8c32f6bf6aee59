// SPDX-License-Identifier: Apache-2.0
// Runs in the page of gltf.test.mjs: any glTF viewer, here three.js with its own Draco decoder, knows nothing of fourdvt.
import { AmbientLight, Box3, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

// Orbit round the centre of the mesh; returns straight-alpha RGBA, top row first.
globalThis.drawStill = async (url, { azimuth, elevation, distance, width, height, fov }) => {
  const draco = new DRACOLoader().setDecoderPath('draco/');
  const gltf = await new GLTFLoader().setDRACOLoader(draco).loadAsync(url);
  const scene = new Scene();
  scene.add(gltf.scene, new AmbientLight(0xffffff, Math.PI));
  const center = new Box3().setFromObject(gltf.scene).getCenter(new Vector3());
  const camera = new PerspectiveCamera(fov, width / height, 0.05, 100);
  const [a, e] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
  camera.position.set(Math.cos(e) * Math.sin(a), Math.sin(e), Math.cos(e) * Math.cos(a)).multiplyScalar(distance).add(center);
  camera.lookAt(center);
  const renderer = new WebGLRenderer({ alpha: true, antialias: true, preserveDrawingBuffer: true });
  renderer.setSize(width, height, false);
  document.body.append(renderer.domElement);
  renderer.render(scene, camera);
  const copy = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
  copy.drawImage(renderer.domElement, 0, 0);
  const { data } = copy.getImageData(0, 0, width, height);
  let text = '';
  for (let at = 0; at < data.length; at += 0x8000) text += String.fromCharCode(...data.subarray(at, at + 0x8000));
  draco.dispose();
  return { base64: btoa(text), center: center.toArray() };
};
