// SPDX-License-Identifier: Apache-2.0
// Looks for a new bake at a character's address. Part of fourdvt-more.js.
import { extensionOf } from '../net/manifest.js';
import type { ErrorDetail } from '../report/errors.js';
import type { Bake, SessionSide } from './session-side.js';

/**
 * Returns the bake with which to replace one that has these errors; null: none. Files that differ from an unchanged
 * manifest may be outdated ones in the browser's cache: the result then loads them past the cache.
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
