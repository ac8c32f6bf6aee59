// SPDX-License-Identifier: Apache-2.0
// What the element's `error` event carries. The ids are those of native/base/result.h. Compare ids, never
// messages.

export interface ErrorDetail {
  id: string;
  message: string;
}

export class ViewerError extends Error {
  readonly id: string;
  constructor(id: string, message: string) {
    super(message);
    this.id = id;
  }
  get detail(): ErrorDetail {
    return { id: this.id, message: this.message };
  }
}

export function asViewerError(reason: unknown): ViewerError {
  if (reason instanceof ViewerError) return reason;
  return new ViewerError('internal', reason instanceof Error ? `${reason.name}: ${reason.message}` : String(reason));
}
