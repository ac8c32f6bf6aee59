// SPDX-License-Identifier: Apache-2.0
// Synchronisation of two viewers: camera orbit and playback time. Call when both can play.

/** Copies the camera orbit of the viewer that is turned to the other; an orbit set by copying is not copied back. */
export function turnTogether(first, second) {
  const shown = new Map();
  const follow = (leader, follower) => {
    const { azimuth, elevation, distance } = leader.getCameraOrbit();
    const orbit = `${azimuth}deg ${elevation}deg ${distance}m`;
    if (shown.get(leader) === orbit) return false;
    shown.set(leader, orbit).set(follower, orbit);
    follower.setAttribute('camera-orbit', orbit);
    follower.jumpCameraToGoal();
    return true;
  };
  const turn = () => {
    if (!follow(first, second)) follow(second, first);
    requestAnimationFrame(turn);
  };
  turn();
}

const NEAR_S = 0.02;      // difference that counts as the same moment
const RATE_PER_S = 2;     // change of the follower's rate per second of lag
const LARGEST_CHANGE = 0.5;
const RATE_STEP = 0.05;

/**
 * Couples playing and pausing of two viewers. During playback the follower catches up by its rate, because a seek would
 * restart a GOP; while paused, it seeks the leader's frame.
 */
export function playTogether(leader, follower) {
  for (const [one, other] of [[leader, follower], [follower, leader]]) {
    one.addEventListener('play', () => { if (other.paused) void other.play().catch(() => {}); });
    one.addEventListener('pause', () => { if (!other.paused) other.pause(); });
  }
  let sought = -1;
  const keepUp = () => {
    requestAnimationFrame(keepUp);
    if (leader.paused) {
      const { frame } = leader;
      if (frame !== sought && frame !== follower.frame) follower.seekFrame(frame);
      sought = frame;
      return;
    }
    sought = -1;
    const { duration } = leader;
    if (!(duration > 0)) return;
    let behind = leader.currentTime - follower.currentTime;
    behind -= duration * Math.round(behind / duration);
    const change = Math.abs(behind) < NEAR_S ? 0 : Math.max(-LARGEST_CHANGE, Math.min(LARGEST_CHANGE, RATE_PER_S * behind));
    const rate = leader.playbackRate * (1 + RATE_STEP * Math.round(change / RATE_STEP));
    if (rate !== follower.playbackRate) follower.playbackRate = rate;
  };
  keepUp();
}
