// SPDX-License-Identifier: Apache-2.0
// The sound of the motion that a viewer shows, in step with its pictures: at its rate, round its loops, after seeks. Part of fourdvt-more.js.
// Nothing is fetched before it is audible. The pictures' clock leads: sound that is off by more than the tolerance begins anew; while the
// pictures do not keep up with their own time, it is silent.
import type { SideFiles, SidePlayer } from '../more/session-side.js';
import { viewOf } from '../page/documents.js';
import { AudioOutput } from './audio-output.js';
import { SoundBuffers } from './sound-buffers.js';
import { readSound, type SoundTrack } from './sound-manifest.js';
import { StepSchedule } from './step-schedule.js';

const TOLERANCE_S = 0.025; // by which sound and picture may differ
const JUMP_S = 0.1; // that is no drift: a seek, or a wait for pictures
const DRIFTING_S = 0.15; // beyond the tolerance, before the sound begins anew
const STEADY_S = 0.3, STEADY_SHARE = 0.1; // pictures that did not keep up do so again: the time, and how exactly
const DISPLAY_S = 1 / 60; // from a turn of the page's loop to the picture on the screen
const LEAD_S = 0.02; // before the first sample is due
const AHEAD_S = 0.6; // of scheduled sound
const FETCH_S = 2; // before a segment is scheduled
const FADE_S = 0.008, OVERLAP_S = 0.02; // that segments go on behind their end
const REST_MS = 700; // without a turn of the page's loop: the viewer does not run
const MAX_RATE = 4;
const STEPS_AHEAD_S = 0.25; // a step is scheduled so much before it is due

/** The element: the members that are used here. */
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

// Time of the window's turn, by the script's clock, which began at another time than that of another window.
function turnMs(viewer: Element): number {
  const { document, performance: clock } = viewOf(viewer);
  return Number(document.timeline?.currentTime ?? clock.now()) + clock.timeOrigin - performance.timeOrigin;
}

/** Character and motion that are shown; null while there are none. */
export interface SoundSource {
  readonly session: { readonly manifest: unknown; readonly transport: SideFiles; readonly wholePlayer: SidePlayer | null } | null;
  /** The motion. */
  readonly current: { readonly name: string; readonly loop: boolean } | null;
}

// Seconds in the motion by the pictures' clock, with the fraction of a frame.
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
  #anchor: { contextS: number; mediaS: number; rate: number } | null = null; // audible: media time at the context's time
  #scheduledS = 0; // media time, going on over loops' ends
  #driftS = NaN; // context's time since which it is off by more than the tolerance
  #unsteady: { contextS: number; mediaS: number } | null = null; // when pictures were last found not to keep up
  #turnMs = 0; // of the last turn
  #watch: ReturnType<typeof setInterval> | undefined;

  /** changed: called when the motion shown gains or loses sound, and when the browser allows sound or stops it. */
  constructor(viewer: Audible, source: () => SoundSource, changed: () => void) {
    this.#viewer = viewer;
    this.#source = source;
    this.#changed = changed;
    const { signal } = this.#abort;
    for (const name of ['pause', 'waiting', 'seeking', 'emptied', 'suspend', 'ended']) viewer.addEventListener(name, () => this.#stop(), { signal });
    viewer.addEventListener('volumechange', () => {
      this.#setVolume();
      // Resumes the context inside the visitor's gesture, as WebKit requires.
      if (viewer.muted || !this.present) return;
      AudioOutput.ofPage()?.enter(this);
      if (viewer.paused) AudioOutput.leave(this);
    }, { signal });
    const { ownerDocument } = viewer;
    ownerDocument.addEventListener('visibilitychange', () => { if (ownerDocument.hidden) this.#rest(); }, { signal });
  }

  /** The motion has sound. */
  get present(): boolean {
    this.#look();
    return this.#track !== null;
  }
  /** The browser waits for the visitor's first touch. */
  get blocked(): boolean { return this.present && AudioOutput.blocked; }

  /** A turn of the page's loop. */
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

  // Reads what is shown, and takes the track of another motion.
  #look(): SoundSource {
    const { session, current } = this.#source(), shown = { session, current }; // `current` is read from the player each time
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

  // Opens the output once something is audible. Null: the browser has no sound.
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
    if (this.#scheduledS < now) return this.#stop(); // a segment has come too late, or the motion is over
    while (this.#scheduledS < now + AHEAD_S * rate && this.#schedule(context, loops)) { /* another segment */ }
    this.#segmentAt(now + (AHEAD_S + FETCH_S) * rate, loops); // on its way before it is needed
  }

  // Tests if the pictures keep up with their own time; after they have not, over a while.
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

  // Finds the segment at a media time: its beginning, its end and its samples; null if there is none, or not yet.
  #segmentAt(mediaS: number, loops: boolean): { startS: number; endS: number; sound: NonNullable<ReturnType<SoundBuffers['get']>> } | null {
    const { duration } = this.#viewer, { segmentS } = this.#track!, buffers = this.#buffers!;
    const pass = loops ? Math.floor(mediaS / duration + 1e-9) : 0, within = mediaS - pass * duration;
    if (!(duration > 0) || within >= duration - 1e-6) return null;
    const index = Math.min(buffers.count - 1, Math.floor(within / segmentS + 1e-9)), sound = buffers.get(index, Math.ceil((AHEAD_S + FETCH_S) * MAX_RATE / segmentS) + 2);
    const endS = index === buffers.count - 1 ? duration : (index + 1) * segmentS;
    return sound && { startS: pass * duration + index * segmentS, endS: pass * duration + endS, sound };
  }

  // Schedules the next segment from where the last one ends. False if it is not there yet.
  #schedule(context: AudioContext, loops: boolean): boolean {
    const from = this.#scheduledS, segment = this.#segmentAt(from, loops), { contextS, mediaS, rate } = this.#anchor!;
    if (!segment) return false;
    const whenS = contextS + (from - mediaS) / rate, endS = contextS + (segment.endS - mediaS) / rate;
    this.#start(context, segment.sound, whenS, from - segment.startS, segment.endS - from, rate, endS);
    this.#scheduledS = segment.endS;
    return true;
  }

  // Fades in when it begins and out behind its end, where the next one fades in.
  #start(context: AudioContext, { buffer, fromS }: { buffer: AudioBuffer; fromS: number }, whenS: number, atS: number, lengthS: number, rate: number, endS: number): void {
    const source = context.createBufferSource(), gain = context.createGain(), fadeS = Math.min(FADE_S, OVERLAP_S / rate);
    source.buffer = buffer;
    source.playbackRate.value = rate;
    gain.gain.setValueAtTime(0, whenS);
    gain.gain.linearRampToValueAtTime(1, whenS + fadeS);
    if (endS > whenS + fadeS) gain.gain.setValueAtTime(1, endS);
    gain.gain.linearRampToValueAtTime(0, Math.max(endS, whenS + fadeS) + fadeS);
    source.connect(gain).connect(this.#volume!);
    source.start(whenS, Math.max(0, fromS + atS), lengthS + fadeS * rate); // rounding may lead before its beginning
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
