// SPDX-License-Identifier: Apache-2.0
// Effects of a session after the first picture: optical flow, the element's look, the character's room. Part of fourdvt-more.js.
// isCurrent: the page has set nothing else meanwhile.
import { uploadPicture } from '../decode/upload-path.js';
import { readLook } from './look.js';
import { loadOpenCvFlow } from './opencv-flow.js';
import type { SessionSide } from './session-side.js';

const ROOM_FETCH = -1; // the player numbers its requests from 0

// Makes the error of a file that the page's side could not load.
const fetchFailed = (reason: unknown): { id: string; message: string } => ({ id: 'fetch-failed', message: (reason as Error).message });

/** Aligns by optical flow once that is loaded. If that fails, an error event has the reason and the alignment stays. */
export async function useFlow(session: SessionSide, isCurrent: () => boolean): Promise<void> {
  const { align, host: { commands, emit } } = session;
  if (align === 'flow-opencv') {
    try {
      await loadOpenCvFlow(session.options.files, session.module);
    } catch (reason) {
      if (!isCurrent()) return;
      session.align = commands.settings.align;
      return emit('error', fetchFailed(reason));
    }
  }
  if (isCurrent() && session.main && !commands.set('align', align)) session.align = commands.settings.align;
}

/** True once the element's look is drawn. If that fails, an error event has the reason. */
export async function useLook(session: SessionSide, isCurrent: () => boolean): Promise<boolean> {
  try {
    const look = await readLook(session.host.element, session);
    if (!isCurrent() || !session.main) return false;
    session.main.run((player) => player.call(look));
    return true;
  } catch (reason) {
    if (isCurrent()) session.host.emit('error', fetchFailed(reason));
    return false;
  }
}

/** Draws the character's room, if it has one and the page shows it. If that fails, an error event has the reason. */
export async function useRoom(session: SessionSide, isCurrent: () => boolean): Promise<void> {
  const player = session.main?.player, info = session.main?.character;
  if (!session.room || !player || !info) return;
  if (!info.roomUri) return console.warn('fourdvt-viewer: this character has no room, so none is drawn');
  try {
    const bytes = await session.transport.range(ROOM_FETCH, info.roomUri, 0, info.roomBytes);
    if (!bytes || !isCurrent()) return;
    const texture = player.showRoom(bytes); // nothing is seen of it until it is filled
    const picture = await createImageBitmap(new Blob([bytes as BlobPart]), { colorSpaceConversion: 'none' });
    if (isCurrent()) {
      const { gl } = session;
      uploadPicture(gl, texture, picture, true);
      gl.generateMipmap(gl.TEXTURE_2D);
      player.invalidateState();
      session.wake();
    }
    picture.close();
  } catch (reason) {
    if (isCurrent()) session.onMainEvent('error', session.errorOf(reason));
  }
}
