// SPDX-License-Identifier: Apache-2.0
// Types of the elements in JSX, for React 19: import 'fourdvt-viewer/react' once. Attributes have the names of web/README.md; a boolean
// one is true, or false or absent. Properties and events come by a ref.
import type { DetailedHTMLProps, HTMLAttributes } from 'react';
import type { FourdvtCharacter, FourdvtViewer } from './dist/types/fourdvt-viewer.js';

type Base<T> = DetailedHTMLProps<HTMLAttributes<T>, T>;
type Numeric = number | string;

export interface FourdvtViewerAttributes extends Base<FourdvtViewer> {
  src?: string;
  poster?: string;
  alt?: string;
  loading?: 'auto' | 'lazy' | 'eager';
  preload?: 'none' | 'metadata' | 'auto';
  crossorigin?: 'anonymous' | 'use-credentials';
  reveal?: 'auto' | 'manual';
  autoplay?: boolean;
  loop?: boolean | 'false';
  muted?: boolean;
  controls?: boolean | 'none';
  sequence?: string;
  align?: 'none' | 'baked' | 'flow-gpu' | 'flow-dis' | 'flow-opencv';
  travel?: boolean;
  'motion-controls'?: boolean;
  action?: string;
  'camera-controls'?: boolean;
  'camera-orbit'?: string;
  'min-camera-orbit'?: string;
  'max-camera-orbit'?: string;
  'camera-target'?: string;
  'camera-follow'?: 'position' | 'behind';
  'field-of-view'?: string;
  'auto-rotate'?: boolean;
  'auto-rotate-delay'?: Numeric;
  'rotation-per-second'?: Numeric;
  'orbit-sensitivity'?: Numeric;
  'zoom-sensitivity'?: Numeric;
  zoom?: boolean;
  'disable-zoom'?: boolean;
  'touch-action'?: string;
  'interaction-prompt'?: 'auto' | 'none';
  quality?: Numeric;
  method?: string;
  cameras?: Numeric;
  visibility?: 'offset' | 'fattened' | 'plain' | 'none';
  look?: 'sketch' | 'relit' | 'none';
  'look-strength'?: Numeric;
  light?: string;
  'light-turn'?: Numeric;
  background?: 'room';
  'upload-path'?: string;
}

export interface FourdvtCharacterAttributes extends Base<FourdvtCharacter> {
  src?: string;
  position?: string;
  heading?: Numeric;
  sequence?: string;
  travel?: boolean;
}

declare module 'react' {
  namespace JSX {
    interface IntrinsicElements {
      'fourdvt-viewer': FourdvtViewerAttributes;
      'fourdvt-character': FourdvtCharacterAttributes;
    }
  }
}
