// SPDX-License-Identifier: Apache-2.0
// Depth only.
void main() {}
