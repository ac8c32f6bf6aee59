// Values of the slots of fields (native/render/fields/): 0-3 in the first vector, 4-7 in the second.
float slotOf(vec4 low, vec4 high, int slot) { return slot < 4 ? low[slot] : high[slot - 4]; }

void setSlot(inout vec4 low, inout vec4 high, int slot, float value) {
  if (slot < 4) low[slot] = value;
  else high[slot - 4] = value;
}
