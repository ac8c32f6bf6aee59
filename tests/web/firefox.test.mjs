// SPDX-License-Identifier: Apache-2.0
// The faults of network, server and decoder in Firefox, which has a video decoder and WebGL of its own (and WebGL only
// on a screen: Xvfb is one). Writes a table as faults.test.mjs does.
import { after, before, test } from 'node:test';

import {
  decoderTaken, missingCharacter, missingMotion, mixedBakes, newBake, otherOrigin, outage, outageWhileLoading,
  serverErrors, slowServer, stage, stalls, writeTable,
} from './fault_scenes.mjs';
import { launchFirefox } from './harness.mjs';

let minute;
before(async () => {
  stage.browser = await launchFirefox();
  stage.uploadPath = 'rgba';
  minute = outage(60_000); // beside the other tests; the last one waits for it
  minute.catch(() => undefined);
});
after(async () => {
  await stage.browser?.close();
  writeTable('firefox');
});

test('the network and the server come back', () => Promise.all([
  outage(2000), outage(10_000), outageWhileLoading(), serverErrors(), slowServer(), stalls(),
]));
test('a motion that is not there is an error, and is played once it is there', missingMotion);
test('the shown motion fails: a panel with a button that tries again', missingCharacter);
test('another origin: its permission is needed, and a refusal is told from a lost network', otherOrigin);
test('a new bake in place of the one that plays: it is loaded, and nothing is mixed', newBake);
test('files of two bakes that stay mixed: loaded again once, then one error', mixedBakes);
test('the browser takes the decoder away', decoderTaken);
test('the server comes back after a minute', () => minute);
