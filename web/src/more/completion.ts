// SPDX-License-Identifier: Apache-2.0
// Completes a session that can play and has the second part. Part of fourdvt-more.js.
import { advise, judgeAgain } from './advice.js';
import { decidePath } from './measure-path.js';
import type { SessionSide, SideActor } from './session-side.js';

/** Completes the session. others: the companions' actors. measures: also measures the upload path. */
export function complete(session: SessionSide, others: readonly SideActor[], measures: boolean): void {
  const { main } = session;
  if (measures) main?.takeFrame((frame) => void decidePath(session, frame).then(() => judgeAgain(session))); // for the next player, if the path has changed
  if (main) void advise(session.manifest, main, session.host.element, session.options.files);
  for (const actor of [main, ...others]) actor?.run((player) => player.moreCame());
  session.drawing.programsMissing = true;
}
