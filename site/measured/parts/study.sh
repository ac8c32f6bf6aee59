# SPDX-License-Identifier: Apache-2.0
# Sourced by measure.sh. The steps that the page has figures of; codecs, presets and videos of layers, which it leaves to a
# study's own report, are not among them. The ring's SSIM has a standard error of some thousandths from 12 views.
"$lab" study "$sample" -o "$folder/report" --views 12 \
  --steps reference,methods,labels,layers,rate,speed,pictures,motion
