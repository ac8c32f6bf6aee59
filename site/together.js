// SPDX-License-Identifier: Apache-2.0
// Two viewers that show one view: the orbit of both, and the moment that both play. Begin when both can play.

/** Whoever is turned leads; the other follows. What follows does not lead back: its orbit is the one it was given. */
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

const NEAR_S = 0.02;      // closer than this counts as the same moment
const RATE_PER_S = 2;     // change of the follower's rate for each second that it is away
const LARGEST_CHANGE = 0.5;
const RATE_STEP = 0.05;

/**
 * Playing and pausing one plays and pauses the other. While they play, the follower catches up by its rate, because a
 * seek would begin a GOP anew; while they stand, it seeks the leader's frame.
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
