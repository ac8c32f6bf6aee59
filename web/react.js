// SPDX-License-Identifier: Apache-2.0
// Has types alone: react.d.ts.
export {};
