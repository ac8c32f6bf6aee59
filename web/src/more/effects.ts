// SPDX-License-Identifier: Apache-2.0
// Effects that a session loads after the first picture: optical flow, the element's look, the character's room. Part of
// fourdvt-more.js. isCurrent: returns false once a later call has replaced this one.
import { uploadPicture } from '../decode/upload-path.js';
import { readLook } from './look.js';
import { loadOpenCvFlow } from './opencv-flow.js';
import type { SessionSide } from './session-side.js';

const ROOM_FETCH = -1; // the player numbers its requests from 0

// Makes the error detail of a file that this script, not the player, could not load.
const fetchFailed = (reason: unknown): { id: string; message: string } => ({ id: 'fetch-failed', message: (reason as Error).message });

/** Loads optical flow, then aligns by it. A failure is an error event and keeps the present alignment. */
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

/** Loads and applies the element's look; resolves to true if it is drawn. A failure is an error event. */
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

/** Loads and draws the character's room, if it has one and the page shows it. A failure is an error event. */
export async function useRoom(session: SessionSide, isCurrent: () => boolean): Promise<void> {
  const player = session.main?.player, info = session.main?.character;
  if (!session.room || !player || !info) return;
  if (!info.roomUri) return console.warn('fourdvt-viewer: this character has no room, so none is drawn');
  try {
    const bytes = await session.transport.range(ROOM_FETCH, info.roomUri, 0, info.roomBytes);
    if (!bytes || !isCurrent()) return;
    const texture = player.showRoom(bytes); // not drawn before it is filled
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
