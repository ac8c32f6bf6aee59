# SPDX-License-Identifier: Apache-2.0
# Sourced by measure.sh. What the build of the web package wrote.
once "$folder/sizes.json" cp web/dist/sizes.json "$folder/sizes.json"
