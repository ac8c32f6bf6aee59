// SPDX-License-Identifier: Apache-2.0
// Button for the sound of a viewer that begins muted; shown once there is sound.
export function makeSoundButton(viewer, button) {
  const show = () => {
    if (viewer.hasSound) button.hidden = false;
    button.setAttribute('aria-pressed', String(!viewer.muted));
  };
  button.addEventListener('click', () => { viewer.muted = !viewer.muted; });
  for (const type of ['volumechange', 'timeupdate', 'sequencechange']) viewer.addEventListener(type, show);
}
