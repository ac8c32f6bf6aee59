# SPDX-License-Identifier: Apache-2.0
# Sourced by measure.sh. FVVR at the held-out cameras, the papers' form and at its best; nothing is baked.
"$lab" study "$sample" -o "$folder/report" --steps fvvr
