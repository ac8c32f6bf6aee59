// SPDX-License-Identifier: Apache-2.0
// Measurements of a live system: {name, title, measure(work folder)}; each runs independently of the others.
import { rates } from './rates.mjs';
import { faults } from './faults.mjs';
import { endurance } from './endurance.mjs';

export const rows = [...rates, ...faults, ...endurance];
