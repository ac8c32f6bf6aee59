// SPDX-License-Identifier: Apache-2.0
// Reads fields of a manifest that is not validated yet.
interface Extension {
  appearance?: unknown;
  start?: { uri?: string };
  layerCount?: number;
}
export const extensionOf = (manifest: unknown): Extension | undefined =>
  (manifest as { extensions?: { FOURDVT_layered_video_texture?: Extension } } | null)?.extensions?.FOURDVT_layered_video_texture;
export const isFromCameras = (manifest: unknown): boolean => extensionOf(manifest)?.appearance === 'cameras';
