# SPDX-License-Identifier: Apache-2.0
# Sourced by measure.sh. The sizes that the build of the web package wrote.
once "$folder/sizes.json" cp web/dist/sizes.json "$folder/sizes.json"
