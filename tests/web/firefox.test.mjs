// SPDX-License-Identifier: Apache-2.0
// The faults of network, server and decoder in Firefox, which has a video decoder and WebGL of its own (and WebGL only
// on a screen: Xvfb is one). Writes a table as faults.test.mjs does.
import { after, before, test } from 'node:test';

import {
  closeStage, everywhere, outage, outageWhileLoading, serverErrors, slowServer, stage, stalls, writeTable,
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
  await closeStage();
  writeTable('firefox');
});

test('the network and the server come back', () => Promise.all([
  outage(2000), outage(10_000), outageWhileLoading(), serverErrors(), slowServer(), stalls(),
]));
for (const [title, scene] of everywhere) test(title, scene);
test('the server comes back after a minute', () => minute);
