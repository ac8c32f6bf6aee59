// SPDX-License-Identifier: Apache-2.0
// The faults of network, server and decoder in Firefox, which has a video decoder and WebGL of its own (and WebGL only
// on a screen: Xvfb is one). Writes a table as faults.test.mjs does.
import { everywhere, runScenes, sceneTest, stage } from './fault_scenes.mjs';
import { launchFirefox } from './harness.mjs';

stage.uploadPath = 'rgba';
for (const [title, scene] of everywhere) sceneTest(title, scene);
runScenes('firefox', launchFirefox);
