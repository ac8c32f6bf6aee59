// SPDX-License-Identifier: Apache-2.0
// The measurements of a live system: {name, title, measure(work folder)}; each is made anew on its own.
import { rates } from './rates.mjs';
import { faults } from './faults.mjs';
import { endurance } from './endurance.mjs';

export const rows = [...rates, ...faults, ...endurance];
