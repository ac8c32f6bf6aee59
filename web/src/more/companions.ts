// SPDX-License-Identifier: Apache-2.0
// Characters drawn in the same canvas as a session's main one. Part of fourdvt-more.js.
import type { Transport } from '../net/transport.js';
import { mayBeOfTwoBakes, type ErrorDetail } from '../report/errors.js';
import { advise } from './advice.js';
import type { ActorHost, SessionSide, SideActor, SideCompanion } from './session-side.js';

/** A loaded companion. */
interface Other {
  actor: SideActor;
  transport: Transport;
}

export class Companions {
  readonly #session: SessionSide;
  readonly #others = new Map<SideCompanion, Other>();
  readonly #coming = new Set<SideCompanion>();
  readonly #renewed = new WeakSet<SideCompanion>();

  constructor(session: SessionSide) {
    this.#session = session;
  }

  get actors(): SideActor[] { return Array.from(this.#others.values(), ({ actor }) => actor); }

  /** Loads another character into the same canvas, unless it is loaded already. A failure is its error event. */
  async add(companion: SideCompanion): Promise<void> {
    const session = this.#session;
    if (!session.main || companion.left.aborted || this.#coming.has(companion) || this.#others.has(companion)) return;
    this.#coming.add(companion);
    const transport = session.openTransport(companion.src ?? session.options.src, this.#renewed.has(companion) ? 'reload' : 'default');
    transport.stopReplay();
    const leave = (): void => transport.dispose();
    for (const signal of [companion.left, session.signal]) signal.addEventListener('abort', leave);
    try {
      const manifest = await transport.manifest();
      if (session.main && !companion.left.aborted) this.#open(companion, transport, manifest);
    } catch (reason) {
      if (!session.signal.aborted && !companion.left.aborted) companion.emit('error', session.errorOf(reason));
    }
    this.#coming.delete(companion);
    if (!this.#others.has(companion)) transport.dispose();
  }

  remove(companion: SideCompanion): void {
    const other = this.#others.get(companion);
    this.#others.delete(companion);
    other?.transport.dispose();
    other?.actor.dispose();
  }
  /** Removes all; later.ts adds them again when the next main character can play. */
  clear(): void {
    for (const companion of [...this.#others.keys()]) this.remove(companion);
  }
  /** Plays or pauses all companions. */
  setPlaying(playing: boolean): void {
    for (const { commands } of this.#others.keys()) commands.set('playing', playing);
  }

  #open(companion: SideCompanion, transport: Transport, manifest: unknown): void {
    const session = this.#session, { commands } = companion;
    commands.set('playing', session.host.commands.settings.playing);
    commands.set('align', session.align === 'none' ? 'none' : 'baked');
    const host: ActorHost = {
      emit: (name, detail) => {
        if (name === 'sharper') return;
        if (name !== 'error' || !this.#addAgain(companion, detail as ErrorDetail)) companion.emit(name, detail);
      },
      wake: () => session.wake(),
      fatal: (reason) => session.fatal(reason),
      more: () => session.more(),
      onNoPlanes: () => companion.emit('error', { id: 'video-invalid', message: 'the pictures of this video cannot be read here' }),
    };
    const actor = session.makeActor({ transport, manifest, start: new Uint8Array() }, commands, host);
    this.#others.set(companion, { actor, transport });
    void advise(manifest, actor, false, this.#session.options.files);
    // Undoes the registration if a listener of the companion's first events has ended the companion or the session.
    if (companion.left.aborted || session.signal.aborted) this.remove(companion);
    session.wake();
  }

  // Loads the companion anew instead of reporting the error, at most once; returns true if it does so.
  #addAgain(companion: SideCompanion, error: ErrorDetail): boolean {
    if (!mayBeOfTwoBakes(error) || this.#renewed.has(companion)) return false;
    this.#renewed.add(companion);
    queueMicrotask(() => {
      if (!this.#others.has(companion)) return;
      this.remove(companion);
      void this.add(companion);
    });
    return true;
  }
}
