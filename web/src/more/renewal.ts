// SPDX-License-Identifier: Apache-2.0
// Looks for a new bake at a character's address. Part of fourdvt-more.js.
import { extensionOf } from '../net/manifest.js';
import type { ErrorDetail } from '../report/errors.js';
import type { Bake, SessionSide } from './session-side.js';

/**
 * Bake to go on with after these errors; null: there is none. Files that differ from their manifest without a new
 * one may be leftovers in the browser's cache: they are loaded again, past it.
 */
export async function renew(session: SessionSide, errors: readonly ErrorDetail[]): Promise<Bake | null> {
  const transport = session.openTransport(session.options.src, 'reload');
  const leave = (): void => transport.dispose();
  session.signal.addEventListener('abort', leave);
  const manifest = await transport.manifest().catch(() => null);
  const named = extensionOf(manifest)?.start?.uri, start = named ? await transport.start(named) : new Uint8Array();
  const isNew = manifest !== null && JSON.stringify(manifest) !== JSON.stringify(session.manifest);
  const mayBeCached = manifest !== null && !session.fresh && errors.some(({ id }) => id === 'files-differ');
  if (!session.signal.aborted && session.main && (isNew || mayBeCached)) return { transport, manifest, start };
  leave();
  return null;
}
