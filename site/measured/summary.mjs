// SPDX-License-Identifier: Apache-2.0
// The rows of README's table of figures, as data: { what, ours, other }; rows whose `ours` was not measured are left out. Texts hold figures of catalogue.mjs as {id}.
// Does NOT hold any value.
export const summary = [
  { what: 'picture at cameras kept apart', ours: '{mean.psnr.joint-default}, SSIM {mean.ssim.joint-default}', other: 'FVVR at its best {mean.psnr.fvvr-tuned}, {mean.ssim.fvvr-tuned}; the papers’ form {mean.psnr.fvvr}, {mean.ssim.fvvr}' },
  { what: 'bytes, layers of 512²', ours: '{storage.percent_512}', other: 'masked PNG pictures, as the papers count' },
  { what: 'the same, at equal SSIM', ours: '{equal_tuned_ssim.joint}', other: 'H.264 camera videos for FVVR at its best' },
  { what: 'the same, at equal SSIM', ours: '{equal_ssim.joint}', other: 'H.264 camera videos for the papers’ FVVR' },
  { what: 'bytes by default, at equal SSIM', ours: '{equal_tuned_ssim.joint-default}', other: 'H.264 camera videos for FVVR at its best' },
  { what: 'bytes by default, at equal SSIM', ours: '{equal_ssim.joint-default}', other: 'H.264 camera videos for the papers’ FVVR' },
  { what: 'bitrate', ours: '{bitrate.all}', other: '' },
  { what: 'frame rate', ours: '{speed.frame}', other: 'FVVR' },
  { what: 'label flips', ours: '{flips.fewer} fewer', other: 'spatial labelling' },
  { what: 'between two motions, true mesh', ours: '{truth.mean.baked}', other: 'optical flow {truth.mean.flow-gpu}' },
  { what: 'the same, blended mesh', ours: '{truth.psnr.blend.baked}', other: 'optical flow {truth.psnr.blend.flow-gpu}' },
  { what: 'drawing time of that blend', ours: '{cost.baked}', other: 'optical flow {cost.flow-gpu}' },
  { what: 'bake, a frame', ours: '{bake.frame}', other: '' },
  { what: 'player, gzip', ours: '{player.both}, {player.first} of it before the first picture', other: '' },
];
