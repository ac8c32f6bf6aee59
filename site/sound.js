// SPDX-License-Identifier: Apache-2.0
// A button for the sound of a viewer that begins muted. It is shown once there is sound to hear.
export function makeSoundButton(viewer, button) {
  const show = () => {
    if (viewer.hasSound) button.hidden = false;
    button.setAttribute('aria-pressed', String(!viewer.muted));
  };
  button.addEventListener('click', () => { viewer.muted = !viewer.muted; });
  for (const type of ['volumechange', 'timeupdate', 'sequencechange']) viewer.addEventListener(type, show);
}
