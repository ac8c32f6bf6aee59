// SPDX-License-Identifier: Apache-2.0
// Regret: what the bake's choice of a method (rows "chosen") gives up against the best one within its cost at the held-out cameras
// (rows "condition"). Holds no value.
const kMaxCost = 2.5; // ChoiceRule::most_cost
const at = (rows, table, { axis, at: place }) => rows.filter((row) => row.table === table && row.axis === axis && row.at === place);

/** { axis, at, shift_px, chosen, db, best, best_db, regret_db, above_linear_db } per row "chosen" with a truth. */
export function chosenAgainstTruth(rows) {
  const given = at(rows, 'condition', { axis: 'proxy', at: 'given' });
  const costOf = (row) => row.frame_ratio ?? given.find(({ method }) => method === row.method)?.frame_ratio ?? Infinity;
  return rows.filter(({ table }) => table === 'chosen').flatMap((chosen) => {
    const scores = at(rows, 'condition', chosen), own = scores.find(({ method }) => method === chosen.method);
    const within = scores.filter((row) => costOf(row) <= kMaxCost || row.method in (chosen.blended_db ?? {}));
    const best = within.reduce((a, b) => (a && a.psnr_db >= b.psnr_db ? a : b), undefined), linear = scores.find(({ method }) => method === 'linear');
    if (!own || !best || !linear) return [];
    return [{ axis: chosen.axis, at: chosen.at, shift_px: chosen.shift_px, chosen: chosen.method, db: own.psnr_db, best: best.method, best_db: best.psnr_db,
      regret_db: Math.max(0, best.psnr_db - own.psnr_db), above_linear_db: own.psnr_db - linear.psnr_db }];
  });
}

/** Mean and worst regret, and the least above linear blending. */
export function regretSummary(list) {
  const regrets = list.map((row) => row.regret_db);
  return `${list.length} conditions: regret ${(regrets.reduce((a, b) => a + b, 0) / list.length).toFixed(3)} dB on average, ${Math.max(...regrets).toFixed(2)} dB at worst; ` +
    `at least ${Math.min(...list.map((row) => row.above_linear_db)).toFixed(2)} dB above linear blending`;
}
