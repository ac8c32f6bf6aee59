// SPDX-License-Identifier: Apache-2.0
// Plays the sound of the shown motion synchronously with its pictures, over changes of rate, loops and seeks. Part of
// fourdvt-more.js. Fetches nothing while muted or paused. The pictures' clock is the master: sound restarts if it is off by
// more than the tolerance, and is silent while the pictures fall behind their own time.
import type { SideFiles, SidePlayer } from '../more/session-side.js';
import { viewOf } from '../page/documents.js';
import { AudioOutput } from './audio-output.js';
import { SoundBuffers } from './sound-buffers.js';
import { readSound, type SoundTrack } from './sound-manifest.js';
import { StepSchedule } from './step-schedule.js';

const TOLERANCE_S = 0.025; // maximum offset between sound and picture
const JUMP_S = 0.1; // minimum offset that restarts the sound at once: a seek, or a wait for pictures
const DRIFTING_S = 0.15; // time beyond the tolerance after which the sound restarts
const STEADY_S = 0.3, STEADY_SHARE = 0.1; // pictures are steady again after this time with at most this relative error
const DISPLAY_S = 1 / 60; // latency from a turn of the page's loop to the screen
const LEAD_S = 0.02; // from now to the first scheduled sample
const AHEAD_S = 0.6; // length of sound scheduled ahead
const FETCH_S = 2; // time to fetch a segment before it is scheduled
const FADE_S = 0.008, OVERLAP_S = 0.02; // length of fades; sound available behind a segment's end
const REST_MS = 700; // time without a turn after which the viewer counts as stopped
const MAX_RATE = 4;
const STEPS_AHEAD_S = 0.25; // lead of a step's schedule

/** Members of the element that this file uses. */
export interface Audible extends HTMLElement {
  readonly paused: boolean;
  readonly ended: boolean;
  readonly seeking: boolean;
  readonly readyState: number;
  readonly duration: number;
  readonly playbackRate: number;
  readonly loop: boolean;
  readonly muted: boolean;
  readonly volume: number;
}

// Time of the present turn in the element's window, ms, on the script's clock: each window's clock has its own origin.
function turnMs(viewer: Element): number {
  const { document, performance: clock } = viewOf(viewer);
  return Number(document.timeline?.currentTime ?? clock.now()) + clock.timeOrigin - performance.timeOrigin;
}

/** Shown character and motion; null while there are none. */
export interface SoundSource {
  readonly session: { readonly manifest: unknown; readonly transport: SideFiles; readonly wholePlayer: SidePlayer | null } | null;
  /** Shown motion. */
  readonly current: { readonly name: string; readonly loop: boolean } | null;
}

// Position in the motion on the pictures' clock, seconds, with fractions of a frame.
function clockTime(player: SidePlayer | null): number {
  let timeS = 0;
  player?.call((module, handle) => {
    timeS = module._fdvt_clock_time(handle);
    return 1;
  });
  return timeS;
}

interface Playing {
  source: AudioBufferSourceNode;
  gain: GainNode;
}

export class Sound {
  readonly #viewer: Audible;
  readonly #source: () => SoundSource;
  readonly #changed: () => void;
  readonly #abort = new AbortController();
  #manifest: unknown = null;
  #motion = '';
  #track: SoundTrack | null = null;
  #buffers: SoundBuffers | null = null;
  #steps: StepSchedule | null = null;
  #volume: GainNode | null = null;
  #playing: Playing[] = [];
  #anchor: { contextS: number; mediaS: number; rate: number } | null = null; // audible: media time at a context time
  #scheduledS = 0; // end of the scheduled sound, unrolled media time
  #driftS = NaN; // context time since which sound is off by more than the tolerance
  #unsteady: { contextS: number; mediaS: number } | null = null; // when pictures last fell behind
  #turnMs = 0; // time of the last turn
  #watch: ReturnType<typeof setInterval> | undefined;

  /** changed: called when the shown motion gains or loses sound, and when the browser allows or stops sound. */
  constructor(viewer: Audible, source: () => SoundSource, changed: () => void) {
    this.#viewer = viewer;
    this.#source = source;
    this.#changed = changed;
    const { signal } = this.#abort;
    for (const name of ['pause', 'waiting', 'seeking', 'emptied', 'suspend', 'ended']) viewer.addEventListener(name, () => this.#stop(), { signal });
    viewer.addEventListener('volumechange', () => {
      this.#setVolume();
      // Resumes the context within the visitor's gesture, as WebKit requires.
      if (viewer.muted || !this.present) return;
      AudioOutput.ofPage()?.enter(this);
      if (viewer.paused) AudioOutput.leave(this);
    }, { signal });
    const { ownerDocument } = viewer;
    ownerDocument.addEventListener('visibilitychange', () => { if (ownerDocument.hidden) this.#rest(); }, { signal });
  }

  /** True if the shown motion has sound. */
  get present(): boolean {
    this.#look();
    return this.#track !== null;
  }
  /** True while the browser blocks sound until the visitor's first input. */
  get blocked(): boolean { return this.present && AudioOutput.blocked; }

  /** Called per turn of the page's loop. */
  turn(): void {
    this.#turnMs = performance.now();
    const viewer = this.#viewer, rate = viewer.playbackRate;
    const audible = !viewer.muted && !viewer.paused && !viewer.ended && !viewer.seeking && viewer.readyState >= 3 && rate > 0;
    const { session, current } = audible ? this.#look() : { session: null, current: null };
    const output = session && current && this.#track ? this.#output() : null;
    if (!output) return this.#rest();
    if (!output.enter(this)) return this.#stop();
    const heardS = output.heardAt(turnMs(viewer) + 1000 * DISPLAY_S);
    if (!Number.isFinite(heardS)) return;
    const time = clockTime(session!.wholePlayer), loops = viewer.hasAttribute('loop') ? viewer.loop : current!.loop;
    if (this.#track!.steps) this.#turnSteps(output, heardS, time, loops);
    else this.#turnTrack(output, heardS, time, rate, loops);
  }
  dispose(): void {
    this.#rest();
    this.#abort.abort();
    this.#forget();
    this.#volume?.disconnect();
  }

  // Returns the shown character and motion; reads the track of a new motion.
  #look(): SoundSource {
    const { session, current } = this.#source(), shown = { session, current }; // a copy: the getter `current` reads the player
    if (!session?.manifest || !current || (session.manifest === this.#manifest && current.name === this.#motion)) return shown;
    const { manifest } = session, motion = current.name, had = this.#track !== null;
    this.#stop();
    this.#forget();
    this.#manifest = manifest;
    this.#motion = motion;
    try {
      this.#track = readSound(manifest, motion);
    } catch (reason) {
      console.warn(`fourdvt-viewer: the sound of "${motion}" in character.gltf: ${String(reason)}; bake the character again`);
    }
    if (had !== (this.#track !== null)) this.#changed();
    return shown;
  }
  #forget(): void {
    this.#buffers?.dispose();
    this.#buffers = this.#track = this.#steps = null;
  }

  // Returns the output with volume and buffers set up; null if the browser has no sound.
  #output(): AudioOutput | null {
    const output = AudioOutput.ofPage();
    if (!output) return null;
    const { context } = output;
    if (!this.#volume) {
      this.#volume = context.createGain();
      this.#volume.connect(context.destination);
      this.#setVolume();
      output.onChange(this.#changed, this.#abort.signal);
      this.#changed();
    }
    this.#buffers ??= new SoundBuffers(this.#track!, (bytes) => context.decodeAudioData(bytes), () => this.#source().session?.transport ?? null, (reason) => {
      console.warn(`fourdvt-viewer: "${this.#motion}" goes on without sound:`, reason);
    });
    return output;
  }
  #setVolume(): void {
    this.#volume?.gain.setTargetAtTime(this.#viewer.volume, this.#volume.context.currentTime, FADE_S);
  }

  #turnTrack({ context }: AudioOutput, heardS: number, time: number, rate: number, loops: boolean): void {
    const { duration } = this.#viewer, anchor = this.#anchor;
    if (anchor) {
      let offS = anchor.mediaS + (heardS - anchor.contextS) * anchor.rate - time;
      if (loops) offS -= Math.round(offS / duration) * duration;
      offS = Math.abs(offS) / rate;
      this.#driftS = offS <= TOLERANCE_S ? NaN : this.#driftS || heardS;
      if (anchor.rate !== rate) {
        this.#stop();
      } else if (offS > JUMP_S || heardS - this.#driftS > DRIFTING_S) {
        this.#stop();
        this.#unsteady = { contextS: heardS, mediaS: time };
      }
    }
    if (!this.#anchor) {
      if (!this.#isSteady(heardS, time, rate, loops)) return;
      const contextS = context.currentTime + LEAD_S;
      const mediaS = Math.max(0, time + (contextS - heardS) * rate);
      if (!this.#segmentAt(mediaS, loops)) return;
      this.#anchor = { contextS, mediaS, rate };
      this.#scheduledS = mediaS;
    }
    const now = this.#anchor!.mediaS + (context.currentTime - this.#anchor!.contextS) * rate;
    if (this.#scheduledS < now) return this.#stop(); // a segment is late, or the motion has ended
    while (this.#scheduledS < now + AHEAD_S * rate && this.#schedule(context, loops)) { /* another segment */ }
    this.#segmentAt(now + (AHEAD_S + FETCH_S) * rate, loops); // prefetches
  }

  // Returns true if the pictures keep up with their own time; after they fell behind, only once they have for STEADY_S.
  #isSteady(contextS: number, mediaS: number, rate: number, loops: boolean): boolean {
    const { duration } = this.#viewer, since = this.#unsteady;
    if (!since) return true;
    const passedS = contextS - since.contextS;
    if (passedS < STEADY_S) return false;
    let offS = mediaS - since.mediaS - passedS * rate;
    if (loops) offS -= Math.round(offS / duration) * duration;
    this.#unsteady = Math.abs(offS) < STEADY_SHARE * passedS * rate ? null : { contextS, mediaS };
    return !this.#unsteady;
  }

  // Returns beginning, end and samples of the segment at an unrolled media time; null past the end or if not loaded.
  #segmentAt(mediaS: number, loops: boolean): { startS: number; endS: number; sound: NonNullable<ReturnType<SoundBuffers['get']>> } | null {
    const { duration } = this.#viewer, { segmentS } = this.#track!, buffers = this.#buffers!;
    const pass = loops ? Math.floor(mediaS / duration + 1e-9) : 0, within = mediaS - pass * duration;
    if (!(duration > 0) || within >= duration - 1e-6) return null;
    const index = Math.min(buffers.count - 1, Math.floor(within / segmentS + 1e-9)), sound = buffers.get(index, Math.ceil((AHEAD_S + FETCH_S) * MAX_RATE / segmentS) + 2);
    const endS = index === buffers.count - 1 ? duration : (index + 1) * segmentS;
    return sound && { startS: pass * duration + index * segmentS, endS: pass * duration + endS, sound };
  }

  // Schedules the next segment at the end of the last one; false if it is not loaded.
  #schedule(context: AudioContext, loops: boolean): boolean {
    const from = this.#scheduledS, segment = this.#segmentAt(from, loops), { contextS, mediaS, rate } = this.#anchor!;
    if (!segment) return false;
    const whenS = contextS + (from - mediaS) / rate, endS = contextS + (segment.endS - mediaS) / rate;
    this.#start(context, segment.sound, whenS, from - segment.startS, segment.endS - from, rate, endS);
    this.#scheduledS = segment.endS;
    return true;
  }

  // Starts a segment with a fade-in at its beginning and a fade-out after its end, a cross-fade with the next segment.
  #start(context: AudioContext, { buffer, fromS }: { buffer: AudioBuffer; fromS: number }, whenS: number, atS: number, lengthS: number, rate: number, endS: number): void {
    const source = context.createBufferSource(), gain = context.createGain(), fadeS = Math.min(FADE_S, OVERLAP_S / rate);
    source.buffer = buffer;
    source.playbackRate.value = rate;
    gain.gain.setValueAtTime(0, whenS);
    gain.gain.linearRampToValueAtTime(1, whenS + fadeS);
    if (endS > whenS + fadeS) gain.gain.setValueAtTime(1, endS);
    gain.gain.linearRampToValueAtTime(0, Math.max(endS, whenS + fadeS) + fadeS);
    source.connect(gain).connect(this.#volume!);
    source.start(whenS, Math.max(0, fromS + atS), lengthS + fadeS * rate); // rounding may give a negative offset
    const playing = { source, gain };
    this.#playing.push(playing);
    source.addEventListener('ended', () => {
      gain.disconnect();
      this.#playing = this.#playing.filter((p) => p !== playing);
    });
    this.#watch ??= setInterval(() => { if (performance.now() - this.#turnMs > REST_MS) this.#rest(); }, 200);
  }

  #turnSteps({ context }: AudioOutput, heardS: number, time: number, loops: boolean): void {
    const { duration } = this.#viewer, sound = this.#buffers!.get(0);
    this.#steps ??= new StepSchedule(this.#track!.steps!);
    for (const whenS of this.#steps.due(time / duration, heardS, STEPS_AHEAD_S + Math.max(0, context.currentTime - heardS), loops)) {
      const lengthS = this.#track!.segmentS;
      if (sound && whenS > context.currentTime) this.#start(context, sound, whenS, 0, lengthS, 1, whenS + lengthS);
    }
  }

  #rest(): void {
    this.#stop();
    AudioOutput.leave(this);
  }
  #stop(): void {
    clearInterval(this.#watch);
    this.#watch = undefined;
    this.#anchor = this.#steps = null;
    this.#driftS = NaN;
    this.#unsteady = null;
    for (const { source, gain } of this.#playing) {
      const now = gain.context.currentTime;
      if (gain.gain.cancelAndHoldAtTime) gain.gain.cancelAndHoldAtTime(now);
      else gain.gain.cancelScheduledValues(now);
      gain.gain.setTargetAtTime(0, now, FADE_S / 2);
      source.stop(now + 4 * FADE_S);
    }
    this.#playing = [];
  }
}
